# SPDX-License-Identifier: Apache-2.0
"""The femoral component: coronal profiles swept along the sagittal profile.

    S(s, w) = p(s) - depth(s, w) n(s)  in x, y,    z = width(s) z(s, w)

with p, n the J-curve and its normal at arc length s, and (z, depth) a coronal profile. In front of
the notch the profile's inner part is the trochlear groove, behind it the condyle's leg; just behind
the notch's front one opens smoothly into the other, like a slit that widens to a U. Depth stays
below the smallest sagittal radius, so the sweep does not fold.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.implants.coronal import CondyleProfile, condyle_profile
from condyle.implants.mesh import SurfaceMesh, symmetric_mesh
from condyle.implants.parameters import ImplantParameters
from condyle.implants.sagittal import SagittalProfile, femoral_profile

FloatArray = NDArray[np.float64]

#: Shape of the parts that do not articulate, as fractions of femoral_ap.
_NOTCH_OPENING: Final = 0.20  # length over which the notch opens to its full width
_END_ROUNDING: Final = 0.06  # how far the posterior condyles' corners stay behind their middle
_END_LENGTH: Final = 0.22  # length over which they do so
_SHOULDER: Final = 0.14  # the same for the flange's shoulders
_SHOULDER_LENGTH: Final = 0.40
_FLANGE_DIP: Final = 0.04  # and for the middle of its top
#: Rows of the mesh are this much coarser on the trochlea, which the insert never touches.
_TROCHLEA_COARSENING: Final = 1.3


@dataclass(frozen=True, eq=False)
class FemurSurface:
    """The analytic surface of the right half (z >= 0); the component is symmetric in z.

    Attributes:
        parameters: the design.
        sagittal: J-curve of the condyles' ridge.
        coronal: coronal profile at full width.
        start: arc length of the flange's top (negative) [m].
        notch: arc length of the notch's front [m].
        end: arc length of the posterior condyle's end [m].
    """

    parameters: ImplantParameters
    sagittal: SagittalProfile
    coronal: CondyleProfile
    start: float
    notch: float
    end: float

    def point(self, length: FloatArray, inner: FloatArray, outer: FloatArray) -> FloatArray:
        """Points (..., 3) of the surface in the femoral frame [m].

        Args:
            length: arc length along the J-curve [m], from `start` to `end`.
            inner: 0 on the mid plane or notch wall, 1 from the condyle's centre line outwards.
            outer: 0 up to the condyle's centre line, 1 at the bottom of the outer wall.
        """
        length = length - self._rounding(length, inner, outer)
        opening = np.clip(
            (length - self.notch) / (_NOTCH_OPENING * self.parameters.femoral_ap), 0, 1
        )
        # The notch's front is steep (3 : 1) and meets the full width with zero slope and curvature.
        opening = (1.0 - (1.0 - opening) ** 3)[..., None]
        groove = self.coronal.groove_points(inner)
        leg = self.coronal.leg_points(inner)
        across = (1.0 - opening) * groove + opening * leg
        across = np.where((outer > 0.0)[..., None], self.coronal.outer_points(outer), across)

        ridge, angle = self.sagittal.at_arc_length(length)
        depth = across[..., 1]
        x = ridge[..., 0] + depth * np.sin(angle)
        y = ridge[..., 1] + depth * np.cos(angle)
        return np.stack([x, y, self._width(length) * across[..., 0]], axis=-1)

    def _width(self, length: FloatArray) -> FloatArray:
        """Factor on z: 1 behind the notch's front, narrowing to the flange's width at its top."""
        narrowing = _smooth_step((self.notch - length) / (self.notch - self.start))
        return 1.0 - (1.0 - self.parameters.flange_width / self.parameters.femoral_ml) * narrowing

    def _rounding(self, length: FloatArray, inner: FloatArray, outer: FloatArray) -> FloatArray:
        """Signed shift of arc length that rounds the corners of condyles and flange [m]."""
        size = self.parameters.femoral_ap
        away = 1.0 - inner + outer  # 0 on the condyle's centre line, 1 at either wall
        near_end = _smooth_step(1.0 - (self.end - length) / (_END_LENGTH * size))
        near_top = _smooth_step(1.0 - (length - self.start) / (_SHOULDER_LENGTH * size))
        top_shape = _SHOULDER * outer**2 + _FLANGE_DIP * (1.0 - inner) ** 2
        return size * (_END_ROUNDING * away**4 * near_end - top_shape * near_top)


def femur_surface(p: ImplantParameters) -> FemurSurface:
    """The analytic femoral surface of a design.

    Raises:
        InputDataError: sizes that cannot be reached with the given radii.
    """
    sagittal = femoral_profile(p)
    notch, end = sagittal.arc_length(np.array([p.notch_angle, sagittal.angles[-1]]))
    return FemurSurface(
        p, sagittal, condyle_profile(p), -sagittal.flange_length, float(notch), float(end)
    )


def femur_mesh(p: ImplantParameters) -> SurfaceMesh:
    """Meshes the component as one open surface with a notch, normals towards the insert [m]."""
    surface = femur_surface(p)
    lengths, inner, outer = femur_grid(surface)
    half = surface.point(*np.broadcast_arrays(lengths[:, None], inner, outer))
    return symmetric_mesh(half, lengths <= surface.notch)


def femur_grid(surface: FemurSurface) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Surface coordinates of the structured mesh: (rows,) length, (columns,) inner and outer."""
    edge = surface.parameters.mesh_edge_length
    front = surface.notch - surface.start
    count = _count(front, _TROCHLEA_COARSENING * edge)
    # Spacing `edge` at the notch's front, growing linearly towards the flange's top.
    first = min(1.0, count * edge / front)
    tau = np.linspace(1.0, 0.0, count + 1)
    trochlea = surface.notch - front * (first * tau + (1.0 - first) * tau**2)
    trochlea[-1] = surface.notch
    behind = np.linspace(surface.notch, surface.end, _count(surface.end - surface.notch, edge) + 1)
    inner = np.linspace(0.0, 1.0, _count(surface.coronal.leg.length, edge) + 1)
    outer = np.linspace(0.0, 1.0, _count(surface.coronal.outer.length, edge) + 1)[1:]
    return (
        np.concatenate([trochlea, behind[1:]]),
        np.concatenate([inner, np.ones_like(outer)]),
        np.concatenate([np.zeros_like(inner), outer]),
    )


def _count(length: float, edge: float) -> int:
    return max(2, round(length / edge))


def _smooth_step(t: FloatArray) -> FloatArray:
    """0 below 0, 1 above 1, twice continuously differentiable between."""
    t = np.clip(t, 0.0, 1.0)
    return t**3 * (10.0 - 15.0 * t + 6.0 * t**2)
