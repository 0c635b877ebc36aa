# SPDX-License-Identifier: Apache-2.0
r"""Coronal profiles: what is laid across the femoral J-curve, and across the insert's dish.

A femoral profile is a planar curve (z, depth): z to the side, depth inwards along the local
normal, 0 on the condyle's ridge. Each half has an outer part, from the condyle's centre line to the
bottom of the outer wall, and an inner part, which ends either on the mid plane (trochlear groove)
or at the bottom of the notch wall (leg of the condyle). Seen from behind, depth upwards:

           notch wall |                 | outer wall
                       \               /              flat profile; the curved one has one arc
      flank and edge    `-._________.-'   edge         from edge to edge
                              flat
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.implants.parameters import ImplantParameters

FloatArray = NDArray[np.float64]

#: The notch's edge is sharper than the outer one, as on real components.
_NOTCH_EDGE_FRACTION: Final = 0.5
#: The groove of the curved profile leaves the condylar arc this many radii from its centre line.
_GROOVE_JOIN_FRACTION: Final = 0.4
#: Width of the smooth merger of the eminence's flank and ridge, in heights of the ridge.
_RIDGE_MERGER: Final = 0.7


@dataclass(frozen=True, eq=False)
class ArcChain:
    """A tangent-continuous chain of k lines and arcs in (t, depth), starting at (0, 0) along +t.

    Attributes:
        lengths: (k,) length of each piece [m].
        curvatures: (k,) turn towards +depth per length, 0 for a line [1/m].
    """

    lengths: FloatArray
    curvatures: FloatArray

    @property
    def length(self) -> float:
        """Length of the whole chain [m]."""
        return float(self.lengths.sum())

    def at(self, fraction: FloatArray) -> FloatArray:
        """Points (..., 2) at fractions in [0, 1] of the chain's length [m]."""
        ends = np.concatenate([[0.0], np.cumsum(self.lengths)])
        headings = np.concatenate([[0.0], np.cumsum(self.lengths * self.curvatures)])
        starts = np.concatenate(
            [[0.0 + 0.0j], np.cumsum(self._pieces(headings[:-1], self.lengths))]
        )
        along = np.asarray(fraction) * ends[-1]
        piece = np.clip(np.searchsorted(ends, along, side="right") - 1, 0, len(self.lengths) - 1)
        local = along - ends[piece]
        point = starts[piece] + self._pieces(headings[piece], local, self.curvatures[piece])
        return np.stack([point.real, point.imag], axis=-1)

    def _pieces(
        self, heading: FloatArray, length: FloatArray, curvature: FloatArray | None = None
    ) -> NDArray[np.complex128]:
        """Chord t + i depth of a piece: length sinc(turn / 2) exp(i (heading + turn / 2))."""
        turn = length * (self.curvatures if curvature is None else curvature)
        chord = length * np.sinc(turn / (2.0 * np.pi))  # numpy's sinc holds the pi
        displacement: NDArray[np.complex128] = chord * np.exp(1j * (heading + 0.5 * turn))
        return displacement


@dataclass(frozen=True, eq=False)
class CondyleProfile:
    """The femoral coronal profile of one half (z >= 0) at full width.

    Attributes:
        centre: z of the condyle's centre line [m].
        outer: centre line to the bottom of the outer wall; t is z - centre.
        leg: centre line to the bottom of the notch wall; t is centre - z.
        groove_join: z where the groove begins [m].
        groove: (6,) coefficients of the groove's depth, ascending powers of z / groove_join [m].
    """

    centre: float
    outer: ArcChain
    leg: ArcChain
    groove_join: float
    groove: FloatArray

    def outer_points(self, fraction: FloatArray) -> FloatArray:
        """(..., 2) z and depth [m] outwards; fraction 0 at the centre line, 1 at the wall."""
        point = self.outer.at(fraction)
        point[..., 0] = self.centre + point[..., 0]
        return point

    def leg_points(self, fraction: FloatArray) -> FloatArray:
        """(..., 2) z and depth [m] of the leg; fraction 0 at the notch, 1 at the centre line."""
        point = self.leg.at(1.0 - fraction)
        point[..., 0] = self.centre - point[..., 0]
        return point

    def groove_points(self, fraction: FloatArray) -> FloatArray:
        """(..., 2) z and depth [m] of the groove; fraction 0 at z = 0, 1 at the centre line."""
        z = fraction * self.centre
        # Beyond the join the groove follows the leg's own flank: flat, or the condylar arc.
        ridge = _arc_depth(self.centre - z, self.leg)
        depth = np.polynomial.polynomial.polyval(np.minimum(z / self.groove_join, 1.0), self.groove)
        return np.stack([z, np.where(z < self.groove_join, depth, ridge)], axis=-1)


def condyle_profile(p: ImplantParameters) -> CondyleProfile:
    """Builds the femoral coronal profile.

    Raises:
        InputDataError: widths and radii leave no room for the edges or walls.
    """
    centre, flat = p.condyle_centre, p.flat_half_width
    outer_radius = p.femoral_coronal_radius if p.coronal_profile == "curved" else None
    inner_radius = p.femoral_coronal_radius if outer_radius else p.femoral_flank_radius
    outer = _edge_chain(
        "femoral_ml",
        flat,
        outer_radius,
        p.femoral_edge_radius,
        0.5 * p.femoral_ml - centre,
        p.side_depth,
    )
    leg = _edge_chain(
        "notch_width",
        flat,
        inner_radius,
        _NOTCH_EDGE_FRACTION * p.femoral_edge_radius,
        centre - 0.5 * p.notch_width,
        p.side_depth,
    )
    join = centre - flat - (_GROOVE_JOIN_FRACTION * inner_radius if outer_radius else 0.0)
    return CondyleProfile(centre, outer, leg, join, _groove(p, join, outer_radius))


def eminence_profile(p: ImplantParameters, z: FloatArray, ridge: FloatArray) -> FloatArray:
    """Height [m] of the insert above its dish across z.

    Flat part, then a circular flank (radius `eminence_flank_radius`, or the compartment's own
    radius when curved) up to the ridge. Flank f and ridge r merge by the smooth minimum
    min(f, r) - k max(0, 1 - |f - r| / k)³ / 6: twice continuously differentiable, and exact
    outside |f - r| < k.

    Args:
        p: the design.
        z: positions to the side [m], any shape.
        ridge: height of the ridge above the dish there [m], same shape as z.

    Raises:
        InputDataError: the flanks would meet on the mid plane before they merge into the ridge.
    """
    top = float(_flank_height(p, np.zeros(1))[0])
    limit = top / (1.0 + _RIDGE_MERGER)
    if p.eminence_height > limit:
        raise InputDataError(
            f"implant eminence_height = {p.eminence_height:.6g} m: must not exceed {limit:.6g} m, "
            f"as its flanks meet {top:.6g} m above the dish"
        )
    flank = _flank_height(p, z)
    width = _RIDGE_MERGER * ridge
    overlap = np.maximum(0.0, 1.0 - np.abs(flank - ridge) / width)
    merged = np.minimum(flank, ridge) - width * overlap**3 / 6.0
    # The merger belongs to the eminence; outside the centre line a round compartment just rises.
    return np.where(np.abs(z) < p.condyle_centre, merged, flank)


def _flank_height(p: ImplantParameters, z: FloatArray) -> FloatArray:
    """Height [m] of flat and circular flank above the dish, without the ridge."""
    # A flat compartment stays flat outwards; a round one rises on both sides.
    offset = p.condyle_centre - p.flat_half_width - np.abs(z)
    offset = np.abs(offset) if p.coronal_profile == "curved" else np.maximum(offset, 0.0)
    radius = p.insert_coronal_radius
    steep = 0.9 * radius  # beyond it the flank goes on straight, which keeps the root real
    inside = np.minimum(offset, steep)
    slope = steep / math.sqrt(radius**2 - steep**2)
    return radius - np.sqrt(radius**2 - inside**2) + slope * (offset - inside)


def _edge_chain(
    field: str, flat: float, radius: float | None, edge: float, half_width: float, depth: float
) -> ArcChain:
    """Flat, arc, edge (turning to straight inwards) and wall; ends at (half_width, depth).

    Without `radius`, the flat runs up to the edge.
    """
    if radius is None:
        return ArcChain(
            np.array([half_width - edge, 0.5 * math.pi * edge, depth - edge]),
            np.array([0.0, 1.0 / edge, 0.0]),
        )
    sine = (half_width - flat - edge) / (radius - edge)
    if not 0.0 <= sine < 0.95:
        raise InputDataError(
            f"implant {field}: the coronal arc would turn through an angle with sine "
            f"{sine:.4g}, which must lie in [0, 0.95] (radius {radius:.6g} m, "
            f"half width {half_width:.6g} m)"
        )
    turn = math.asin(sine)
    wall = depth - radius * (1.0 - math.cos(turn)) - edge * math.cos(turn)
    if wall <= 0.0:
        raise InputDataError(
            f"implant side_depth = {depth:.6g} m: must be greater than "
            f"{depth - wall:.6g} m, the depth of the condyle's edge ({field})"
        )
    return ArcChain(
        np.array([max(flat, 1e-12), radius * turn, edge * (0.5 * math.pi - turn), wall]),
        np.array([0.0, 1.0 / radius, 1.0 / edge, 0.0]),
    )


def _arc_depth(distance: FloatArray, leg: ArcChain) -> FloatArray:
    """Depth of flat and first arc as a function of the distance from the centre line [m]."""
    beyond = np.maximum(distance - leg.lengths[0], 0.0)
    radius = float(1.0 / leg.curvatures[1])
    depth: FloatArray = radius - np.sqrt(radius**2 - np.minimum(beyond, 0.999 * radius) ** 2)
    return depth


def _groove(p: ImplantParameters, join: float, radius: float | None) -> FloatArray:
    """Quintic in u = z / join: level and uncurved at u = 0, C2 with the ridge at u = 1."""
    value, slope, curvature = 0.0, 0.0, 0.0
    if radius is not None:
        across = p.condyle_centre - join
        root = math.sqrt(radius**2 - across**2)
        value, slope, curvature = radius - root, -across / root, radius**2 / root**3
    if p.groove_depth <= value + 0.25 * abs(slope) * join:
        raise InputDataError(
            f"implant groove_depth = {p.groove_depth:.6g} m: must be greater than "
            f"{value + 0.25 * abs(slope) * join:.6g} m, the condyle's own depth beside the groove"
        )
    rise, d1, d2 = value - p.groove_depth, slope * join, curvature * join**2
    # Hermite conditions at u = 1 on a3 u³ + a4 u⁴ + a5 u⁵.
    a3 = 10.0 * rise - 4.0 * d1 + 0.5 * d2
    a4 = -15.0 * rise + 7.0 * d1 - d2
    a5 = 6.0 * rise - 3.0 * d1 + 0.5 * d2
    return np.array([p.groove_depth, 0.0, 0.0, a3, a4, a5])
