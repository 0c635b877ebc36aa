# SPDX-License-Identifier: Apache-2.0
"""The insert: a height field y(x, z) of two dished compartments and the eminence between them.

    y = dish_height + dish(x) + eminence(z; ridge(x)) + x tan(posterior_slope)

The dish is a circular arc that flattens, curvature continuously, to the front and back lips.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.implants.coronal import eminence_profile
from condyle.implants.mesh import SurfaceMesh, symmetric_mesh
from condyle.implants.parameters import ImplantParameters

FloatArray = NDArray[np.float64]

_LIP_WIDTH: Final = 0.10  # length over which the dish flattens to a lip, as a fraction of insert_ap
_RIDGE_FALL_LENGTH: Final = (
    0.40  # the ridge falls from x = 0 forward over this fraction of insert_ap
)
_RIDGE_FALL: Final = 0.72  # by this fraction of its height
_OUTLINE_ROUNDING: Final = 0.7  # 0: rectangular outline, 1: elliptic
_CUTOUT_DEPTH: Final = 0.22  # cutout for the posterior cruciate ligament, fractions of insert_ap
_CUTOUT_HALF_WIDTH: Final = 0.17  # and of insert_ml


def insert_height(p: ImplantParameters, x: FloatArray, z: FloatArray) -> FloatArray:
    """Height y [m] of the contact surface at x, z [m] in the insert frame (broadcast together).

    Beyond the outline the formula goes on smoothly (lips stay level); callers bound x and z.

    Raises:
        InputDataError: a lip height that the dish cannot flatten to.
    """
    x, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float))
    forward = np.clip(x / (_RIDGE_FALL_LENGTH * p.insert_ap), 0.0, 1.0)
    fall = _RIDGE_FALL * forward**3 * (10.0 - 15.0 * forward + 6.0 * forward**2)
    ridge = p.eminence_height * (1.0 - fall)
    height = dish_profile(p, x) + eminence_profile(p, z, ridge)
    return p.dish_height + height + x * math.tan(p.posterior_slope)


def dish_profile(p: ImplantParameters, x: FloatArray) -> FloatArray:
    """Height [m] of the dish above its floor at x [m].

    Raises:
        InputDataError: a lip height that the dish cannot flatten to.
    """
    front = p.insert_ap_offset + 0.5 * p.insert_ap
    back = 0.5 * p.insert_ap - p.insert_ap_offset
    forward = _half_dish(p, np.maximum(x, 0.0), front, "anterior_lip_height")
    backward = _half_dish(p, np.maximum(-x, 0.0), back, "posterior_lip_height")
    return forward + backward


def _half_dish(p: ImplantParameters, distance: FloatArray, end: float, field: str) -> FloatArray:
    """Circle out to `end` - lip width, then a quintic that is level at `end`; constant beyond."""
    radius, lip, width = p.insert_sagittal_radius, getattr(p, field), _LIP_WIDTH * p.insert_ap
    start = end - width
    root = math.sqrt(radius**2 - start**2)
    height, slope, curvature = radius - root, start / root, radius**2 / root**3
    low, high = height + 0.2 * slope * width, height + 0.9 * slope * width
    if not low <= lip <= high:
        raise InputDataError(
            f"implant {field} = {lip:.6g} m: must lie in [{low:.6g}, {high:.6g}] m, which the "
            f"dish of radius {radius:.6g} m reaches at its border"
        )
    circle = radius - np.sqrt(radius**2 - np.minimum(distance, start) ** 2)
    # With v = 1 at the circle's end and 0 at the border: level border, C2 at the circle.
    v = 1.0 - np.clip((distance - start) / width, 0.0, 1.0)
    rise, d1, d2 = height - lip, -slope * width, curvature * width**2
    quintic = (
        (10.0 * rise - 4.0 * d1 + 0.5 * d2) * v**3
        + (-15.0 * rise + 7.0 * d1 - d2) * v**4
        + (6.0 * rise - 3.0 * d1 + 0.5 * d2) * v**5
    )
    return np.where(distance <= start, circle, lip + quintic)


def insert_mesh(p: ImplantParameters) -> SurfaceMesh:
    """Meshes the contact surface as one open surface over both compartments, normals up [m]."""
    edge = p.mesh_edge_length
    rows, columns = max(4, round(p.insert_ap / edge)), max(4, round(0.5 * p.insert_ml / edge))
    x, z = insert_outline(
        p, np.linspace(-1.0, 1.0, rows + 1)[:, None], np.linspace(0.0, 1.0, columns + 1)
    )
    half = np.stack([x, insert_height(p, x, z), z], axis=-1)
    return symmetric_mesh(half, np.ones(rows + 1, dtype=bool))


def insert_outline(
    p: ImplantParameters, u: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Maps the square -1 <= u (forward), v (right) <= 1 to x, z [m] in the rounded outline."""
    barrel_x = np.sqrt(1.0 - 0.5 * _OUTLINE_ROUNDING * v**2)
    barrel_z = np.sqrt(1.0 - 0.5 * _OUTLINE_ROUNDING * u**2)
    z = 0.5 * p.insert_ml * v * barrel_z
    inside = np.clip(1.0 - (z / (_CUTOUT_HALF_WIDTH * p.insert_ml)) ** 2, 0.0, 1.0)
    cutout = _CUTOUT_DEPTH * p.insert_ap * inside**3 * 0.5 * (1.0 - u)
    # The back border reaches furthest beside the cutout, not in the middle: stretch so that the
    # whole is insert_ap long there (within 0.3 %, as the cutout's edge is rounded).
    beside = 2.0 * _CUTOUT_HALF_WIDTH / math.sqrt(1.0 - 0.5 * _OUTLINE_ROUNDING)
    stretch = 1.0 / math.sqrt(1.0 - 0.5 * _OUTLINE_ROUNDING * beside**2) - 1.0
    reach = 0.5 * p.insert_ap * (1.0 + stretch * 0.5 * (1.0 - u))
    x = p.insert_ap_offset + reach * u * barrel_x + cutout
    return x, z
