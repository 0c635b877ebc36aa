# SPDX-License-Identifier: Apache-2.0
import dataclasses

import numpy as np
import pytest
from spring_contact import SpringSolver, loads

from condyle.conventions import POSE_COLUMNS
from condyle.sampling import (
    DomainInputs,
    Prescribed,
    ReferenceCurves,
    SamplingPlan,
    Solved,
    build_domain,
)
from condyle.sampling.chunk import Chunk
from condyle.sampling.evaluate_chunk import ACCEPTED, REJECTIONS, evaluate_chunk
from condyle.sampling.hammersley import hammersley
from condyle.sampling.part_files import columns_array, wrench_array
from condyle.sampling.selection import candidate_ids


@pytest.fixture
def domain(plan: SamplingPlan, curves: ReferenceCurves):
    return build_domain(2, DomainInputs(plan, curves))


CHUNK = Chunk(domain=2, round_number=1, round_size=1500, start=0, stop=1500)


def test_every_candidate_has_its_verdict_and_the_counts_are_the_rows(plan, domain) -> None:
    table, tally = evaluate_chunk(CHUNK, domain, plan, SpringSolver())
    status = np.array(table.column("status").to_pylist())
    names, counts = np.unique(status, return_counts=True)
    # The fixture reaches every reason but not_converged; in_contact is domain 6's.
    assert set(names) == {ACCEPTED, *REJECTIONS} - {"not_converged", "in_contact"}
    assert tally["counts"] == dict(zip(names, counts, strict=True))
    evaluations = table.column("evaluations").to_numpy()
    assert tally["evaluations"] == {name: int(evaluations[status == name].sum()) for name in names}
    assert np.array_equal(table.column("candidate").to_numpy(), candidate_ids(2, 1, 0, 1500))


def test_infeasible_candidates_are_told_before_the_solver_is_asked(plan, domain) -> None:
    asked: list[Prescribed] = []

    def solver(prescribed: Prescribed) -> Solved:
        asked.append(prescribed)
        return SpringSolver()(prescribed)

    table, _ = evaluate_chunk(CHUNK, domain, plan, solver)
    (prescribed,) = asked
    assert np.all(prescribed.Fy > 0)
    assert np.all(
        (prescribed.theta_z >= plan.min_theta_z) & (prescribed.theta_z <= plan.max_theta_z)
    )
    status = np.array(table.column("status").to_pylist())
    drawn = domain.prescribe(hammersley(1500))
    assert np.array_equal(status == "non_compressive", ~(drawn.Fy > 0))
    beyond = (drawn.theta_z < plan.min_theta_z) | (drawn.theta_z > plan.max_theta_z)
    assert np.array_equal(status == "beyond_range", beyond & (drawn.Fy > 0))


def test_accepted_candidates_carry_what_was_prescribed(plan, domain) -> None:
    table, _ = evaluate_chunk(CHUNK, domain, plan, SpringSolver())
    rows = np.array(table.column("status").to_pylist()) == ACCEPTED
    drawn = domain.prescribe(hammersley(1500)).to_array()[rows]
    poses, wrenches = columns_array(table, POSE_COLUMNS)[rows], wrench_array(table)[rows]
    assert np.array_equal(poses[:, [0, 2, 4, 5]], drawn[:, [0, 2, 4, 5]])
    total = loads(poses).sum(axis=1)
    # y is a difference of 31 mm and below 1 mm: eps · 31 mm · stiffness, a few roundings.
    np.testing.assert_allclose(total[:, 1], drawn[:, 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(total[:, 3], drawn[:, 3], rtol=0, atol=1e-10)
    assert np.array_equal(wrenches, loads(poses))


def test_rejected_candidates_leave_no_pose(plan, domain) -> None:
    table, _ = evaluate_chunk(CHUNK, domain, plan, SpringSolver())
    rejected = np.array(table.column("status").to_pylist()) != ACCEPTED
    assert np.all(np.isnan(columns_array(table, POSE_COLUMNS)[rejected]))
    assert np.all(np.isnan(wrench_array(table)[rejected]))
    assert not np.any(np.isnan(wrench_array(table)[~rejected]))


@pytest.mark.parametrize(
    ("load", "relative", "absolute"), [(1, 1e-3, 0.01), (3, 1e-3, 0.0005)], ids=["Fy", "Mx"]
)
@pytest.mark.parametrize(("times", "verdict"), [(0.99, ACCEPTED), (1.01, "not_converged")])
def test_what_a_solver_calls_converged_must_carry_the_loads(
    plan, domain, load: int, relative: float, absolute: float, times: float, verdict: str
) -> None:
    def solver(prescribed: Prescribed) -> Solved:
        solved = SpringSolver()(prescribed)
        asked = prescribed.Fy if load == 1 else prescribed.Mx
        solved.wrenches[:, 1, load] += times * (relative * np.abs(asked) + absolute)
        return solved

    honest, _ = evaluate_chunk(CHUNK, domain, plan, SpringSolver())
    table, _ = evaluate_chunk(CHUNK, domain, plan, solver)
    before, after = (np.array(t.column("status").to_pylist()) for t in (honest, table))
    assert set(after[before == ACCEPTED]) == {verdict}


def test_a_plan_s_depth_limit_holds_whatever_the_solver_s(plan, domain) -> None:
    shallow = dataclasses.replace(plan, max_depth=3e-4)
    table, tally = evaluate_chunk(CHUNK, domain, shallow, SpringSolver())
    rows = np.array(table.column("status").to_pylist()) == ACCEPTED
    assert 0 < rows.sum() < 1500
    assert np.nanmax(table.column("max_depth").to_numpy()[rows]) <= 3e-4
    _, deep = evaluate_chunk(CHUNK, domain, plan, SpringSolver())
    assert tally["counts"]["overclosure"] > deep["counts"]["overclosure"]


def test_a_later_round_is_another_set_and_a_chunk_a_piece_of_it(plan, domain) -> None:
    def prescribed(round_number: int, start: int, stop: int) -> np.ndarray:
        chunk = Chunk(2, round_number, 200, start, stop)
        table, _ = evaluate_chunk(chunk, domain, plan, SpringSolver())
        return table.column("prescribed_Fy").to_numpy()

    assert not np.any(np.isin(prescribed(2, 0, 200), prescribed(1, 0, 200)))
    assert not np.any(np.isin(prescribed(2, 0, 200), prescribed(3, 0, 200)))
    assert np.array_equal(prescribed(2, 60, 140), prescribed(2, 0, 200)[60:140])
