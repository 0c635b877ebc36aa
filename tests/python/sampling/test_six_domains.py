# SPDX-License-Identifier: Apache-2.0
"""All six domains together, on the closed-form contact of spring_contact.py."""

import json
import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from spring_contact import SpringSolver, loads, spring_curves

from condyle.errors import InputDataError
from condyle.sampling import (
    PRESCRIBED_COLUMNS,
    Dataset,
    DomainTarget,
    SamplingPlan,
    Solved,
    read_candidates,
    sample,
)
from condyle.sampling.domain_proximity import RAISES

PLAN = SamplingPlan(
    targets=(
        DomainTarget(1, 83, 0),  # 4 time frames of 20 or 21
        DomainTarget(2, 34, 6),
        DomainTarget(3, 68, 12),
        DomainTarget(4, 34, 6),
        DomainTarget(5, 230, 42),  # copies of 58 and 11 points: two and two copies are dropped
        DomainTarget(6, 17, 3),
    ),
    seed=2017,
    pilot=48,
    chunk_rows=64,
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("six")
    sample(PLAN, spring_curves(), SpringSolver(), directory, {"implant": "springs"})
    return directory


@pytest.fixture(scope="module")
def data(whole: Path) -> Dataset:
    return Dataset.read(whole)


def entry(data: Dataset, domain: int) -> dict:
    (row,) = [row for row in data.manifest["domains"] if row["domain"] == domain]
    return row


def test_counts_are_met_in_every_domain_and_split(data: Dataset) -> None:
    for target in PLAN.targets:
        for split, count in (("train", target.train), ("test", target.test)):
            assert len(data.select(domain=target.domain, split=split)) == count
    assert len(np.unique(data.candidate)) == len(data)
    assert len(np.unique(data.poses, axis=0)) == len(data)


def test_wrenches_are_the_contact_s_in_every_domain(data: Dataset) -> None:
    assert np.array_equal(data.wrenches, loads(data.poses))
    assert np.array_equal(data.two_sided, np.all(data.wrenches[:, :, 1] > 0, axis=1))


def test_a_point_and_its_raised_copies_are_in_one_split(data: Dataset) -> None:
    boundary, copies = data.select(domain=4), data.select(domain=5)
    own = dict(zip(boundary.candidate.tolist(), boundary.split, strict=True))
    split_of: dict[int, str] = {}
    for source, split in zip(copies.source.tolist(), copies.split, strict=True):
        assert split_of.setdefault(source, split) == split
        assert own.get(source, split) == split
    # Every sample of domain 4 has copies, and so many points more make up the numbers.
    assert set(own) < set(split_of)
    splits = list(split_of.values())
    assert (splits.count("train"), splits.count("test")) == (58, 11)
    for others in (boundary, data.select(domain=2), data.select(domain=3)):
        assert np.array_equal(others.source, others.candidate)


def test_copies_are_their_points_raised(whole: Path, data: Dataset) -> None:
    copies, boundary = data.select(domain=5), data.select(domain=4)
    pose_of = dict(zip(boundary.candidate.tolist(), boundary.poses, strict=True))
    seen = set()
    for pose, source in zip(copies.poses, copies.source.tolist(), strict=True):
        if source in pose_of:
            raised = pose - pose_of[source]
            assert np.array_equal(np.delete(raised, 1), np.zeros(5))
            # The raise is a difference of 33 mm: a rounding of it.
            (step,) = [r for r in RAISES if abs(raised[1] - r) < 1e-16]
            seen.add(step)
    assert seen == set(RAISES)
    # A boundary point carries 100 N on springs of 1.7 MN/m, 0.06 mm deep: 0.5 mm clears it.
    assert not np.any(copies.wrenches)
    candidates = read_candidates(whole, 5)
    assert len(candidates.status) == 4 * entry(data, 5)["points"] == 276
    assert set(candidates.status) == {"accepted"}


def test_far_samples_have_no_load_and_stand_above_the_boundary(data: Dataset) -> None:
    far, boundary = data.select(domain=6), data.select(domain=4)
    assert not np.any(far.wrenches)
    highest = boundary.poses[:, 1].max()
    assert np.all(far.poses[:, 1] >= highest)
    # Low-discrepancy in y: with some 20 points the top fifth of the range is not empty.
    assert 0.08 + 0.2 * highest < far.poses[:, 1].max() <= 0.1
    assert np.ptp(far.poses[:, 3]) > 0.5 * np.ptp(boundary.poses[:, 3])


def test_most_single_sided_samples_are_and_the_others_are_counted(data: Dataset) -> None:
    single, row = data.select(domain=3), entry(data, 3)
    assert 0 < np.mean(single.two_sided) < 0.25
    loaded = single.wrenches[:, :, 1] > 0
    # Both sides lift off, each in a good part of the samples.
    assert np.all(np.mean(loaded & ~single.two_sided[:, None], axis=0) > 0.2)
    assert np.all((single.prescribed_loads[:, 0] > 0) & (single.prescribed_loads[:, 0] <= 100))
    assert np.all(np.isnan(single.prescribed_loads[:, 1]))
    # On springs 100 N go to one side at |θx| = 100 / 1.7e6 / (2 · 23 mm), found to 0.2 rad / 2^12.
    lift_off = 100 / 1.7e6 / (2 * 0.023)
    np.testing.assert_allclose(
        row["definition"]["lift_off"], [-lift_off, lift_off], rtol=0, atol=0.2 / 2**12
    )
    low, high = row["definition"]["theta_x"]
    assert low < -lift_off < lift_off < high
    assert row["two_sided"] >= np.sum(single.two_sided)


def test_every_time_frame_has_its_samples_within_its_envelope(data: Dataset) -> None:
    envelope, row = data.select(domain=1), entry(data, 1)
    assert row["samples_per_time_frame"] == [20, 21]
    spans = []
    for curve in spring_curves().curves:
        wide, ends = (
            np.column_stack([curve.resampled(n).column(name) for name in PRESCRIBED_COLUMNS])
            for n in (1000, 2)
        )
        spans += [(end - wide.std(axis=0), end + wide.std(axis=0)) for end in ends]
    loads_asked = envelope.prescribed_loads
    asked = np.column_stack(
        [envelope.poses[:, 0], loads_asked[:, 0], envelope.poses[:, 2], loads_asked[:, 1],
         envelope.poses[:, 4], envelope.poses[:, 5]]
    )  # fmt: skip
    eps = 1e-12
    inside = np.array([np.all((asked >= a - eps) & (asked <= b + eps), axis=1) for a, b in spans])
    # Every sample lies in a time frame's box, every box holds its share at least.
    assert np.all(inside.any(axis=0))
    assert np.all(inside.sum(axis=1) >= 20)


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_any_number_of_threads_gives_the_same_bytes(
    whole: Path, tmp_path: Path, content, workers: int
) -> None:
    with ThreadPoolExecutor(workers) as executor:
        solver = SpringSolver(pause=0.001)
        sample(PLAN, spring_curves(), solver, tmp_path, {"implant": "springs"}, executor=executor)
    assert content(tmp_path) == content(whole)


@pytest.mark.parametrize("calls", [2, 35, 47])
def test_an_interrupted_run_goes_on_to_the_same_bytes(
    whole: Path, tmp_path: Path, content, calls: int
) -> None:
    with pytest.raises(KeyboardInterrupt):
        sample(
            PLAN, spring_curves(), SpringSolver(stop_after=calls), tmp_path, {"implant": "springs"}
        )
    sample(PLAN, spring_curves(), SpringSolver(), tmp_path, {"implant": "springs"})
    assert content(tmp_path) == content(whole)


def test_copies_that_fail_are_made_up_for_by_spare_points(tmp_path: Path) -> None:
    springs = SpringSolver()
    failed: list[int] = []

    def sticky(prescribed) -> Solved:
        solved = springs(prescribed)
        if prescribed.pose_given and not failed:
            failed.append(len(prescribed))
            solved.status[:3] = "overclosure"
        return solved

    plan = SamplingPlan((DomainTarget(4, 17, 3), DomainTarget(5, 80, 16)), seed=4, pilot=64)
    report = sample(plan, spring_curves(), sticky, tmp_path, {})
    row = report.domains[1]
    assert (row.rounds, row.rejected) == (2, {"overclosure": 3})
    assert len(Dataset.read(tmp_path).select(domain=5)) == 96


def test_a_far_domain_below_the_boundary_is_refused(tmp_path: Path) -> None:
    plan = SamplingPlan(
        (DomainTarget(4, 17, 3), DomainTarget(6, 8, 2)), seed=4, pilot=64, far_max_y=0.02
    )
    with pytest.raises(InputDataError, match=r"far_max_y is 0\.02 m; it must be above the highest"):
        sample(plan, spring_curves(), SpringSolver(), tmp_path, {})


def test_the_report_sets_the_paper_s_counts_beside(whole: Path) -> None:
    report = sample(
        PLAN, spring_curves(), SpringSolver(stop_after=0), whole, {"implant": "springs"}
    )
    table = json.loads(json.dumps(report.to_json()))
    assert sum(row["paper_train"] + row["paper_test"] for row in table["domains"]) == 154_310
    for row in table["domains"]:
        assert row["candidates"] == row["accepted"] + sum(row["rejected"].values())
        assert math.isfinite(row["evaluations_per_accepted"])


def test_a_time_frame_without_equilibria_passes_its_samples_on(tmp_path: Path) -> None:
    springs = SpringSolver()

    def extended_only(prescribed) -> Solved:
        solved = springs(prescribed)
        solved.status[prescribed.theta_z < -0.3] = "not_converged"
        return solved

    # Of the four time frames the first two lie at θz = -0.8 ± 0.39: all of it below -0.3.
    plan = SamplingPlan((DomainTarget(1, 80, 0),), seed=4, pilot=64, min_acceptance=0.05)
    sample(plan, spring_curves(), extended_only, tmp_path, {})
    data = Dataset.read(tmp_path)
    assert entry(data, 1)["samples_per_time_frame"] == [0, 40]
    assert len(data.select(domain=1, split="train")) == 80
    assert np.all(data.poses[:, 5] >= -0.3)
