# SPDX-License-Identifier: Apache-2.0
import json
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from spring_contact import SpringSolver, loads, spring_curves

from condyle.conventions import POSE_COLUMNS, WRENCH_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling import Dataset, DomainTarget, SamplingPlan, read_candidates, sample

IDENTITY = {"implant": {"femur": "f00"}, "side_of_body": "right"}


@pytest.fixture(scope="module")
def sampled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("sampled")
    targets = (DomainTarget(2, 100, 20), DomainTarget(4, 50, 10))
    plan = SamplingPlan(targets, seed=9, pilot=32, chunk_rows=50)
    sample(plan, spring_curves(), SpringSolver(), directory, IDENTITY)
    return directory


@pytest.fixture
def copy(sampled: Path, tmp_path: Path) -> Path:
    """One that a test may break."""
    return shutil.copytree(sampled, tmp_path / "copy")


def test_samples_meet_their_prescribed_loads(sampled: Path) -> None:
    data = Dataset.read(sampled)
    total = loads(data.poses).sum(axis=1)
    assert np.array_equal(data.wrenches.sum(axis=1), total)
    Fy, Mx = data.prescribed_loads.T
    assert np.all(np.abs(total[:, 1] - Fy) <= 1e-3 * Fy + 0.01)
    assert np.all(np.abs(total[:, 3] - Mx) <= 1e-3 * np.abs(Mx) + 0.0005)
    boundary = data.select(domain=4)
    assert np.all((boundary.prescribed_loads[:, 0] > 0) & (boundary.prescribed_loads[:, 0] <= 100))
    assert np.all(np.abs(boundary.prescribed_loads[:, 1]) <= 5)
    assert np.all(data.evaluations == 6)
    assert 0 < data.max_depth.max() <= 2e-3


def test_pandas_alone_reads_the_same_rows(sampled: Path) -> None:
    data, frame = Dataset.read(sampled), pd.read_parquet(sampled / "samples")
    assert np.array_equal(frame[list(POSE_COLUMNS)].to_numpy(), data.poses)
    assert np.array_equal(frame[list(WRENCH_COLUMNS)].to_numpy(), data.wrenches.reshape(-1, 12))
    assert np.array_equal(frame["domain"], data.domain)
    assert frame["split"].tolist() == data.split.tolist()
    assert np.array_equal(frame["candidate"], data.candidate)


def test_manifest_counts_are_those_of_the_candidates(sampled: Path) -> None:
    manifest = json.loads((sampled / "manifest.json").read_text())
    for entry in manifest["domains"]:
        candidates = read_candidates(sampled, entry["domain"])
        expected = {"accepted": entry["accepted"], **entry["rejected"]}
        assert Counter(candidates.status.tolist()) == expected
        assert len(candidates.status) == entry["candidates"]
        kept = Dataset.read(sampled).select(domain=entry["domain"])
        accepted = candidates.candidate[candidates.status == "accepted"]
        assert set(kept.candidate) <= set(accepted)
        # What was prescribed is what the kept sample carries.
        rows = np.isin(candidates.candidate, kept.candidate)
        assert np.array_equal(candidates.prescribed[rows][:, [1, 3]], kept.prescribed_loads)
        assert np.array_equal(
            candidates.prescribed[rows][:, [0, 2, 4, 5]], kept.poses[:, [0, 2, 4, 5]]
        )


def test_manifest_states_units_frames_seed_and_no_circumstances(sampled: Path) -> None:
    text = (sampled / "manifest.json").read_text()
    manifest = json.loads(text)
    assert manifest["units"]["y"] == "m"
    assert manifest["units"]["medial_Mz"] == "Nm"
    assert manifest["plan"]["seed"] == 9
    assert manifest["identity"] == IDENTITY
    assert "Fy > 0" in manifest["frames"]["wrench"]
    assert set(manifest) == {
        "complete", "curves", "design_hash", "domains", "format", "frames", "identity", "parts",
        "plan", "units", "versions",
    }  # fmt: skip
    assert str(sampled) not in text


def test_select_gives_whole_rows(sampled: Path) -> None:
    data = Dataset.read(sampled)
    test = data.select(split="test", domain=2)
    rows = (data.split == "test") & (data.domain == 2)
    assert len(test) == 20
    assert np.array_equal(test.wrenches, data.wrenches[rows])
    assert np.array_equal(test.candidate, data.candidate[rows])


def test_samples_of_another_implant_are_refused(sampled: Path) -> None:
    assert len(Dataset.read(sampled, identity=IDENTITY)) == 180
    with pytest.raises(InputDataError, match="femur is 'f00' there, 'f01' is asked"):
        Dataset.read(sampled, identity={"implant": {"femur": "f01"}})


@pytest.mark.parametrize("keep", [-100, 1000, 0])
def test_a_truncated_part_is_named(copy: Path, keep: int) -> None:
    part = copy / "samples" / "domain-4-part-00000.parquet"
    part.write_bytes(part.read_bytes()[:keep])
    message = "domain-4-part-00000.parquet is damaged.*SHA-256 is not the manifest's.*remove this"
    with pytest.raises(InputDataError, match=message):
        Dataset.read(copy)


def test_a_missing_part_is_named_and_made_again_without_solving(
    copy: Path, sampled: Path, content
) -> None:
    (copy / "samples" / "domain-2-part-00000.parquet").unlink()
    with pytest.raises(
        InputDataError, match=r"domain-2-part-00000\.parquet is damaged.*No such file"
    ):
        Dataset.read(copy)
    targets = (DomainTarget(2, 100, 20), DomainTarget(4, 50, 10))
    plan = SamplingPlan(targets, seed=9, pilot=32, chunk_rows=50)
    sample(plan, spring_curves(), SpringSolver(stop_after=0), copy, IDENTITY)
    assert content(copy) == content(sampled)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "holds no manifest.json: it is not a dataset of samples"),
        ("{", "manifest.json cannot be read: "),
        ('{"format": "condyle samples 99"}', "format is 'condyle samples 99'; 'condyle samples 2'"),
        ("[]", "format is 'list'"),
    ],
)
def test_what_is_not_a_dataset_is_refused(tmp_path: Path, text: str | None, message: str) -> None:
    if text is not None:
        (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(InputDataError, match=message):
        Dataset.read(tmp_path)


def test_candidates_of_a_domain_that_was_not_sampled_are_refused(sampled: Path) -> None:
    with pytest.raises(InputDataError, match="domain-3 holds no evaluated candidates"):
        read_candidates(sampled, 3)
