# SPDX-License-Identifier: Apache-2.0
"""Lift-off angles: how far a femur must be tilted, under a given load, for each side to come off.

At a pose (x, z, θy, θz) and a total Fy, y follows from θx. Tilted far to one side, one side alone
carries Fy; far to the other, the other one. In between lies an interval of θx where both do: its
two ends are found by bisection on "is the side that should come off still loaded?".
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import LOAD_COLUMNS
from condyle.sampling.equilibrium_protocol import CONVERGED, Prescribed, StaticEquilibriumSolver

#: Tilt at which one side alone is expected to carry [rad]: 5.7°, twice a usual lift-off under 100 N.
_REACH = 0.1
#: Halvings of the interval: 0.2 rad / 2¹² is 0.003°.
_HALVINGS = 12


def lift_off_angles(solver: StaticEquilibriumSolver, prescribed: Prescribed) -> NDArray[np.float64]:
    """The tilts (n, 2) [rad] between which both sides carry.

    Args:
        solver: The static equilibrium solver.
        prescribed: x, Fy, z, θy, θz of n poses; its Mx is not used.

    Returns:
        Lower and upper end; NaN where an equilibrium on the way was not found, or one side does not
        come off within ±5.7°.
    """
    count = len(prescribed)
    ends = [_loaded(solver, prescribed, np.full(count, tilt)) for tilt in (-_REACH, _REACH)]
    # The side that carries alone at each end, and that not the same one.
    alone = [(end.sum(axis=1) == 1) & good for end, good in ends]
    carrier = [np.argmax(end, axis=1) for end, _ in ends]
    usable = alone[0] & alone[1] & (carrier[0] != carrier[1])
    angles = np.full((count, 2), np.nan)
    # At the lower end of the interval the upper tilt's side comes off, and the other way round.
    for column, side in ((0, carrier[1]), (1, carrier[0])):
        off, on = np.full(count, -_REACH), np.full(count, _REACH)
        if column == 1:
            off, on = on, off
        found = usable.copy()
        for _ in range(_HALVINGS):
            middle = (off + on) / 2
            loaded, good = _loaded(solver, prescribed, middle)
            found &= good
            carries = loaded[np.arange(count), side]
            on, off = np.where(carries, middle, on), np.where(carries, off, middle)
        angles[found, column] = off[found]
    angles[np.any(np.isnan(angles), axis=1)] = np.nan
    return angles


def _loaded(
    solver: StaticEquilibriumSolver, prescribed: Prescribed, theta_x: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether each side carries at a tilt (n, 2), and whether the equilibrium was found (n,)."""
    nothing = np.full(len(prescribed), np.nan)
    solved = solver(dataclasses.replace(prescribed, Mx=nothing, theta_x=theta_x))
    loaded: NDArray[np.bool_] = np.asarray(solved.wrenches)[:, :, LOAD_COLUMNS.index("Fy")] > 0
    return loaded, np.asarray(solved.status) == CONVERGED
