# SPDX-License-Identifier: Apache-2.0
"""Functions of OpenSim as functions of a model file: sums over single coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from condyle.opensim.library import opensim_library

#: Classes with knots, and their kind in a model file.
_KNOTTED = {"SimmSpline": "simm_spline", "PiecewiseLinearFunction": "piecewise_linear"}


class NotRepresentable(Exception):
    """A function that a model file has no kind for; the message is its class and why."""


@dataclass
class Sum:
    """constant + Σ function(coordinate)."""

    constant: float = 0.0
    terms: list[dict[str, Any]] = field(default_factory=list)

    def scaled(self, factor: float) -> Sum:
        """The sum times a number."""
        terms = [
            {
                "coordinate": term["coordinate"],
                "function": scaled_function(term["function"], factor),
            }
            for term in self.terms
        ]
        return Sum(self.constant * factor, terms)


def to_sum(function: Any, coordinates: Sequence[str]) -> Sum:
    """A function of coordinates as a constant and terms.

    Raises:
        NotRepresentable: Of a class, or of a number of coordinates, that does not fit.
    """
    library = opensim_library()
    name = function.getConcreteClassName()
    if name == "MultiplierFunction":
        multiplier = library.MultiplierFunction.safeDownCast(function)
        return to_sum(multiplier.getFunction(), coordinates).scaled(multiplier.getScale())
    if name == "Constant":
        return Sum(constant=library.Constant.safeDownCast(function).getValue())
    if name == "LinearFunction":
        return _linear(library.LinearFunction.safeDownCast(function), coordinates)
    if len(coordinates) != 1:
        raise NotRepresentable(f"{name} of {len(coordinates)} coordinates")
    return Sum(terms=[{"coordinate": coordinates[0], "function": to_function(function)}])


def to_function(function: Any) -> dict[str, Any]:
    """A function of one coordinate.

    Raises:
        NotRepresentable: Of a class that does not fit.
    """
    library = opensim_library()
    name = function.getConcreteClassName()
    if name == "MultiplierFunction":
        multiplier = library.MultiplierFunction.safeDownCast(function)
        return scaled_function(to_function(multiplier.getFunction()), multiplier.getScale())
    if name == "Constant":
        constant = library.Constant.safeDownCast(function).getValue()
        return {"kind": "polynomial", "coefficients": [constant]}
    if name == "LinearFunction":
        slope, intercept = _numbers(
            library.LinearFunction.safeDownCast(function).getCoefficients(), 2
        )
        return {"kind": "linear", "slope": slope, "intercept": intercept}
    if name == "PolynomialFunction":
        highest_first = library.PolynomialFunction.safeDownCast(function).getCoefficients()
        coefficients = _numbers(highest_first, highest_first.size())
        return {"kind": "polynomial", "coefficients": coefficients[::-1]}
    if name in _KNOTTED:
        spline = getattr(library, name).safeDownCast(function)
        knots = range(spline.getSize())
        x, y = [spline.getX(i) for i in knots], [spline.getY(i) for i in knots]
        if len(x) >= 2:
            return {"kind": _KNOTTED[name], "x": x, "y": y}
        name += f" with {len(x)} knots"
    raise NotRepresentable(name)


def _linear(function: Any, coordinates: Sequence[str]) -> Sum:
    n = len(coordinates)
    *slopes, intercept = _numbers(function.getCoefficients(), n + 1)
    if n == 1:
        text = {"kind": "linear", "slope": slopes[0], "intercept": intercept}
        return Sum(terms=[{"coordinate": coordinates[0], "function": text}])
    terms = [
        {"coordinate": name, "function": {"kind": "linear", "slope": slope, "intercept": 0.0}}
        for name, slope in zip(coordinates, slopes, strict=True)
    ]
    return Sum(intercept, terms)


def _numbers(values: Any, n: int) -> list[float]:
    if values.size() != n:
        raise NotRepresentable(f"a function with {values.size()} coefficients for {n}")
    return [float(values.get(i)) for i in range(n)]


def scaled_function(function: dict[str, Any], factor: float) -> dict[str, Any]:
    """A function times a number: all kinds are linear in their numbers, SIMM's ends included."""
    scaled = dict(function)
    for key in ("slope", "intercept"):
        if key in scaled:
            scaled[key] = scaled[key] * factor
    for key in ("coefficients", "y"):
        if key in scaled:
            scaled[key] = [value * factor for value in scaled[key]]
    return scaled
