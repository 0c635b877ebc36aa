# SPDX-License-Identifier: Apache-2.0
"""The circular cylinder nearest to a patch of a surface, in the least squares of distances.

    min over axis, radius  Σ w_i (|(I − a aᵀ)(p_i − c)| − r)²

a: unit axis, c: a point on it, r: radius; five parameters. Gauss–Newton from a start that needs no guess: the axis is
what the normals are least along (the smallest eigenvector of Σ w n nᵀ), the circle across it the algebraic one (Kåsa
1976). A step that does not lower the sum is halved. On points of an exact cylinder it ends at rounding, on any arc; on
noisy ones an arc below some 40° leaves radius and depth of the axis nearly free, which ``arc`` tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError

Array = NDArray[np.float64]

_PARAMETERS: Final = 5
_MAX_ITERATIONS: Final = 100
_MAX_HALVINGS: Final = 30
#: Converged where no parameter moves by more than this, of the points' spread [-, rad].
_SMALL_STEP: Final = 1e-11
#: Points nearer to each other than this, of their coordinates, are one but for rounding.
_ONE_POINT: Final = 1e-13


@dataclass(frozen=True)
class CylinderFit:
    """A cylinder, and how well points lie on it.

    Attributes:
        axis: (3,) unit vector; either sense.
        centre: (3,) the point of the axis nearest to the points' weighted mean [m].
        radius: [m].
        rms: weighted root mean square of the points' distances from it [m].
        largest: distance [m].
        arc: how far the points reach about the axis: the full turn less the widest gap [rad].
        points: how many.
        iterations: Gauss–Newton steps.
        converged: the steps came to rest.
    """

    axis: Array
    centre: Array
    radius: float
    rms: float
    largest: float
    arc: float
    points: int
    iterations: int
    converged: bool


@dataclass(frozen=True)
class _Cylinder:
    axis: Array
    centre: Array
    radius: float

    def rays(self, points: Array) -> tuple[Array, Array, Array]:
        """(n, 3) from the axis to the points, (n,) their lengths, (n,) places along the axis."""
        d = points - self.centre
        along = d @ self.axis
        across = d - along[:, None] * self.axis
        return across, np.linalg.norm(across, axis=1), along

    def distances(self, points: Array) -> Array:
        """(n,) outside it positive."""
        return np.asarray(self.rays(points)[1] - self.radius)

    def moved(self, step: Array) -> _Cylinder:
        """By (ξ, η, α, β, ρ): of the centre and of the axis along :func:`_across`, of the radius."""
        u, v = _across(self.axis)
        axis = self.axis + step[2] * u + step[3] * v
        axis /= np.linalg.norm(axis)
        centre = self.centre + step[0] * u + step[1] * v
        return _Cylinder(axis, centre, self.radius + float(step[4]))


def fit_cylinder(points: Array, normals: Array, weights: Array | None = None) -> CylinderFit:
    """The cylinder of least squares.

    Args:
        points: (n, 3) of the surface, n ≥ 6 [m].
        normals: (n, 3) of the surface there, either sense: for the start only.
        weights: (n,) above 0, the faces' areas for instance; all alike if not given.

    Raises:
        InputDataError: arrays that do not fit, or hold what is not finite. Points that lie on no cylinder are told by
            ``rms``, ``arc`` and ``converged``.
    """
    p, n, w = _checked(points, normals, weights)
    mean = w @ p
    spread = float(np.sqrt(w @ np.sum((p - mean) ** 2, axis=1)))
    if spread <= _ONE_POINT * np.abs(p).max():
        raise InputDataError(f"cylinder: all {len(p)} points are one")
    # In units of their spread about their mean, so that one step size serves metres and radians.
    q = (p - mean) / spread
    cylinder, iterations, converged = _descend(_start(q, n, w), q, w)
    u, v = _across(cylinder.axis)
    across, _, _ = cylinder.rays(q)
    distances = spread * cylinder.distances(q)
    return CylinderFit(
        axis=cylinder.axis,
        # The mean is the origin of q.
        centre=mean
        + spread * (cylinder.centre - (cylinder.centre @ cylinder.axis) * cylinder.axis),
        radius=spread * cylinder.radius,
        rms=float(np.sqrt(w @ distances**2)),
        largest=float(np.abs(distances).max()),
        arc=_arc(np.arctan2(across @ v, across @ u)),
        points=len(p),
        iterations=iterations,
        converged=converged,
    )


def _checked(points: Array, normals: Array, weights: Array | None) -> tuple[Array, Array, Array]:
    """The arrays as float64; weights that sum to 1."""
    p = np.asarray(points, dtype=np.float64)
    if p.ndim != 2 or p.shape[1] != 3 or len(p) <= _PARAMETERS:
        raise InputDataError(f"cylinder: points of shape {p.shape}: must be (n, 3), n at least 6")
    n = np.asarray(normals, dtype=np.float64)
    if n.shape != p.shape:
        raise InputDataError(f"cylinder: normals of shape {n.shape}: must be {p.shape}")
    w = np.ones(len(p)) if weights is None else np.asarray(weights, dtype=np.float64)
    if w.shape != (len(p),):
        raise InputDataError(f"cylinder: weights of shape {w.shape}: must be ({len(p)},)")
    for name, values in (("points", p), ("normals", n), ("weights", w)):
        if not np.isfinite(values).all():
            raise InputDataError(f"cylinder: {name} must be finite")
    if (w <= 0.0).any():
        raise InputDataError(f"cylinder: weight {w.min():g}: must be above 0")
    return p, n, w / w.sum()


def _across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors across the axis, with it a right-handed frame."""
    u = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    u /= np.linalg.norm(u)
    return u, np.cross(axis, u)


def _start(q: Array, n: Array, w: Array) -> _Cylinder:
    axis = np.linalg.eigh((n * w[:, None]).T @ n)[1][:, 0]
    u, v = _across(axis)
    x, y, root = q @ u, q @ v, np.sqrt(w)
    # x² + y² + D x + E y + F = 0
    left = np.stack([x, y, np.ones_like(x)], axis=1) * root[:, None]
    D, E, F = np.linalg.lstsq(left, -(x**2 + y**2) * root, rcond=None)[0]
    radius = float(np.sqrt(max(0.25 * (D**2 + E**2) - F, 0.0)))
    return _Cylinder(axis, -0.5 * (D * u + E * v), radius)


def _descend(cylinder: _Cylinder, q: Array, w: Array) -> tuple[_Cylinder, int, bool]:
    """Gauss–Newton: the cylinder, steps, and whether they came to rest."""
    root = np.sqrt(w)
    cost = float(w @ cylinder.distances(q) ** 2)
    for iteration in range(_MAX_ITERATIONS):
        left, right = root[:, None] * _jacobian(cylinder, q), -root * cylinder.distances(q)
        step: Array = np.asarray(np.linalg.lstsq(left, right, rcond=None)[0], dtype=np.float64)
        if np.abs(step).max() <= _SMALL_STEP * max(1.0, cylinder.radius):
            return cylinder.moved(step), iteration + 1, True
        for _ in range(_MAX_HALVINGS):
            tried = cylinder.moved(step)
            lower = float(w @ tried.distances(q) ** 2)
            if lower < cost:
                break
            step *= 0.5
        else:
            # Nothing along the step is lower: the least that rounding lets one find.
            return cylinder, iteration + 1, True
        cylinder, cost = tried, lower
    return cylinder, _MAX_ITERATIONS, False


def _jacobian(cylinder: _Cylinder, q: Array) -> Array:
    """(n, 5) ∂distance/∂(ξ, η, α, β, ρ)."""
    u, v = _across(cylinder.axis)
    across, length, along = cylinder.rays(q)
    e = across / np.maximum(length, 1e-300)[:, None]
    eu, ev = e @ u, e @ v
    return np.stack([-eu, -ev, -along * eu, -along * ev, -np.ones_like(eu)], axis=1)


def _arc(angles: Array) -> float:
    ordered = np.sort(angles)
    gaps = np.diff(ordered, append=ordered[0] + 2.0 * np.pi)
    return float(2.0 * np.pi - gaps.max())
