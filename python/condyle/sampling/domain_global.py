# SPDX-License-Identifier: Apache-2.0
"""Domain 2, global: where the activities are, and half as much again around them.

The six sampled variables {x, Fy, z, Mx, θy, θz} of all reference curves (θx for Mx where only y is
a sensitive direction), thickened first (see
:mod:`condyle.sampling.thickening`), are z-scored; each principal score's [min, max] is widened about
its middle to 1.5 × its length; the unit cube maps to that box, the first cube coordinate (the most
even one of a Hammersley set) to the axis of largest variance.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle.sampling.domain import CubeDomain
from condyle.sampling.equilibrium_protocol import PRESCRIBED_COLUMNS, Prescribed
from condyle.sampling.principal_axes import PrincipalBox
from condyle.sampling.reference_curves import ReferenceCurves
from condyle.sampling.thickening import thickened


@dataclass(frozen=True)
class GlobalDomain(CubeDomain):
    """See the module docstring.

    Attributes:
        box: The widened box in the scores of the six variables.
    """

    box: PrincipalBox

    number = 2

    @classmethod
    def around(
        cls,
        curves: ReferenceCurves,
        *,
        widening: float,
        margins: Mapping[str, float],
        columns: tuple[str, ...] = PRESCRIBED_COLUMNS,
    ) -> GlobalDomain:
        """The domain of reference curves, each thickened by ± its margin in some variables."""
        values = thickened(curves.table(columns), columns, margins)
        return cls(PrincipalBox.around(values, columns, widening))

    def prescribe(self, unit: NDArray[np.float64]) -> Prescribed:
        """The equilibria of points (n, 6) of the unit cube."""
        return self._prescribed(self.box.values(unit))

    def envelope(self) -> NDArray[np.float64]:
        """The box's 64 corners, (64, 6), columns PRESCRIBED_COLUMNS; Mx NaN where θx is drawn."""
        return self._prescribed(self.box.corners()).to_array()

    def describe(self) -> dict[str, object]:
        """The box."""
        return {"kind": "box in the principal scores", **self.box.describe()}

    def _prescribed(self, values: NDArray[np.float64]) -> Prescribed:
        return Prescribed.from_columns(values, self.box.axes.columns)
