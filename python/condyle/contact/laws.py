# SPDX-License-Identifier: Apache-2.0
"""Contact laws: the pressure that a penetration depth makes.

A law has an energy W(d) [J/m²] at depth d [m]; pressure p = W′(d) [Pa] and pressure rate p′ = W″(d) [Pa/m] are its
derivatives, and all are zero at d <= 0. Use :class:`LinearVolumeLaw`, the default, for forces and kinematics; a law of
the real layer (:class:`ThinLayerLinearLaw`, :class:`ThinLayerLogarithmicLaw`) where pressures matter.

The usual modulus of 9.3e9 N/m³ (Marra et al. 2015) was fitted for forces and kinematics, not for pressures:
:func:`youngs_modulus` says that with a Poisson's ratio of 0.46 it means 10 MPa in a layer of 5 mm and 20 MPa in one of
10 mm, where polyethylene has some 463-1000 MPa. Its contact areas are too large and its pressures too low.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from condyle._core import contact as _contact
from condyle.errors import InputDataError


class ContactLaw(ABC):
    """Any contact law; made by one of its subclasses, immutable."""

    @cached_property
    def core(self) -> _contact.ContactLaw:
        """The law in the C++ core.

        Raises:
            InputDataError: a parameter is out of range; the text names law, parameter, value and limit.
        """
        try:
            return self._make()
        except ValueError as error:
            raise InputDataError(str(error)) from None

    @abstractmethod
    def _make(self) -> _contact.ContactLaw: ...

    def __post_init__(self) -> None:
        """Refuses what is out of range."""
        _ = self.core

    def __getstate__(self) -> dict[str, object]:
        """The parameters; the core's object is made again where it is needed."""
        return {k: v for k, v in self.__dict__.items() if k != "core"}

    @property
    def name(self) -> str:
        """Name of the kind of law, as in study files."""
        return self.core.name

    @property
    def parameters(self) -> dict[str, float]:
        """Every parameter, for metadata; names carry the unit. A table's are its points."""
        return dict(self.core.parameters)

    def describe(self) -> dict[str, str | float]:
        """Name and parameters together, for metadata."""
        return {"name": self.name, **self.parameters}

    def energy_at(self, depth: ArrayLike) -> NDArray[np.float64]:
        """Energy W [J/m²] at depths [m] of any shape; returns that shape."""
        return self._values(depth, 0)

    def pressure_at(self, depth: ArrayLike) -> NDArray[np.float64]:
        """Pressure p [Pa] at depths [m] of any shape; returns that shape."""
        return self._values(depth, 1)

    def pressure_rate_at(self, depth: ArrayLike) -> NDArray[np.float64]:
        """Pressure rate p′ [Pa/m] at depths [m] of any shape; returns that shape."""
        return self._values(depth, 2)

    def _values(self, depth: ArrayLike, column: int) -> NDArray[np.float64]:
        depths = np.asarray(depth, dtype=np.float64)
        values: NDArray[np.float64] = self.core.values(np.ascontiguousarray(depths.ravel()))
        return values[:, column].reshape(depths.shape)


@dataclass(frozen=True, kw_only=True)
class LinearVolumeLaw(ContactLaw):
    """p = K·d: the total force is K times the overlap volume (Marra et al. 2015).

    Attributes:
        modulus: K, the pressure modulus [N/m³], > 0; by default 9.3e9, for forces and kinematics, not for pressures.
    """

    modulus: float = _contact.LinearVolumeLaw().modulus

    def _make(self) -> _contact.ContactLaw:
        return _contact.ContactLaw(_contact.LinearVolumeLaw(self.modulus))


@dataclass(frozen=True, kw_only=True)
class _ThinLayerLaw(ContactLaw):
    youngs_modulus: float
    poissons_ratio: float
    thickness: float

    def _layer(self) -> _contact.ElasticLayer:
        return _contact.ElasticLayer(self.youngs_modulus, self.poissons_ratio, self.thickness)


@dataclass(frozen=True, kw_only=True)
class ThinLayerLinearLaw(_ThinLayerLaw):
    """Thin elastic layer under small strain: p = M·d/h, M = (1 - ν)E/((1 + ν)(1 - 2ν)).

    Sources: Blankevoort et al. 1991; Bei & Fregly 2004.

    Attributes:
        youngs_modulus: E [Pa], > 0.
        poissons_ratio: ν, between -1 and 0.5, both excluded.
        thickness: h [m], > 0.
    """

    def _make(self) -> _contact.ContactLaw:
        return _contact.ContactLaw(_contact.ThinLayerLinearLaw(self._layer()))


@dataclass(frozen=True, kw_only=True)
class ThinLayerLogarithmicLaw(_ThinLayerLaw):
    """Thin elastic layer that stiffens as it is squeezed: p = -M·ln(1 - d/h), M as in :class:`ThinLayerLinearLaw`.

    Beyond nine tenths of the thickness the pressure goes on along its tangent, so that it stays finite; such a depth
    is beyond the law. Source: Bei & Fregly 2004.

    Attributes:
        youngs_modulus: E [Pa], > 0.
        poissons_ratio: ν, between -1 and 0.5, both excluded.
        thickness: h [m], > 0.
    """

    def _make(self) -> _contact.ContactLaw:
        return _contact.ContactLaw(_contact.ThinLayerLogarithmicLaw(self._layer()))


@dataclass(frozen=True, kw_only=True)
class PowerLaw(ContactLaw):
    """p = c·dⁿ.

    Attributes:
        coefficient: c [Pa/mⁿ], > 0.
        exponent: n, >= 1: below, the pressure rate would be infinite at touch.
    """

    coefficient: float
    exponent: float

    def _make(self) -> _contact.ContactLaw:
        return _contact.ContactLaw(_contact.PowerLaw(self.coefficient, self.exponent))


@dataclass(frozen=True, kw_only=True)
class TableLaw(ContactLaw):
    """Measured pressures: linear between points, on along the last slope beyond them.

    Attributes:
        depth: n depths [m], the first 0, strictly rising; any sequence is taken, and kept as a tuple.
        pressure: n pressures [Pa], the first 0, never falling, the last > 0.
    """

    depth: tuple[float, ...]
    pressure: tuple[float, ...]

    def __post_init__(self) -> None:
        """Takes any sequences; refuses what is out of range."""
        for field in ("depth", "pressure"):
            values = np.asarray(getattr(self, field), dtype=np.float64)
            if values.ndim != 1:
                raise InputDataError(
                    f"contact law table: {field} has shape {values.shape}: must be (n,)"
                )
            object.__setattr__(self, field, tuple(values.tolist()))
        super().__post_init__()

    def _make(self) -> _contact.ContactLaw:
        return _contact.ContactLaw(_contact.TableLaw(list(self.depth), list(self.pressure)))


def pressure_modulus(*, youngs_modulus: float, poissons_ratio: float, thickness: float) -> float:
    """The pressure modulus of a thin elastic layer, K = M/h [N/m³] with M as in :class:`ThinLayerLinearLaw`.

    Args:
        youngs_modulus: E [Pa].
        poissons_ratio: ν.
        thickness: h [m].

    Raises:
        InputDataError: a parameter is out of range.
    """
    try:
        layer = _contact.ElasticLayer(youngs_modulus, poissons_ratio, thickness)
        return _contact.pressure_modulus(layer)
    except ValueError as error:
        raise InputDataError(str(error)) from None


def youngs_modulus(*, modulus: float, poissons_ratio: float, thickness: float) -> float:
    """Young's modulus [Pa] of the layer that has a pressure modulus: the inverse of :func:`pressure_modulus`.

    What it says of the usual 9.3e9 N/m³ stands at the top of this module.

    Args:
        modulus: K [N/m³].
        poissons_ratio: ν.
        thickness: h [m].

    Raises:
        InputDataError: a parameter is out of range.
    """
    try:
        return _contact.youngs_modulus(modulus, poissons_ratio, thickness)
    except ValueError as error:
        raise InputDataError(str(error)) from None
