# SPDX-License-Identifier: Apache-2.0
"""Static equilibria carry what was prescribed, and say so when none does."""

import numpy as np
import pytest

from condyle.contact import Derivatives, MeshContact
from condyle.errors import InputDataError
from condyle.fdk import (
    StaticEquilibriumSettings,
    StaticEquilibriumSolver,
    solve_static_equilibria,
)


def prescribed(count: int, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    Fy = rng.uniform(30.0, 2200.0, count)
    return {
        "x": rng.uniform(-0.003, 0.005, count),
        "z": rng.uniform(-0.001, 0.001, count),
        "theta_y": rng.uniform(-0.07, 0.07, count),
        "theta_z": rng.uniform(-1.1, 0.0, count),
        "Fy": Fy,
        "Mx": rng.uniform(-0.015, 0.015, count) * Fy,
    }


def test_prescribed_loads_are_carried(right_knee: MeshContact) -> None:
    load = prescribed(60, seed=3)
    solved = solve_static_equilibria(right_knee, **load, threads=1)
    assert np.all(solved.converged)
    # Recomputed by the contact model at the poses found.
    total = right_knee.evaluate(solved.poses, Derivatives.none, 1).wrench.sum(axis=1)
    assert np.all(np.abs(total[:, 1] - load["Fy"]) <= 1e-3 * load["Fy"] + 0.01)
    assert np.all(np.abs(total[:, 3] - load["Mx"]) <= 1e-3 * np.abs(load["Mx"]) + 5e-4)
    np.testing.assert_array_equal(
        solved.poses[:, [0, 2, 4, 5]].T, [load[k] for k in ("x", "z", "theta_y", "theta_z")]
    )
    np.testing.assert_allclose(solved.wrenches.sum(axis=1), total, rtol=1e-12, atol=1e-9)
    assert solved.evaluations.mean() <= 8.0
    assert solved.stiffness.shape == (60, 2, 6, 6)
    assert solved.map_evaluations > 0


def test_result_does_not_depend_on_threads(right_knee: MeshContact) -> None:
    load = prescribed(12, seed=4)
    one = solve_static_equilibria(right_knee, **load, threads=1)
    two = solve_static_equilibria(right_knee, **load, threads=2)
    assert one.poses.tobytes() == two.poses.tobytes()


def test_theta_x_given_solves_y_alone_from_a_start(right_knee: MeshContact) -> None:
    solved = solve_static_equilibria(
        right_knee,
        0.0,
        0.0,
        0.02,
        -0.3,
        [40.0, 70.0],
        theta_x=[0.03, -0.04],
        start=[[0.043, 0.0]] * 2,
    )
    assert list(solved.status) == ["converged", "converged"]
    np.testing.assert_array_equal(solved.poses[:, 3], [0.03, -0.04])
    np.testing.assert_allclose(
        solved.wrenches.sum(axis=1)[:, 1], [40.0, 70.0], rtol=1e-3, atol=0.01
    )


def test_what_statics_forbids_costs_nothing(right_knee: MeshContact) -> None:
    solved = solve_static_equilibria(right_knee, 0.0, 0.0, 0.0, -0.3, [50.0, -20.0], [5.0, 0.0])
    assert list(solved.status) == ["no_equilibrium", "no_equilibrium"]
    assert solved.evaluations.sum() == 0


def test_mistakes_are_named(right_knee: MeshContact) -> None:
    with pytest.raises(InputDataError, match="row 1: static load: Fy is nan: must be finite"):
        solve_static_equilibria(right_knee, 0.0, 0.0, 0.0, 0.0, [1.0, np.nan], 0.0)
    with pytest.raises(InputDataError, match="give either Mx or theta_x"):
        solve_static_equilibria(right_knee, 0.0, 0.0, 0.0, 0.0, 1.0)
    with pytest.raises(InputDataError, match="do not fit together"):
        solve_static_equilibria(right_knee, [0.0] * 3, 0.0, 0.0, 0.0, [1.0] * 2, 0.0)
    settings = StaticEquilibriumSettings()
    settings.touch.step = 0.0
    with pytest.raises(
        InputDataError, match=r"touch search: step is 0.000000: must be above 1e-6 m"
    ):
        solve_static_equilibria(right_knee, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, settings=settings)


def test_a_solver_kept_over_calls_gives_the_bytes_of_single_calls(right_knee):
    solver = StaticEquilibriumSolver(right_knee)
    rng = np.random.default_rng(3)
    x, theta_z = rng.uniform(-2e-3, 6e-3, 8), rng.uniform(-0.9, -0.1, 8)
    Fy = rng.uniform(80.0, 900.0, 8)
    once = solve_static_equilibria(right_knee, x, 2e-4, 0.01, theta_z, Fy, 0.004 * Fy, threads=1)
    tilted = solve_static_equilibria(
        right_knee, x, 2e-4, 0.01, theta_z, Fy, theta_x=0.002, threads=1
    )
    mapped = []
    for rows in (slice(5, 8), slice(0, 5), slice(0, 8)):
        kept = solver.solve(
            x[rows], 2e-4, 0.01, theta_z[rows], Fy[rows], 0.004 * Fy[rows], threads=1
        )
        assert np.array_equal(kept.poses, once.poses[rows])
        assert np.array_equal(kept.wrenches, once.wrenches[rows])
        mapped.append(kept.map_evaluations)
    # The last call asks only where the map is known already.
    assert mapped[0] > 0
    assert mapped[2] == 0
    again = solver.solve(x, 2e-4, 0.01, theta_z, Fy, theta_x=0.002, threads=2)
    assert np.array_equal(again.poses, tilted.poses)
