# SPDX-License-Identifier: Apache-2.0
"""The reference curve of an implant for which nobody has any: its settled poses and their bounds.

The femur stands settled, then at the lowest and highest x, z and θy that the implant bears
(:mod:`condyle.sampling.conformity`); at each of the seven it goes up and down the flexions four
times, once under each load pattern. Every time frame is a static equilibrium; time only counts them.
It is one curve, not seven, so that all variables vary along it: time-varying envelopes are as wide as
a curve's standard deviations.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS
from condyle.sampling.conformity import MOVED, ConformityBounds, press
from condyle.sampling.equilibrium_protocol import CONVERGED, StaticEquilibriumSolver
from condyle.sampling.reference_curves import ReferenceCurve, ReferenceCurves

CURVE_NAME: Final = "conformity"


def conformity_curves(bounds: ConformityBounds, solver: StaticEquilibriumSolver) -> ReferenceCurves:
    """The curve of an implant's bounds.

    Args:
        bounds: Measured with the same solver.
        solver: Finds y and θx. A time frame without equilibrium, as may happen between two steps
            of the bounds, is left out.
    """
    frames = [_frames(bounds, offsets) for offsets in _stands(bounds)]
    poses = np.concatenate([poses for poses, _ in frames])
    loads = np.concatenate([loads for _, loads in frames])
    solved = press(solver, poses, loads)
    kept = np.asarray(solved.status) == CONVERGED
    total = np.asarray(solved.wrenches).sum(axis=1)
    Fy, Mx = total[:, LOAD_COLUMNS.index("Fy")], total[:, LOAD_COLUMNS.index("Mx")]
    values = np.column_stack([solved.poses, Fy, Mx])
    time = np.arange(len(poses), dtype=np.float64)
    return ReferenceCurves((ReferenceCurve(CURVE_NAME, time[kept], values[kept]),))


def _stands(bounds: ConformityBounds) -> list[NDArray[np.float64]]:
    """Seven times offsets from the settled poses (n, 6): none, then each bound alone."""
    stands = [np.zeros_like(bounds.settled)]
    for i, name in enumerate(MOVED):
        for end in range(2):
            offsets = np.zeros_like(bounds.settled)
            offsets[:, POSE_COLUMNS.index(name)] = bounds.offsets[:, i, end]
            stands.append(offsets)
    return stands


def _frames(
    bounds: ConformityBounds, offsets: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Poses (4 n, 6) and loads (4 n, 2): flexion up under the first load pattern, down under the next."""
    poses, loads = [], []
    for pattern in range(bounds.loads.shape[1]):
        way = slice(None, None, 1 if pattern % 2 == 0 else -1)
        poses.append((bounds.settled + offsets)[way])
        loads.append(bounds.loads[way, pattern])
    return np.concatenate(poses), np.concatenate(loads)
