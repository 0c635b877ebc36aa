# SPDX-License-Identifier: Apache-2.0
import warnings

import numpy as np
import pytest
from recruitment_problems import PRICE, by_clarabel, random_problem

from condyle.errors import InputDataError
from condyle.recruitment import Recruiter, Recruitment, Reserves, recruit

CRITERIA = (1.0, 1.5, 2.0, 3.0, 5.0, "min_max")


def run(problem, criterion, bounds: bool = True, **more) -> Recruitment:
    reserves = None if problem.reserves is None else Reserves(problem.reserves, PRICE)
    return recruit(
        problem.moment_arms,
        problem.loads,
        problem.strengths,
        criterion=criterion,
        upper_bounds=bounds,
        reserves=reserves,
        **more,
    )


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("bounds", [True, False])
@pytest.mark.parametrize("with_reserves", [True, False])
def test_objective_and_forces_are_those_of_an_independent_solver(
    criterion, bounds, with_reserves
) -> None:
    pytest.importorskip("cvxpy")
    pytest.importorskip("clarabel")
    for seed in range(3):
        problem = random_problem(seed, with_reserves)
        found = run(problem, criterion, bounds)
        assert found.converged, found.message
        assert max(found.primal, found.stationarity, found.complementarity) <= 1e-9
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "may be inaccurate": asked for more than it can reach
            objective, forces = by_clarabel(problem, criterion, bounds)
        assert found.objective == pytest.approx(objective, rel=1e-8)
        # Power cones leave clarabel's small forces open; a quadratic program is as exact as ours.
        if criterion == 2.0:
            assert np.abs(found.forces - forces).max() <= 1e-4


def test_batches_are_their_time_frames_with_and_without_warm_starts() -> None:
    problem = random_problem(5, False)
    n, m = problem.moment_arms.shape
    factors = 1.0 + 0.1 * np.sin(np.arange(20))
    arms = np.broadcast_to(problem.moment_arms, (20, n, m))
    loads = factors[:, None] * problem.loads
    recruiter = Recruiter(n, m)
    warm = recruiter.solve_series(arms, loads, problem.strengths)
    cold = recruiter.solve_series(arms, loads, problem.strengths, warm_starts=False)
    assert warm.converged.all()
    assert warm.iterations[1:].mean() < cold.iterations[1:].mean()
    # Both to rounding: 1e-9 N of 3 000.
    np.testing.assert_allclose(warm.forces, cold.forces, rtol=0, atol=1e-9)
    alone = recruiter.solve(problem.moment_arms, loads[7], problem.strengths)
    np.testing.assert_array_equal(alone.forces, cold.forces[7])
    np.testing.assert_allclose(arms[0] @ warm.forces.T, loads.T, rtol=0, atol=1e-10)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_derivatives_carry_the_change_of_loads(criterion) -> None:
    problem = random_problem(6, False)
    n, m = problem.moment_arms.shape
    recruiter = Recruiter(n, m, criterion=criterion)
    found = recruiter.solve(
        problem.moment_arms, problem.loads, problem.strengths, with_forces_by_loads=True
    )
    assert found.forces_by_loads is not None
    np.testing.assert_allclose(
        problem.moment_arms @ found.forces_by_loads, np.eye(n), rtol=0, atol=1e-8
    )
    changes = np.random.default_rng(1).uniform(-1.0, 1.0, (3, n))
    arms = np.random.default_rng(2).uniform(-0.01, 0.01, (3, n, m))
    along = recruiter.forces_along(changes, arms)
    assert along.regular
    # d(R f) = dτ: R df = dτ − dR f
    carried = along.forces @ problem.moment_arms.T + arms @ found.forces
    np.testing.assert_allclose(carried, changes, rtol=0, atol=1e-8)


def test_loads_out_of_reach_name_the_coordinate() -> None:
    problem = random_problem(7, False)
    loads = problem.loads.copy()
    loads[3] += 900.0
    names = ["hip_flex", "hip_add", "hip_rot", "knee_flex", "ankle_flex", "subtalar"]
    for criterion in CRITERIA:
        found = recruit(
            problem.moment_arms,
            loads,
            problem.strengths,
            criterion=criterion,
            coordinate_names=names,
        )
        assert found.status == "infeasible"
        assert found.unmet_coordinates[0] == "knee_flex"
        assert "knee_flex by" in found.message
        assert found.unmet[3] > 100.0


def test_wrong_input_says_what_and_where() -> None:
    problem = random_problem(8, False)
    strengths = problem.strengths.copy()
    strengths[4] = -1.0
    with pytest.raises(
        InputDataError, match=r"strength of soleus = -1: must be finite and at least 0"
    ):
        recruit(
            problem.moment_arms,
            problem.loads,
            strengths,
            muscle_names=[*"abcd", "soleus", *[f"m{i}" for i in range(25)]],
        )
    with pytest.raises(InputDataError, match="criterion 'max': must be 'min_max' or a number"):
        run(problem, "max")
    with pytest.raises(InputDataError, match=r"exponent = 0.5"):
        run(problem, 0.5)
    with pytest.raises(InputDataError, match=r"loads has 2 dimensions; 1 are needed"):
        recruit(problem.moment_arms, problem.loads[None], problem.strengths)
    with pytest.raises(InputDataError, match=r"strengths has shape \(1, 5\)"):
        recruit(problem.moment_arms, problem.loads, problem.strengths[:5])
    with pytest.raises(InputDataError, match=r"size of weights = 2: must be 30"):
        run(problem, 2.0, weights=[1.0, 2.0])
    with pytest.raises(InputDataError, match=r"minimum of muscle 2"):
        run(problem, 2.0, minima=2.0 * problem.strengths * (np.arange(30) == 2))
    with pytest.raises(InputDataError, match="give changes"):
        Recruiter(6, 30).forces_along()


def test_states_and_levels_say_who_is_where() -> None:
    arms = np.array([[0.043, 0.027, 0.061, -0.035]])
    strengths = np.array([830.0, 1450.0, 390.0, 900.0])
    found = recruit(arms, [19.0], strengths, criterion="min_max")
    assert found.states == ("at_level", "at_level", "at_level", "at_minimum")
    assert found.levels == pytest.approx((found.objective,))
    assert recruit(arms, [19.0], strengths, criterion=1.0).states == (
        "at_minimum",
        "between",
        "at_minimum",
        "at_minimum",
    )
