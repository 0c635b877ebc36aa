# SPDX-License-Identifier: Apache-2.0
"""One chunk of candidates: from their place in a domain to a table of poses, wrenches and statuses.

A chunk is a function of the plan, the curves and the solver alone, so any process or machine may
evaluate any chunk.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, WRENCH_COLUMNS
from condyle.sampling.domain import SamplingDomain
from condyle.sampling.equilibrium_protocol import (
    CONVERGED,
    PRESCRIBED_COLUMNS,
    SOLVER_STATUSES,
    Prescribed,
    Solved,
    StaticEquilibriumSolver,
    check_solved,
)
from condyle.sampling.hammersley import hammersley, seeded_shift
from condyle.sampling.part_files import CANDIDATE_SCHEMA
from condyle.sampling.plan import SamplingPlan
from condyle.sampling.selection import candidate_ids

ACCEPTED: Final = "accepted"
#: Reasons known before a solver is asked: contact cannot pull, and no component articulates that
#: far.
NON_COMPRESSIVE: Final = "non_compressive"
BEYOND_RANGE: Final = "beyond_range"
REJECTIONS: Final = (NON_COMPRESSIVE, BEYOND_RANGE, *SOLVER_STATUSES[1:])
#: Statically impossible: not the solver's failures, so they do not count in its cost per sample.
INFEASIBLE: Final = (NON_COMPRESSIVE, BEYOND_RANGE, "no_equilibrium")

#: Loads met to 0.1 % (Marra 2017) and a floor, where 0.1 % of nearly nothing is below what any
#: solver resolves.
LOAD_RELATIVE_TOLERANCE: Final = 1e-3
FY_TOLERANCE: Final = 0.01
MX_TOLERANCE: Final = 0.0005

_PILOT_ROUND: Final = 0


@dataclass(frozen=True)
class Chunk:
    """Candidates ``start`` to ``stop`` of a round, which is a Hammersley set of ``round_size``."""

    domain: int
    round_number: int
    round_size: int
    start: int
    stop: int

    def record(self) -> dict[str, int]:
        """What identifies the chunk, for its part file."""
        return {
            "domain": self.domain,
            "round": self.round_number,
            "round_size": self.round_size,
            "start": self.start,
            "stop": self.stop,
        }


def evaluate_chunk(
    chunk: Chunk, domain: SamplingDomain, plan: SamplingPlan, solver: StaticEquilibriumSolver
) -> tuple[pa.Table, dict[str, Any]]:
    """Evaluate a chunk: every candidate gets a status, ``accepted`` or one of REJECTIONS.

    Returns:
        A table in candidate order with CANDIDATE_SCHEMA
        (poses and wrenches are NaN where the candidate is rejected)
        and ``{"counts": {status: candidates}, "evaluations": {status: contact evaluations}}``.
    """
    prescribed = domain.prescribe(_unit_points(chunk, plan))
    count = len(prescribed)
    status = np.full(count, ACCEPTED, dtype=object)
    status[(prescribed.theta_z < plan.min_theta_z) | (prescribed.theta_z > plan.max_theta_z)] = (
        BEYOND_RANGE
    )
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
        status[feasible] = verdict
        evaluations[feasible] = solved.evaluations
        # Where a solver stopped on a failed candidate is its own business: NaN keeps it out of the
        # file.
        good, rows = verdict == ACCEPTED, np.flatnonzero(feasible)
        poses[rows[good]] = np.asarray(solved.poses)[good]
        wrenches[rows[good]] = np.asarray(solved.wrenches)[good]
        if solved.max_depth is not None:
            max_depth[rows[good]] = np.asarray(solved.max_depth)[good]
    tally = {
        "counts": dict(Counter(status.tolist())),
        "evaluations": {
            name: int(evaluations[status == name].sum()) for name in sorted(set(status.tolist()))
        },
    }
    return _table(chunk, status, prescribed, poses, wrenches, max_depth, evaluations), tally


def _unit_points(chunk: Chunk, plan: SamplingPlan) -> NDArray[np.float64]:
    """Pilot and first round are Hammersley sets as they are; later rounds have their own shift."""
    shift = None
    if chunk.round_number > _PILOT_ROUND + 1:
        shift = seeded_shift(plan.seed, f"domain {chunk.domain} round {chunk.round_number}")
    return hammersley(chunk.round_size, start=chunk.start, stop=chunk.stop, shift=shift)


def _verdicts(asked: Prescribed, solved: Solved, max_depth: float) -> NDArray[Any]:
    """The solver's status, checked: what converged must carry the loads, and not too deep."""
    verdict = np.asarray(solved.status).astype(object)
    converged = verdict == CONVERGED
    total = np.asarray(solved.wrenches).sum(axis=1)
    off_Fy = np.abs(total[:, LOAD_COLUMNS.index("Fy")] - asked.Fy)
    off_Mx = np.abs(total[:, LOAD_COLUMNS.index("Mx")] - asked.Mx)
    # The solver sums the sides in its own order: a few eps of the load on top of the tolerance.
    met = (off_Fy <= (LOAD_RELATIVE_TOLERANCE * np.abs(asked.Fy) + FY_TOLERANCE) * (1 + 1e-9)) & (
        off_Mx <= (LOAD_RELATIVE_TOLERANCE * np.abs(asked.Mx) + MX_TOLERANCE) * (1 + 1e-9)
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
    max_depth: NDArray[np.float64],
    evaluations: NDArray[np.int64],
) -> pa.Table:
    flat = wrenches.reshape(len(wrenches), -1)
    columns = {
        "candidate": candidate_ids(chunk.domain, chunk.round_number, chunk.start, chunk.stop),
        "status": status.tolist(),
        **{f"prescribed_{name}": getattr(prescribed, name) for name in PRESCRIBED_COLUMNS},
        **{name: poses[:, i] for i, name in enumerate(POSE_COLUMNS)},
        **{name: flat[:, i] for i, name in enumerate(WRENCH_COLUMNS)},
        "max_depth": max_depth,
        "evaluations": evaluations.astype(np.int32),
    }
    return pa.table(
        [pa.array(columns[field.name], type=field.type) for field in CANDIDATE_SCHEMA],
        schema=CANDIDATE_SCHEMA,
    )
