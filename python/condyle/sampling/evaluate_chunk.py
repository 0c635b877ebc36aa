# SPDX-License-Identifier: Apache-2.0
"""One chunk of candidates: from their place in a domain to a table of poses, wrenches and statuses.

A chunk is a function of the plan, the curves and the solver alone, so any process or machine may
evaluate any chunk.
"""

from __future__ import annotations

from collections import Counter
from typing import Any, Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, WRENCH_COLUMNS
from condyle.sampling.chunk import Chunk
from condyle.sampling.domain import SamplingDomain
from condyle.sampling.equilibrium_protocol import (
    CONVERGED,
    GIVEN_COLUMNS,
    SOLVER_STATUSES,
    Prescribed,
    Solved,
    StaticEquilibriumSolver,
    check_solved,
)
from condyle.sampling.part_files import CANDIDATE_SCHEMA
from condyle.sampling.plan import SamplingPlan

ACCEPTED: Final = "accepted"
#: Reasons known before a solver is asked: contact cannot pull, and no component articulates that
#: far.
NON_COMPRESSIVE: Final = "non_compressive"
BEYOND_RANGE: Final = "beyond_range"
#: A pose of a domain that lies beyond contact, and touches.
IN_CONTACT: Final = "in_contact"
REJECTIONS: Final = (NON_COMPRESSIVE, BEYOND_RANGE, *SOLVER_STATUSES[1:], IN_CONTACT)
#: Statically impossible: not the solver's failures, so they do not count in its cost per sample.
INFEASIBLE: Final = (NON_COMPRESSIVE, BEYOND_RANGE, "no_equilibrium")

#: Loads met to 0.1 % (Marra 2017) and a floor, where 0.1 % of nearly nothing is below what any
#: solver resolves.
LOAD_RELATIVE_TOLERANCE: Final = 1e-3
FY_TOLERANCE: Final = 0.01
MX_TOLERANCE: Final = 0.0005


def evaluate_chunk(
    chunk: Chunk, domain: SamplingDomain, plan: SamplingPlan, solver: StaticEquilibriumSolver
) -> tuple[pa.Table, dict[str, Any]]:
    """Evaluate a chunk: every candidate gets a status, ``accepted`` or one of REJECTIONS.

    Returns:
        A table in candidate order with CANDIDATE_SCHEMA
        (poses and wrenches are NaN where the candidate is rejected)
        and ``{"counts": {status: candidates}, "evaluations": {status: contact evaluations},
        "two_sided": accepted candidates with a load on both sides}``.
    """
    prescribed = domain.draw(chunk, plan.seed)
    count = len(prescribed)
    status = np.full(count, ACCEPTED, dtype=object)
    status[(prescribed.theta_z < plan.min_theta_z) | (prescribed.theta_z > plan.max_theta_z)] = (
        BEYOND_RANGE
    )
    if not prescribed.pose_given:
        status[~(prescribed.Fy > 0)] = NON_COMPRESSIVE
    poses = np.full((count, 6), np.nan)
    wrenches = np.full((count, 2, 6), np.nan)
    max_depth = np.full(count, np.nan)
    evaluations = np.zeros(count, dtype=np.int64)
    feasible = status == ACCEPTED
    if np.any(feasible):
        asked = prescribed.select(feasible)
        solved = solver(asked)
        check_solved(solved, len(asked))
        verdict = _verdicts(asked, solved, plan.max_depth)
        if domain.contact_free:
            touching = np.any(np.asarray(solved.wrenches) != 0.0, axis=(1, 2))
            verdict[(verdict == ACCEPTED) & touching] = IN_CONTACT
        status[feasible] = verdict
        evaluations[feasible] = solved.evaluations
        # Where a solver stopped on a failed candidate is its own business: NaN keeps it out of the
        # file.
        good, rows = verdict == ACCEPTED, np.flatnonzero(feasible)
        poses[rows[good]] = np.asarray(solved.poses)[good]
        wrenches[rows[good]] = np.asarray(solved.wrenches)[good]
        if solved.max_depth is not None:
            max_depth[rows[good]] = np.asarray(solved.max_depth)[good]
    two_sided = np.all(wrenches[:, :, LOAD_COLUMNS.index("Fy")] > 0, axis=1)
    tally = {
        "counts": dict(Counter(status.tolist())),
        "evaluations": {
            name: int(evaluations[status == name].sum()) for name in sorted(set(status.tolist()))
        },
        "two_sided": int(two_sided.sum()),
    }
    flags = {"source": domain.sources(chunk), "two_sided": two_sided}
    solution = {"max_depth": max_depth, "evaluations": evaluations.astype(np.int32)}
    return _table(chunk, status, prescribed, poses, wrenches, flags | solution), tally


def _verdicts(asked: Prescribed, solved: Solved, max_depth: float) -> NDArray[Any]:
    """The solver's status, checked: what converged must carry the loads, and not too deep."""
    verdict = np.asarray(solved.status).astype(object)
    converged = verdict == CONVERGED
    total = np.asarray(solved.wrenches).sum(axis=1)
    # NaN where the pose is prescribed instead: there is nothing to meet.
    off_Fy = np.nan_to_num(np.abs(total[:, LOAD_COLUMNS.index("Fy")] - asked.Fy))
    off_Mx = np.nan_to_num(np.abs(total[:, LOAD_COLUMNS.index("Mx")] - asked.Mx))
    # The solver sums the sides in its own order: a few eps of the load on top of the tolerance.
    some = LOAD_RELATIVE_TOLERANCE * np.abs(np.nan_to_num([asked.Fy, asked.Mx]))
    met = (off_Fy <= (some[0] + FY_TOLERANCE) * (1 + 1e-9)) & (
        off_Mx <= (some[1] + MX_TOLERANCE) * (1 + 1e-9)
    )
    finite = np.all(np.isfinite(solved.poses), axis=1) & np.all(
        np.isfinite(solved.wrenches), axis=(1, 2)
    )
    verdict[converged] = ACCEPTED
    verdict[converged & ~(met & finite)] = "not_converged"
    if solved.max_depth is not None:
        verdict[(verdict == ACCEPTED) & (np.asarray(solved.max_depth) > max_depth)] = "overclosure"
    return verdict


def _table(
    chunk: Chunk,
    status: NDArray[Any],
    prescribed: Prescribed,
    poses: NDArray[np.float64],
    wrenches: NDArray[np.float64],
    others: dict[str, NDArray[Any]],
) -> pa.Table:
    flat = wrenches.reshape(len(wrenches), -1)
    columns = {
        "candidate": chunk.ids(),
        "status": status.tolist(),
        **{f"prescribed_{name}": getattr(prescribed, name) for name in GIVEN_COLUMNS},
        **{name: poses[:, i] for i, name in enumerate(POSE_COLUMNS)},
        **{name: flat[:, i] for i, name in enumerate(WRENCH_COLUMNS)},
        **others,
    }
    return pa.table(
        [pa.array(columns[field.name], type=field.type) for field in CANDIDATE_SCHEMA],
        schema=CANDIDATE_SCHEMA,
    )
