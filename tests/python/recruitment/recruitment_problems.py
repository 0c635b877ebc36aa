# SPDX-License-Identifier: Apache-2.0
"""Random recruitment problems, and an independent convex solver for them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    moment_arms: Floats
    loads: Floats
    strengths: Floats
    reserves: Floats | None  # strengths; the price is 5


PRICE = 5.0


def random_problem(seed: int, with_reserves: bool, n: int = 6, m: int = 30) -> Problem:
    """Feasible within its bounds; three coordinates a muscle; arms to 60 mm, strengths 50 to 3 000 N."""
    draw = np.random.default_rng(seed)
    strengths = np.exp(draw.uniform(np.log(50.0), np.log(3000.0), m))
    arms = np.zeros((n, m))
    for i in range(m):
        arms[(i + np.arange(3)) % n, i] = draw.uniform(-0.06, 0.06, 3)
    forces = strengths * np.maximum(0.0, draw.uniform(-0.5, 0.8, m))
    return Problem(arms, arms @ forces, strengths, np.full(n, 12.0) if with_reserves else None)


def by_clarabel(problem: Problem, criterion: float | str, bounds: bool) -> tuple[float, Floats]:
    """Objective and forces by cvxpy and clarabel; for min–max the first level and forces that have it."""
    import cvxpy as cp

    n, m = problem.moment_arms.shape
    matrix = problem.moment_arms * problem.strengths
    scale = np.abs(matrix).max(axis=1)
    # Unknowns of order one: activities in the least-squares ones' largest.
    size = float(np.abs(np.linalg.lstsq(matrix, problem.loads, rcond=None)[0]).max()) or 1.0
    activity = cp.Variable(m)
    left = (size * matrix / scale[:, None]) @ activity
    reserve = None
    if problem.reserves is not None:
        reserve = cp.Variable(n)
        left = left + cp.multiply(size * problem.reserves / scale, reserve)
    constraints = [left == problem.loads / scale, activity >= 0]
    if bounds:
        constraints.append(activity <= 1.0 / size)
    if criterion == "min_max":
        terms = [cp.max(activity)]
        if reserve is not None:
            terms.append(PRICE * cp.max(cp.abs(reserve)))
        objective, degree = cp.maximum(*terms) if len(terms) > 1 else terms[0], 1.0
    else:
        degree = float(criterion)
        objective = power_sum(activity, degree, constraints)
        if reserve is not None:
            objective = objective + PRICE * power_sum(reserve, degree, constraints)
    task = cp.Problem(cp.Minimize(objective), constraints)
    # As far as it can: where a power cone gets stuck short of a tolerance, the next one is asked for.
    for tolerance in (1e-13, 1e-12, 1e-11, 1e-10, 1e-9):
        tight = {f"tol_{kind}": tolerance for kind in ("gap_abs", "gap_rel", "feas")}
        task.solve(solver=cp.CLARABEL, max_iter=400, **tight)
        if task.status == cp.OPTIMAL:
            break
    return float(task.value) * size**degree, np.asarray(activity.value) * size * problem.strengths


def power_sum(x, p: float, constraints: list):  # type: ignore[no-untyped-def, type-arg]
    """Σ |x|^p, by a power cone for a p that has no simpler one."""
    import cvxpy as cp

    if p == 1.0:
        return cp.norm1(x)
    if p == 2.0:
        return cp.sum_squares(x)
    bound = cp.Variable(x.shape)
    constraints.append(cp.PowCone3D(bound, np.ones(x.shape), x, 1.0 / p))
    return cp.sum(bound)
