# SPDX-License-Identifier: Apache-2.0
"""The femoral sagittal profile (J-curve): circular arcs joined by smooth changes of radius.

The profile is written by its radius of curvature rho as a function of the surface angle a (the
outward normal is n = (-sin a, -cos a) in (x, y)): the tangent is exact by construction, and

    p(a) = p(0) - integral_0^a rho(b) exp(-i b) db        (complex plane x + i y).

On every segment rho is constant or half a cosine wave from one radius to the next; both have
closed-form integrals, so nothing is approximated. Curvature is continuous wherever a blend has some
width. In front of surface angle -90 degrees a straight vertical line follows: the anterior flange.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.implants.parameters import ImplantParameters

FloatArray = NDArray[np.float64]

#: Width of the blend between the anterior arc and the distal radius [rad].
_ANTERIOR_BLEND: Final = math.radians(10.0)
_FLANGE_ANGLE: Final = -0.5 * math.pi
#: The posterior condyle must reach this far, so that contact at 110 degrees stays off its border.
_LEAST_END_ANGLE: Final = math.radians(122.0)
_GREATEST_END_ANGLE: Final = math.radians(175.0)


@dataclass(frozen=True, eq=False)
class SagittalProfile:
    """A planar curve of k segments between surface angles, with a straight flange in front.

    Attributes:
        angles: (k + 1,) surface angles of the segments' ends, increasing [rad].
        start_radii: (k,) radius of curvature at the start of each segment [m].
        end_radii: (k,) radius of curvature at the end of each segment [m].
        lowest_point: (2,) x, y of the point with surface angle 0, in the femoral frame [m].
        flange_length: length of the straight flange before `angles[0]` [m].
    """

    angles: FloatArray
    start_radii: FloatArray
    end_radii: FloatArray
    lowest_point: FloatArray
    flange_length: float

    def radius(self, angle: FloatArray) -> FloatArray:
        """Radius of curvature [m] at surface angles [rad], any shape."""
        segment = self._segment(angle)
        mean, amplitude, rate = self._wave(segment)
        return mean + amplitude * np.cos(rate * (angle - self.angles[segment]))

    def point(self, angle: FloatArray) -> FloatArray:
        """Points (..., 2) [m] at surface angles [rad] of any shape."""
        chord = self._displacement(np.asarray(angle)) - self._displacement(np.zeros(1))[0]
        x, y = self.lowest_point
        return np.stack([x + chord.real, y + chord.imag], axis=-1)

    def arc_length(self, angle: FloatArray) -> FloatArray:
        """Arc length [m] from the start of the first arc to surface angles [rad], any shape."""
        angle = np.asarray(angle)
        segment = self._segment(angle)
        mean, amplitude, rate = self._wave(segment)
        local = angle - self.angles[segment]
        spans = np.diff(self.angles) * 0.5 * (self.start_radii + self.end_radii)
        before = np.concatenate([[0.0], np.cumsum(spans)])[segment]
        return before + mean * local + amplitude * np.sin(rate * local) / rate

    def at_arc_length(self, length: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points (..., 2) [m] and surface angles [rad] at arc lengths [m]; < 0 is the flange."""
        length = np.asarray(length)
        table = np.linspace(self.angles[0], self.angles[-1], 2001)
        angle = np.interp(length, self.arc_length(table), table)
        for _ in range(3):  # Newton from an error of 1e-6 rad: exact to rounding after two
            angle = angle - (self.arc_length(angle) - np.maximum(length, 0.0)) / self.radius(angle)
            angle = np.clip(angle, self.angles[0], self.angles[-1])
        points = self.point(angle)
        # The flange continues the first arc's tangent: straight up from surface angle -90 degrees.
        a0 = self.angles[0]
        tangent = np.array([-math.cos(a0), math.sin(a0)])
        return points + np.minimum(length, 0.0)[..., None] * tangent, angle

    def _segment(self, angle: FloatArray) -> NDArray[np.intp]:
        found = np.searchsorted(self.angles, angle, side="right") - 1
        return np.clip(found, 0, len(self.start_radii) - 1)

    def _wave(self, segment: NDArray[np.intp]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Coefficients of rho = mean + amplitude cos(rate (a - start of segment))."""
        start, end = self.start_radii[segment], self.end_radii[segment]
        rate = math.pi / np.diff(self.angles)[segment]
        return 0.5 * (start + end), 0.5 * (start - end), rate

    def _displacement(self, angle: FloatArray) -> NDArray[np.complex128]:
        """- integral of rho exp(-i b) from angles[0] to angle."""
        indices = np.arange(len(self.start_radii))
        steps = self._segment_integral(indices, self.angles[1:])
        before = np.concatenate([[0.0 + 0.0j], np.cumsum(steps)])
        segment = self._segment(angle)
        return before[segment] + self._segment_integral(segment, angle)

    def _segment_integral(
        self, segment: NDArray[np.intp], angle: FloatArray
    ) -> NDArray[np.complex128]:
        mean, amplitude, rate = self._wave(segment)
        start = self.angles[segment]

        def primitive(b: FloatArray) -> NDArray[np.complex128]:
            # rate = pi / width > 1 because every segment is narrower than pi: no division by zero.
            phase = rate * (b - start)
            rising = np.exp(1j * (phase - b)) / (1j * (rate - 1.0))
            falling = np.exp(-1j * (phase + b)) / (-1j * (rate + 1.0))
            wave = 0.5 * amplitude * (rising + falling)
            value: NDArray[np.complex128] = mean * 1j * np.exp(-1j * b) + wave
            return value

        integral: NDArray[np.complex128] = primitive(start) - primitive(angle)
        return integral


def femoral_profile(p: ImplantParameters) -> SagittalProfile:
    """Builds the J-curve of the condyles' ridge: anterior arc, distal, mid and posterior radius.

    The anterior arc's radius follows from `femoral_ap`, the posterior end from
    `posterior_condyle_height`.

    Raises:
        InputDataError: those two sizes cannot be reached with the given radii.
    """
    distal, mid, posterior = (
        p.femoral_distal_radius,
        p.femoral_mid_radius,
        p.femoral_posterior_radius,
    )
    lowest = np.array([-p.distal_point_offset, -p.distal_point_height])
    knots = [p.trochlear_angle, p.distal_end_angle, p.mid_start_angle, p.mid_end_angle]
    rear = _profile([*knots, p.posterior_start_angle, math.pi], [distal, mid, posterior], lowest)

    back, front = rear.point(np.array([0.5 * math.pi, p.trochlear_angle]))
    target = back[0] + p.femoral_ap - front[0]  # from the trochlear angle forward to the flange
    anterior = _anterior_radius(p, target)
    end = _end_angle(p, rear)
    flange_knots = [_FLANGE_ANGLE, p.trochlear_angle - _ANTERIOR_BLEND]
    whole = _profile(
        [*flange_knots, *knots, p.posterior_start_angle, end],
        [anterior, distal, mid, posterior],
        lowest,
    )
    top = whole.point(whole.angles[:1])[0, 1]
    flange_length = p.flange_height - top
    if flange_length < 2e-3:
        raise InputDataError(
            f"implant flange_height = {p.flange_height:.6g} m: must be at least "
            f"{top + 2e-3:.6g} m, 2 mm above the end of the anterior arc"
        )
    return SagittalProfile(
        whole.angles, whole.start_radii, whole.end_radii, whole.lowest_point, flange_length
    )


def _profile(knots: list[float], radii: list[float], lowest: FloatArray) -> SagittalProfile:
    """Alternating arcs and blends; knots = [arc start, arc end = blend start, blend end, ...]."""
    angles, start, end = [knots[0]], [], []
    for index in range(len(knots) - 1):
        if knots[index + 1] <= knots[index]:
            continue  # a blend of no width: tangent continuity only
        angles.append(knots[index + 1])
        start.append(radii[index // 2])
        end.append(radii[(index + 1) // 2])
    return SagittalProfile(np.array(angles), np.array(start), np.array(end), lowest, 0.0)


def _anterior_radius(p: ImplantParameters, target: float) -> float:
    """Radius R of the anterior arc that puts the flange `target` in front of the distal arc."""
    knots = [_FLANGE_ANGLE, p.trochlear_angle - _ANTERIOR_BLEND, p.trochlear_angle]

    def advance(radius: float) -> float:
        curve = _profile(knots, [radius, p.femoral_distal_radius], np.zeros(2))
        ends = curve.point(curve.angles[[0, -1]])
        return float(ends[0, 0] - ends[1, 0])

    # The distance is affine in R: two evaluations give it exactly.
    at_zero, at_one = advance(0.0), advance(1.0)
    radius = (target - at_zero) / (at_one - at_zero)
    low, high = 0.4 * p.femoral_distal_radius, 2.5 * p.femoral_distal_radius
    if not low <= radius <= high:
        raise InputDataError(
            f"implant femoral_ap = {p.femoral_ap:.6g} m: needs an anterior radius of "
            f"{radius:.6g} m, which must lie in [{low:.6g}, {high:.6g}] m"
        )
    return radius


def _end_angle(p: ImplantParameters, rear: SagittalProfile) -> float:
    centre = rear.point(np.array([0.5 * math.pi]))[0, 1]
    cosine = (
        -(p.posterior_condyle_height - p.distal_point_height - centre) / p.femoral_posterior_radius
    )
    low, high = math.cos(_LEAST_END_ANGLE), math.cos(_GREATEST_END_ANGLE)
    if not high <= cosine <= low:
        heights = [
            centre + p.distal_point_height - p.femoral_posterior_radius * c for c in (low, high)
        ]
        raise InputDataError(
            f"implant posterior_condyle_height = {p.posterior_condyle_height:.6g} m: must lie in "
            f"[{heights[0]:.6g}, {heights[1]:.6g}] m, so that the condyle wraps 122 to 175 degrees"
        )
    return math.acos(cosine)
