# SPDX-License-Identifier: Apache-2.0
"""Where a patellar button lies in the trochlea, and how it stays there when it turns about an axis.

All in the coordinates of the femoral component's mesh, F. The button's orientation is given and kept. It *touches*
where, coming from outside towards the axis, its first face reaches the component; it is *seated* where, moved along
the axis, it touches nearest to the axis: at the bottom of the groove.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle._core.common import pose_from_transform
from condyle._core.geometry import Mesh
from condyle.errors import InputDataError

Array = NDArray[np.float64]

#: Towards and away from the axis, and along it, from where the button was [m].
_REACH: Final = 12e-3
_ASIDE: Final = 8e-3
_STEP_ACROSS: Final = 1e-3
#: Coarse steps along the axis, and fine ones about the lowest: facets make touches uneven by micrometres, so that the
#: bottom of a shallow groove is known to some tenths of a millimetre and no better [m].
_STEP_ALONG: Final = 0.5e-3
_FINE_STEP: Final = 0.05e-3
#: Touch is found to this [m].
_RESOLUTION: Final = 1e-6
#: Turns at which a seated button is looked at again.
_TURNS: Final = np.radians(np.arange(0.0, 61.0, 5.0))


@dataclass(frozen=True)
class ButtonSeat:
    """A seated button.

    Attributes:
        X_FP: (4, 4) of the button's mesh, P.
        along: how far it was moved along the axis [m].
        inwards: how far it was moved towards the axis [m].
        overlap: the most by which the component is in the button's way when that flexes by up to 60° about the axis;
            NaN where it is out of reach [m].
        gap: the widest that it leaves on that way; likewise [m].
    """

    X_FP: Array
    along: float
    inwards: float
    overlap: float
    gap: float


def seat_button(
    femur: Mesh, button: Mesh, X_FP: Array, axis: Array, centre: Array, name: str = "patella"
) -> ButtonSeat:
    """Moves a button along an axis and towards it until it is seated.

    Args:
        femur: mesh of the femoral component, in F [m].
        button: mesh of the patellar button, in P [m].
        X_FP: (4, 4) where the button is; its orientation is kept.
        axis: (3,) unit vector of the hinge, in F, to the subject's right.
        centre: (3,) a point on it, in F [m].
        name: of the button's surface, for messages.

    Raises:
        InputDataError: the button finds no bottom of a groove within 12 mm towards or away from the axis and 8 mm along
            it: the two meshes are not placed as those of one knee.
    """
    touch = _Touch(femur, button, axis, centre)
    aside = np.arange(-_ASIDE, _ASIDE + 0.5 * _STEP_ALONG, _STEP_ALONG)
    outwards = touch.outwards(np.array([_moved(X_FP, s * axis) for s in aside]))
    what = f"surface {name!r}: the button at the model's default posture"
    if np.isnan(outwards).all():
        raise InputDataError(
            f"{what} does not touch the femoral component within {1e3 * _REACH:g} mm towards the hinge's axis or away"
        )
    lowest = int(np.nanargmin(outwards))
    if lowest in (0, len(aside) - 1):
        raise InputDataError(
            f"{what} lies {1e3 * _ASIDE:g} mm or more beside the bottom of the trochlea"
        )
    fine = aside[lowest] + np.arange(-_STEP_ALONG, _STEP_ALONG + 0.5 * _FINE_STEP, _FINE_STEP)
    heights = touch.outwards(np.array([_moved(X_FP, s * axis) for s in fine]))
    along = float(fine[int(np.nanargmin(heights))])
    beside = _moved(X_FP, along * axis)
    out = float(touch.outwards(beside[None])[0])
    seated = _moved(beside, out * touch.direction(beside))
    way = touch.outwards(np.array([_turned(seated, axis, centre, t) for t in _TURNS]))
    overlap, gap = (float(np.maximum(extreme, 0.0)) for extreme in (way.max(), -way.min()))
    return ButtonSeat(seated, along, -out, overlap, gap)


def _moved(X: Array, by: Array) -> Array:
    moved = X.copy()
    moved[:3, 3] += by
    return moved


def _turned(X: Array, axis: Array, centre: Array, turn: float) -> Array:
    """By a flexion about the axis, which points to the right: downwards and backwards from the front."""
    R = rotation_about(axis, -turn)
    turned = X.copy()
    turned[:3, :3] = R @ X[:3, :3]
    turned[:3, 3] = centre + R @ (X[:3, 3] - centre)
    return turned


def rotation_about(axis: Array, angle: float) -> Array:
    """(3, 3) by an angle [rad] about a unit vector (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K))


class _Touch:
    """Where a button first touches on its way to the axis."""

    def __init__(self, femur: Mesh, button: Mesh, axis: Array, centre: Array) -> None:
        # At the top this would be a circle: condyle.contact seats implants with condyle.fdk, which knows models.
        from condyle.contact import ContactPair

        self._pair = ContactPair(femur, {"button": button}, evaluation="exact")
        self._axis, self._centre = axis, centre

    def direction(self, X: Array) -> Array:
        """(3,) from the axis to the button's origin."""
        d = X[:3, 3] - self._centre
        d = d - (d @ self._axis) * self._axis
        return np.asarray(d / np.linalg.norm(d))

    def outwards(self, placements: Array) -> Array:
        """(n,) how far outwards each of (n, 4, 4) placements is to be moved to touch [m]; NaN: it never does."""
        directions = np.array([self.direction(X) for X in placements])
        found = np.full(len(placements), np.nan)
        searching = np.arange(len(placements))
        for offset in np.arange(_REACH, -_REACH - 0.5 * _STEP_ACROSS, -_STEP_ACROSS):
            if len(searching) == 0:
                break
            touches = self._touches(
                placements, directions, searching, np.full(len(searching), offset)
            )
            found[searching[touches]] = offset
            searching = searching[~touches]
        # What touches at the very start may have come from anywhere.
        found[found >= _REACH] = np.nan
        known = np.flatnonzero(np.isfinite(found))
        low, high = found[known], found[known] + _STEP_ACROSS
        while len(known) > 0 and (high - low).max() > _RESOLUTION:
            middle = 0.5 * (low + high)
            touches = self._touches(placements, directions, known, middle)
            low, high = np.where(touches, middle, low), np.where(touches, high, middle)
        found[known] = low
        return found

    def _touches(
        self, placements: Array, directions: Array, which: NDArray[np.intp], offsets: Array
    ) -> NDArray[np.bool_]:
        poses = []
        for i, offset in zip(which, offsets, strict=True):
            X_PF = np.linalg.inv(_moved(placements[i], offset * directions[i]))
            poses.append(
                pose_from_transform(
                    np.ascontiguousarray(X_PF[:3, :3]), np.ascontiguousarray(X_PF[:3, 3])
                )
            )
        return np.asarray(self._pair.evaluate(np.array(poses)).area[:, 0] > 0.0)
