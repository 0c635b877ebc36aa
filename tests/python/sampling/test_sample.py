# SPDX-License-Identifier: Apache-2.0
import dataclasses
import errno
import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from spring_contact import SpringSolver, spring_curves

from condyle.errors import InputDataError
from condyle.sampling import (
    Dataset,
    DomainTarget,
    Prescribed,
    ReferenceCurves,
    SamplingPlan,
    SamplingProgress,
    Solved,
    sample,
)

IDENTITY = {"implant": {"femur": "f00", "insert": "1e5"}, "side_of_body": "right"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An uninterrupted run of the plan fixture."""
    directory = tmp_path_factory.mktemp("whole")
    plan = SamplingPlan(
        targets=(DomainTarget(2, 170, 30), DomainTarget(4, 85, 15)),
        seed=2017,
        pilot=48,
        chunk_rows=64,
    )
    sample(plan, spring_curves(), SpringSolver(), directory, IDENTITY)
    return directory


def test_targets_are_met_exactly_in_every_domain_and_split(whole: Path) -> None:
    data = Dataset.read(whole)
    counts = {
        (domain, split): len(data.select(domain=domain, split=split))
        for domain in (2, 4)
        for split in ("train", "test")
    }
    assert counts == {(2, "train"): 170, (2, "test"): 30, (4, "train"): 85, (4, "test"): 15}
    assert np.all(np.diff(data.candidate.astype(np.int64)) > 0)


def test_report_is_table_1_and_agrees_with_the_candidates(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    solver = SpringSolver()
    report = sample(plan, curves, solver, tmp_path, IDENTITY)
    for row in report.domains:
        assert row.candidates == row.accepted + sum(row.rejected.values())
        assert row.accepted >= row.train + row.test
        # The springs cost 6 evaluations a candidate that statics allow.
        rejected = row.rejected.get("overclosure", 0) + row.rejected.get("off_insert", 0)
        assert row.solver_evaluations == 6 * (row.accepted + rejected)
        assert row.evaluations_per_accepted == pytest.approx(6 * (1 + rejected / row.accepted))
        feasible = row.accepted + rejected
        assert row.feasible_acceptance == pytest.approx(row.accepted / feasible)
    # |Mx| ≤ SPACING · Fy holds on 0.5 · 0.023 · 100 / 5 of the rectangle, so not on 77 % of it.
    boundary = report.domains[1]
    within_range = boundary.candidates - boundary.rejected["beyond_range"]
    assert 0.7 < boundary.rejected["no_equilibrium"] / within_range < 0.84
    table = json.loads(json.dumps(report.to_json()))
    assert [row["paper_train"] for row in table["domains"]] == [27_253, 9_990]
    assert (table["train"], table["test"], table["resumed"]) == (255, 45, False)


def test_a_complete_dataset_is_not_sampled_again(
    whole: Path, plan: SamplingPlan, curves: ReferenceCurves, content
) -> None:
    before = content(whole)
    never = SpringSolver(stop_after=0)
    report = sample(plan, curves, never, whole, IDENTITY)
    assert report.resumed
    assert report.samples == 300
    assert content(whole) == before


@pytest.mark.parametrize("calls", [0, 1, 3, 6, 9])
def test_an_interrupted_run_goes_on_to_the_same_bytes(
    whole: Path, plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path, content, calls: int
) -> None:
    with pytest.raises(KeyboardInterrupt):
        sample(plan, curves, SpringSolver(stop_after=calls), tmp_path, IDENTITY)
    with pytest.raises(InputDataError, match="sampling is not complete"):
        Dataset.read(tmp_path)
    parts = sorted(tmp_path.rglob("part-*.parquet"))
    assert len(parts) == calls
    stamps = [part.stat().st_mtime_ns for part in parts]
    rest = SpringSolver()
    report = sample(plan, curves, rest, tmp_path, IDENTITY)
    assert report.resumed
    assert [part.stat().st_mtime_ns for part in parts] == stamps
    assert content(tmp_path) == content(whole)
    total = len([name for name in content(whole) if name.startswith("candidates/")])
    assert rest.calls == total - calls


def test_a_run_killed_between_the_last_candidate_and_the_manifest_is_finished(
    whole: Path, plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path, content, monkeypatch
) -> None:
    from condyle.sampling import sample_parts

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(sample_parts, "encode_part", stop)
        with pytest.raises(KeyboardInterrupt):
            sample(plan, curves, SpringSolver(), tmp_path, IDENTITY)
    sample(plan, curves, SpringSolver(stop_after=0), tmp_path, IDENTITY)
    assert content(tmp_path) == content(whole)


def test_a_full_disk_is_told_and_what_was_written_is_kept(
    whole: Path,
    plan: SamplingPlan,
    curves: ReferenceCurves,
    tmp_path: Path,
    content,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    room = 4
    real = os.fsync

    def fsync(descriptor: int) -> None:
        nonlocal room
        room -= 1
        if room < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(descriptor)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", fsync)
        with pytest.raises(InputDataError, match=r"parquet cannot be written: No space left on"):
            sample(plan, curves, SpringSolver(), tmp_path, IDENTITY)
    # The manifest took the first place, three parts the others.
    assert len(list(tmp_path.rglob("part-*.parquet"))) == 3
    sample(plan, curves, SpringSolver(), tmp_path, IDENTITY)
    assert content(tmp_path) == content(whole)


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_any_number_of_threads_gives_the_same_bytes(
    whole: Path, plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path, content, workers: int
) -> None:
    with ThreadPoolExecutor(workers) as executor:
        sample(plan, curves, SpringSolver(pause=0.002), tmp_path, IDENTITY, executor=executor)
    assert content(tmp_path) == content(whole)


def test_another_seed_is_another_dataset_of_the_same_numbers(
    whole: Path, plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    sample(dataclasses.replace(plan, seed=7), curves, SpringSolver(), tmp_path, IDENTITY)
    here, there = Dataset.read(tmp_path), Dataset.read(whole)
    assert len(here) == len(there)
    assert not np.array_equal(here.split, there.split)


def test_missing_samples_are_made_up_for_by_shifted_rounds(
    curves: ReferenceCurves, tmp_path: Path
) -> None:
    springs = SpringSolver()

    def harder_than_the_pilot(prescribed: Prescribed) -> Solved:
        solved = springs(prescribed)
        if springs.calls > 1:
            solved.status[::2] = "not_converged"
        return solved

    plan = SamplingPlan((DomainTarget(4, 90, 10),), seed=3, pilot=64)
    report = sample(plan, curves, harder_than_the_pilot, tmp_path, IDENTITY)
    (row,) = report.domains
    assert row.rounds > 1
    assert row.train + row.test == 100
    data = Dataset.read(tmp_path)
    assert len(np.unique(data.poses, axis=0)) == 100


def test_progress_is_told_after_every_chunk(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    seen: list[SamplingProgress] = []
    solver = SpringSolver()
    report = sample(plan, curves, solver, tmp_path, IDENTITY, seen.append)
    assert len(seen) == solver.calls
    for row in report.domains:
        last = [step for step in seen if step.domain == row.domain][-1]
        assert (last.done, last.accepted) == (last.round_size, row.accepted)
        assert last.target == row.train + row.test


def test_samples_of_something_else_are_not_mixed(
    plan: SamplingPlan, curves: ReferenceCurves, whole: Path, content
) -> None:
    before = content(whole)
    other = {**IDENTITY, "implant": {"femur": "f00", "insert": "bad"}}
    with pytest.raises(InputDataError, match=r"identity\.implant\.insert is '1e5' there, 'bad' is"):
        sample(plan, curves, SpringSolver(), whole, other)
    bigger = plan.with_targets({2: {"train": 171}})
    with pytest.raises(InputDataError, match=r"manifest\.json: plan\.targets is .*'train': 170"):
        sample(bigger, curves, SpringSolver(), whole, IDENTITY)
    walk = ReferenceCurves(curves.curves[:1])
    with pytest.raises(InputDataError, match=r"manifest\.json: curves\.activities is"):
        sample(plan, walk, SpringSolver(), whole, IDENTITY)
    assert content(whole) == before


def test_a_damaged_candidate_part_is_named_and_removing_it_heals(
    plan: SamplingPlan, curves: ReferenceCurves, whole: Path, tmp_path: Path, content
) -> None:
    with pytest.raises(KeyboardInterrupt):
        sample(plan, curves, SpringSolver(stop_after=5), tmp_path, IDENTITY)
    part = sorted(tmp_path.rglob("part-*.parquet"))[2]
    part.write_bytes(part.read_bytes()[:-100])
    with pytest.raises(InputDataError, match=f"{part.name} is damaged.*remove this file"):
        sample(plan, curves, SpringSolver(), tmp_path, IDENTITY)
    part.unlink()
    sample(plan, curves, SpringSolver(), tmp_path, IDENTITY)
    assert content(tmp_path) == content(whole)


def test_a_part_of_another_run_is_told_apart(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    for name, seed in (("a", 1), ("b", 2)):
        with pytest.raises(KeyboardInterrupt):
            run = dataclasses.replace(plan, seed=seed)
            sample(run, curves, SpringSolver(stop_after=3), tmp_path / name, IDENTITY)
    stray = sorted((tmp_path / "a").rglob("part-*.parquet"))[1]
    stray.replace(tmp_path / "b" / stray.relative_to(tmp_path / "a"))
    with pytest.raises(InputDataError, match=r"its design is '\w{64}', '\w{64}' belongs here"):
        sample(dataclasses.replace(plan, seed=2), curves, SpringSolver(), tmp_path / "b", IDENTITY)


def test_candidates_without_a_manifest_are_not_taken_over(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    (tmp_path / "candidates").mkdir()
    with pytest.raises(InputDataError, match=r"holds candidates/ but no manifest\.json"):
        sample(plan, curves, SpringSolver(), tmp_path, IDENTITY)


def test_curves_of_another_implant_stop_at_the_pilot_with_the_reasons(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    def off(prescribed: Prescribed) -> Solved:
        solved = SpringSolver()(prescribed)
        return dataclasses.replace(solved, status=np.full(len(prescribed), "off_insert"))

    with pytest.raises(
        InputDataError, match=r"domain 2 \(global\): 0 of 48 pilot .*\d+ off_insert"
    ):
        sample(plan, curves, off, tmp_path, IDENTITY)


def test_rounds_end_when_a_solver_stops_accepting(curves: ReferenceCurves, tmp_path: Path) -> None:
    calls = 0

    def tiring(prescribed: Prescribed) -> Solved:
        nonlocal calls
        calls += 1
        solved = SpringSolver()(prescribed)
        if calls > 1:
            return dataclasses.replace(solved, status=np.full(len(prescribed), "not_converged"))
        return solved

    plan = SamplingPlan((DomainTarget(2, 20, 4),), seed=1, pilot=64, max_rounds=3)
    with pytest.raises(InputDataError, match=r"0 of 24 samples after 3 rounds \(max_rounds\); rej"):
        sample(plan, curves, tiring, tmp_path, IDENTITY)


def test_an_unwritable_directory_is_named(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(InputDataError, match="taken cannot be written: File exists"):
        sample(plan, curves, SpringSolver(), tmp_path / "taken", IDENTITY)


def test_an_identity_that_is_not_json_is_refused(
    plan: SamplingPlan, curves: ReferenceCurves, tmp_path: Path
) -> None:
    with pytest.raises(InputDataError, match="identity cannot be written as JSON"):
        sample(plan, curves, SpringSolver(), tmp_path, {"implant": np.zeros(3)})
