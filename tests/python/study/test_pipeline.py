# SPDX-License-Identifier: Apache-2.0
"""The whole path on a small study: stages run, are skipped when current, and run again when their inputs change."""

import json
from pathlib import Path

import pytest

from condyle.errors import CondyleError
from condyle.study import Study, StudyRun

pytest.importorskip("torch")

#: Coarse and short: the path is what is tested here, not the surrogate's accuracy.
SMALL = {
    "name": "small",
    "activities": ["iso_like_gait", "squat_like"],
    "implant": {"preset": "curved", "side_of_body": "left", "mesh_edge_mm": 2.5},
    "contact": {"evaluation": "exact"},
    "sampling": {
        "seed": 5,
        "targets": {"2": {"train": 400, "test": 150}, "4": {"train": 150, "test": 60}},
    },
    "training": {"neurons": 6, "hidden_layers": 2, "max_epochs": 8, "threads": 1},
}


class Log:
    """A reporter that remembers which stages ran and which were skipped."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.unchanged: list[str] = []

    def stage(self, name: str, text: str) -> None:
        self.ran.append(name)

    def skipped(self, name: str) -> None:
        self.unchanged.append(name)

    def progress(self, task: str, fraction: float, note: str) -> None:
        assert 0.0 <= fraction <= 1.0

    def finished(self, name: str, text: str) -> None:
        assert self.ran[-1] == name


def run(runs: Path, until: str = "evaluate", **changes: object) -> tuple[Log, Path]:
    log = Log()
    study = Study.model_validate(SMALL | changes)
    StudyRun(study, runs, threads=2, reporter=log).run(until)
    return log, runs / study.name


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    log, _ = run(folder)
    assert log.ran == ["implant", "reference", "sample", "train", "evaluate"]
    return folder


def test_the_run_directory_holds_what_was_promised(runs):
    root = runs / "small"
    for name in (
        "implant/femur.stl",
        "simulations/iso_like_gait_reference.csv",
        "samples/manifest.json",
        "surrogate.onnx",
        "surrogate_wrench.onnx",
        "training/record.json",
        "tables/sample_errors.json",
    ):
        assert (root / name).stat().st_size > 0, name
    assert not list(root.rglob("*.tmp"))


def test_the_samples_say_what_they_were_drawn_around(runs):
    from condyle.sampling import read_table

    root = runs / "small"
    curves = read_table(root / "tables" / "reference_curves.csv")
    assert curves.names == tuple(SMALL["activities"])
    manifest = json.loads((root / "samples" / "manifest.json").read_text())
    assert manifest["curves"]["hash"] == curves.content_hash()
    assert manifest["plan"]["sensitive_directions"] == ["y", "theta_x"]
    table = json.loads((root / "tables" / "samples.json").read_text())["sensitive_directions"]
    assert table["stiffness"]["y"]["unit"] == "N/mm"


def test_the_surrogate_says_whose_it_is(runs):
    from condyle.surrogate import describe

    description = json.dumps(describe(runs / "small" / "surrogate.onnx"))
    assert '"left"' in description
    assert "femur.stl" in description
    assert "9300000000.0" in description


def test_runtimes_agree(runs):
    parity = json.loads((runs / "small" / "tables" / "parity.json").read_text())
    assert {row["runtime"] for row in parity} == {
        "condyle C++",
        "condyle fused",
        "onnxruntime Python",
    }
    assert {row["output"] for row in parity} == {"wrench", "stiffness", "error", "trust"}
    assert all(row["agrees"] for row in parity), parity


def test_a_second_run_does_nothing(runs):
    log, _ = run(runs)
    assert log.ran == []
    assert log.unchanged == ["implant", "reference", "sample", "train", "evaluate"]


def test_only_what_depends_on_a_change_runs_again(runs):
    log, _ = run(runs, training=SMALL["training"] | {"max_epochs": 9})
    assert log.unchanged == ["implant", "reference", "sample"]
    assert log.ran == ["train", "evaluate"]


def test_samples_of_another_design_are_not_overwritten(runs):
    manifest = runs / "small" / "samples" / "manifest.json"
    before = manifest.read_bytes()
    with pytest.raises(CondyleError, match=r"manifest\.json.*seed"):
        run(runs, sampling=SMALL["sampling"] | {"seed": 6})
    assert manifest.read_bytes() == before


def test_no_such_stage(tmp_path):
    with pytest.raises(ValueError, match="stage 'trian': must be one of implant, reference"):
        run(tmp_path, until="trian")
