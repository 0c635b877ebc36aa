# SPDX-License-Identifier: Apache-2.0
"""Where contact begins, and the seated pose: the femur as low as possible, rotations zero."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import fdk as _fdk
from condyle._core.contact import ContactModel
from condyle.errors import InputDataError
from condyle.fdk.static_equilibrium import StaticEquilibria, solve_static_equilibria

#: First touch under load is looked for this far about the seat [m]: tilted, a femur touches higher or lower.
_ABOVE, _BELOW = 0.025, 0.02


@dataclass(frozen=True)
class Seat:
    """A pose at which contact begins.

    Attributes:
        pose: (6,) [m, rad]; contact where ``converged``, else the pose last tried.
        status: converged, no_contact, no_clearance, untrusted or slides_off.
        advice: What happened, and what to do next.
        evaluations: Contact evaluations used.
    """

    pose: NDArray[np.float64]
    status: str
    advice: str
    evaluations: int

    @property
    def converged(self) -> bool:
        """True if the pose is what was asked for."""
        return self.status == "converged"


def first_touch(
    model: ContactModel, pose: ArrayLike, settings: _fdk.SeatingSettings | None = None
) -> Seat:
    """The highest y at which contact carries load, the other coordinates held.

    Args:
        model: Any contact model; of a surrogate, the edge of what it knows may be found (``untrusted``).
        pose: (6,) [m, rad]. Its y does not matter: the search comes from above.
        settings: The defaults resolve y to 1e-9 m.

    Raises:
        InputDataError: The pose is not six values, or not finite but for y, or a setting is out of range.
    """
    held = np.ascontiguousarray(pose, dtype=np.float64)
    if held.shape != (6,):
        raise InputDataError(f"first touch: pose has shape {held.shape}: (6,) is needed")
    try:
        found = _fdk.first_touch(model, held, settings or _fdk.SeatingSettings())
    except ValueError as error:
        raise InputDataError(str(error)) from error
    return Seat(found.pose, found.status, found.advice, int(found.evaluations))


def seated_pose(
    model: ContactModel, flexion: float = 0.0, settings: _fdk.SeatingSettings | None = None
) -> Seat:
    """The femur as low as possible at a flexion [rad], rotations zero: the lowest first touch over x and z.

    It needs no start. Where the insert is level (flat condyles on a flat insert, z), the answer stays near the middle,
    within what the mesh's facets make of it.

    Raises:
        InputDataError: ``flexion`` is not finite, or a setting is out of range.
    """
    try:
        found = _fdk.seated_pose(model, flexion, settings or _fdk.SeatingSettings())
    except ValueError as error:
        raise InputDataError(str(error)) from error
    return Seat(found.pose, found.status, found.advice, int(found.evaluations))


def load_seated(
    model: ContactModel,
    seat: Seat,
    Fy: float,
    *,
    Mx: float | None = None,
    theta_x: ArrayLike | None = None,
) -> StaticEquilibria:
    """Presses the femur down at the seat's x, z and flexion, as :func:`solve_static_equilibria`.

    Args:
        model: The one that was seated.
        seat: Where.
        Fy: Total contact force [N].
        Mx: Total contact moment about x_T at Fo [Nm], θx free. Give this or ``theta_x``.
        theta_x: (n,) or a number, held [rad].

    Raises:
        InputDataError: As :func:`solve_static_equilibria`.
    """
    settings = _fdk.StaticEquilibriumSettings()
    touch = settings.touch
    touch.y_high, touch.y_low = seat.pose[1] + _ABOVE, seat.pose[1] - _BELOW
    settings.touch = touch
    x, _, z, _, theta_y, theta_z = seat.pose
    return solve_static_equilibria(
        model, x, z, theta_y, theta_z, Fy, Mx, theta_x=theta_x, settings=settings, threads=1
    )
