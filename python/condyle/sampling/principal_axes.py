# SPDX-License-Identifier: Apache-2.0
"""Principal axes of z-scored variables, and the box that their scores fill.

    s = V (v − mean) / scale,   v = mean + scale · Vᵀ s,   rows of V the principal axes, scale the
    standard deviation.

A box in the scores, widened about its middle, is wider than the data everywhere and yet keeps their
gross correlation (Marra 2017, domain 2: deep flexion comes with its own loads, not with all loads).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError

#: An eigenvalue of the correlation matrix below this share of the greatest is its rounding (about
#: d·eps), not variation of the data.
_RANK_TOLERANCE = 1e-12


@dataclass(frozen=True)
class PrincipalAxes:
    """See the module docstring.

    Attributes:
        columns: The d variables' names.
        mean: (d,) in the variables' units.
        scale: (d,) standard deviation (divisor n), in the variables' units.
        axes: (d, d), one principal axis a row, by falling variance; the largest component of each
            is positive.
    """

    columns: tuple[str, ...]
    mean: NDArray[np.float64]
    scale: NDArray[np.float64]
    axes: NDArray[np.float64]

    @classmethod
    def fit(cls, values: NDArray[np.float64], columns: tuple[str, ...]) -> PrincipalAxes:
        """The principal axes of values (n, d).

        Raises:
            InputDataError: Too few rows, a variable that is constant, or variables that depend on
                each other linearly.
        """
        count, dimensions = values.shape
        if count <= dimensions:
            raise InputDataError(
                f"principal axes of {dimensions} variables need more than {count} time frames"
            )
        mean, scale = values.mean(axis=0), values.std(axis=0)
        for name, centre, spread in zip(columns, mean, scale, strict=True):
            if spread <= 1e-12 * max(abs(float(centre)), 1e-3):
                raise InputDataError(
                    f"reference curves: {name} is constant ({centre:.6g}); "
                    "its range cannot be sampled from them"
                )
        z_scores = (values - mean) / scale
        # einsum and not @: BLAS may round differently with another number of threads, and a
        # dataset's bytes start here.
        variance, vectors = np.linalg.eigh(np.einsum("ni,nj->ij", z_scores, z_scores) / count)
        variance, axes = variance[::-1], vectors.T[::-1]
        if variance[-1] <= _RANK_TOLERANCE * variance[0]:
            varying = int(np.sum(variance > _RANK_TOLERANCE * variance[0]))
            raise InputDataError(
                f"reference curves: {', '.join(columns)} vary in {varying} independent "
                f"directions only; {dimensions} are needed (add an activity)"
            )
        # An axis and its negative are equally principal; this choice makes the box a function of
        # the data.
        largest = axes[np.arange(dimensions), np.argmax(np.abs(axes), axis=1)]
        return cls(tuple(columns), mean, scale, axes * np.sign(largest)[:, None])

    def scores(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Scores (n, d) of values (n, d)."""
        scores: NDArray[np.float64] = np.einsum(
            "ni,ki->nk", (values - self.mean) / self.scale, self.axes
        )
        return scores

    def values(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values (n, d) of scores (n, d)."""
        z_scores: NDArray[np.float64] = np.einsum("nk,ki->ni", scores, self.axes)
        return self.mean + self.scale * z_scores


@dataclass(frozen=True)
class PrincipalBox:
    """The box low ≤ s ≤ high in the scores of ``axes``.

    Attributes:
        axes: The principal axes.
        low: (d,) scores.
        high: (d,) scores.
    """

    axes: PrincipalAxes
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def around(
        cls, values: NDArray[np.float64], columns: tuple[str, ...], widening: float
    ) -> PrincipalBox:
        """The box of values (n, d): each score's range, ``widening`` × as long, same middle."""
        axes = PrincipalAxes.fit(values, columns)
        scores = axes.scores(values)
        low, high = scores.min(axis=0), scores.max(axis=0)
        middle, half_length = (high + low) / 2, widening * (high - low) / 2
        return cls(axes, middle - half_length, middle + half_length)

    def values(self, unit: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values (n, d) of points (n, d) of the unit cube."""
        return self.axes.values(self.low + (self.high - self.low) * unit)

    def contains(self, values: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether each of values (n, d) is in the box: (n,)."""
        scores = self.axes.scores(values)
        inside: NDArray[np.bool_] = np.all((scores >= self.low) & (scores <= self.high), axis=1)
        return inside

    def corners(self) -> NDArray[np.float64]:
        """Its corners as values (2ᵈ, d); their hull in any two columns is its shadow there."""
        cube = np.array(list(itertools.product((0.0, 1.0), repeat=len(self.low))))
        return self.values(cube)

    def describe(self) -> dict[str, object]:
        """Everything that defines the box, for a manifest."""
        return {
            "columns": list(self.axes.columns),
            "mean": self.axes.mean.tolist(),
            "scale": self.axes.scale.tolist(),
            "axes": self.axes.axes.tolist(),
            "score_low": self.low.tolist(),
            "score_high": self.high.tolist(),
        }
