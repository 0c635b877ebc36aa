# SPDX-License-Identifier: Apache-2.0
"""Where a generated femur comes to rest on its insert: the first check of every design.

The femur, at a given flexion and no other rotation, sinks along y with x free until nothing lets it
sink further. This is geometry only (no load, no ligament): a start for solvers, and a test that
the surfaces articulate.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import medial_direction
from condyle.errors import InputDataError
from condyle.implants.implant import Implant
from condyle.implants.insert import insert_height

FloatArray = NDArray[np.float64]

#: The femur's rest is searched for this far to either side of the dish's middle, in dish radii.
_SEARCH: Final = 0.35
_TOLERANCE: Final = (
    1e-7  # [m] in x; the height is then exact to x² / radius, far below STL's rounding
)
_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, eq=False)
class SettledPose:
    """A femur at rest on its insert.

    Attributes:
        pose: (6,) x, y, z [m], theta_x, theta_y, theta_z [rad] of the femur in the insert frame.
        touch_points: (2, 3) lowest-gap point per side (medial, lateral) in the insert frame [m].
        gaps: (2,) vertical gap left per side [m], the smaller one 0.
        femur_vertices: (2,) indices of the femur's vertices that touch.
    """

    pose: FloatArray
    touch_points: FloatArray
    gaps: FloatArray
    femur_vertices: NDArray[np.intp]


def settle(implant: Implant, flexion: float) -> SettledPose:
    """Lets the femur sink at a flexion angle [rad], theta_z = -flexion, theta_x = theta_y = 0.

    The component is symmetric, so it rests at z = 0; x is found by a bounded scalar search.

    Raises:
        InputDataError: flexion outside [-0.35, 2.3] rad.
    """
    if not -0.35 <= flexion <= 2.3:
        raise InputDataError(f"flexion = {flexion!r} rad: must lie in [-0.35, 2.3] rad")
    p = implant.parameters
    cosine, sine = math.cos(flexion), math.sin(flexion)
    # R_TF = Rz(-theta_z) = Rz(flexion): x to (cos, sin).
    rotation = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    vertices = implant.femur.vertices @ rotation.T
    # Only what is within reach of the insert can touch it; the flange high above cannot.
    low = vertices[:, 1] < vertices[:, 1].min() + 0.5 * p.femoral_ap
    candidates = vertices[low]
    middle = -p.insert_sagittal_radius * math.sin(p.posterior_slope)

    def gap(x: float) -> FloatArray:
        """Height of each candidate above the insert with Fo at (x, 0, 0); inf outside it."""
        place = candidates[:, 0] + x
        inside = np.abs(place - p.insert_ap_offset) <= 0.5 * p.insert_ap
        inside &= np.abs(candidates[:, 2]) <= 0.5 * p.insert_ml
        clear = candidates[:, 1] - insert_height(p, place, candidates[:, 2])
        return np.where(inside, clear, np.inf)

    lowest = candidates[np.argmin(candidates[:, 1]), 0]
    reach = _SEARCH * p.insert_sagittal_radius
    x = _lowest(lambda x: -float(gap(x).min()), middle - lowest, reach)
    clear = gap(x)
    y = -float(clear.min())
    sides = [medial_direction(p.side_of_body) * sign * candidates[:, 2] > 0.0 for sign in (1, -1)]
    touching = [int(np.argmin(np.where(side, clear, np.inf))) for side in sides]
    points = candidates[touching] + [x, y, 0.0]
    pose = np.array([x, y, 0.0, 0.0, 0.0, -flexion])
    return SettledPose(pose, points, clear[touching] + y, np.flatnonzero(low)[touching])


def _lowest(height: Callable[[float], float], middle: float, reach: float) -> float:
    """Golden-section search for the minimum of a height with one valley, within middle +- reach."""
    low, high = middle - reach, middle + reach
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = height(left), height(right)
    while high - low > _TOLERANCE:
        if at_left < at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = height(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = height(right)
    return 0.5 * (low + high)
