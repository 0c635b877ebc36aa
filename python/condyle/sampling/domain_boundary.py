# SPDX-License-Identifier: Apache-2.0
"""Domain 4, contact boundary: the surfaces barely touch, as when a leg begins to swing.

Fy and Mx are uniform in [0, 100] N and ±5 Nm whatever the pose; x, z, θy, θz fill the widened box
of their own principal scores, as the six variables do in domain 2. A knee's contact carries only
about |Mx| ≤ 31 mm · Fy, so most of the (Fy, Mx) rectangle has no equilibrium: the solver says so
before iterating. Where only y is a sensitive direction, θx takes Mx's place, uniform over the widened
range of the curves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.sampling.domain import CubeDomain
from condyle.sampling.equilibrium_protocol import Prescribed
from condyle.sampling.principal_axes import PrincipalBox
from condyle.sampling.reference_curves import ReferenceCurves
from condyle.sampling.thickening import thickened

_POSE_VARIABLES = ("x", "z", "theta_y", "theta_z")


@dataclass(frozen=True)
class ContactBoundaryDomain(CubeDomain):
    """See the module docstring.

    Attributes:
        box: The widened box in the scores of x, z, θy, θz.
        max_Fy: Fy is in [0, max_Fy] [N].
        max_Mx: Mx is in [−max_Mx, max_Mx] [Nm].
        theta_x_range: θx is in this [rad], and Mx is solved for; None where Mx is drawn.
    """

    box: PrincipalBox
    max_Fy: float
    max_Mx: float
    theta_x_range: tuple[float, float] | None = None

    number = 4

    @classmethod
    def around(
        cls,
        curves: ReferenceCurves,
        *,
        widening: float,
        margins: Mapping[str, float],
        max_Fy: float,
        max_Mx: float,
        theta_x_drawn: bool = False,
    ) -> ContactBoundaryDomain:
        """The domain of reference curves, each thickened by ± its margin in some variables.

        Raises:
            InputDataError: θx is to be drawn, and the curves do not vary in it.
        """
        values = thickened(curves.table(_POSE_VARIABLES), _POSE_VARIABLES, margins)
        box = PrincipalBox.around(values, _POSE_VARIABLES, widening)
        return cls(box, max_Fy, max_Mx, _theta_x_range(curves, widening) if theta_x_drawn else None)

    def prescribe(self, unit: NDArray[np.float64]) -> Prescribed:
        """The equilibria of points (n, 6) of the unit cube: Fy, Mx or θx, then the four scores."""
        return self._assemble(unit[:, 0], unit[:, 1], self.box.values(unit[:, 2:]))

    def envelope(self) -> NDArray[np.float64]:
        """The box's 16 corners at each corner of (Fy, Mx): (64, 6) as PRESCRIBED_COLUMNS.

        Mx is NaN where θx is drawn.
        """
        corners = np.tile(self.box.corners(), (4, 1))
        first, second = np.repeat([[0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0]], 16, axis=1)
        return self._assemble(first, second, corners).to_array()

    def describe(self) -> dict[str, object]:
        """Loads and box."""
        name, (low, high) = self._second
        return {
            "kind": f"Fy and {name} uniform, the pose in a box in its principal scores",
            "Fy": [0.0, self.max_Fy],
            name: [low, high],
            **self.box.describe(),
        }

    @property
    def _second(self) -> tuple[str, tuple[float, float]]:
        """What is drawn beside Fy, and its range."""
        if self.theta_x_range is not None:
            return "theta_x", self.theta_x_range
        return "Mx", (-self.max_Mx, self.max_Mx)

    def _assemble(
        self, first: NDArray[np.float64], second: NDArray[np.float64], poses: NDArray[np.float64]
    ) -> Prescribed:
        """From shares (n,) of the ranges of Fy and of what is drawn beside it, and x, z, θy, θz (n, 4)."""
        name, (low, high) = self._second
        values = np.column_stack([self.max_Fy * first, low + (high - low) * second, poses])
        return Prescribed.from_columns(values, ("Fy", name, *_POSE_VARIABLES))


def _theta_x_range(curves: ReferenceCurves, widening: float) -> tuple[float, float]:
    theta_x = curves.table(("theta_x",))
    low, high = float(theta_x.min()), float(theta_x.max())
    if not low < high:
        raise InputDataError(
            f"sampling domain 4 (contact boundary): theta_x is {low:.6g} rad in all reference "
            "curves; its range cannot be sampled from them"
        )
    middle, half_length = (high + low) / 2, widening * (high - low) / 2
    return middle - half_length, middle + half_length
