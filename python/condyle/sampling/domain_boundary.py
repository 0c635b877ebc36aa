# SPDX-License-Identifier: Apache-2.0
"""Domain 4, contact boundary: the surfaces barely touch, as when a leg begins to swing.

Fy and Mx are uniform in [0, 100] N and ±5 Nm whatever the pose; x, z, θy, θz fill the widened box
of their own principal scores, as the six variables do in domain 2. A knee's contact carries only
about |Mx| ≤ 31 mm · Fy, so most of the (Fy, Mx) rectangle has no equilibrium: the solver says so
before iterating.
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

_POSE_VARIABLES = ("x", "z", "theta_y", "theta_z")


@dataclass(frozen=True)
class ContactBoundaryDomain(CubeDomain):
    """See the module docstring.

    Attributes:
        box: The widened box in the scores of x, z, θy, θz.
        max_Fy: Fy is in [0, max_Fy] [N].
        max_Mx: Mx is in [−max_Mx, max_Mx] [Nm].
    """

    box: PrincipalBox
    max_Fy: float
    max_Mx: float

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
    ) -> ContactBoundaryDomain:
        """The domain of reference curves, each thickened by ± its margin in some variables."""
        values = thickened(curves.table(_POSE_VARIABLES), _POSE_VARIABLES, margins)
        box = PrincipalBox.around(values, _POSE_VARIABLES, widening)
        return cls(box, max_Fy, max_Mx)

    def prescribe(self, unit: NDArray[np.float64]) -> Prescribed:
        """The equilibria of points (n, 6) of the unit cube: Fy, Mx, then the four scores."""
        return self._assemble(
            self.max_Fy * unit[:, 0],
            self.max_Mx * (2 * unit[:, 1] - 1),
            self.box.values(unit[:, 2:]),
        )

    def envelope(self) -> NDArray[np.float64]:
        """The box's 16 corners at each corner of (Fy, Mx): (64, 6) as PRESCRIBED_COLUMNS."""
        corners = np.tile(self.box.corners(), (4, 1))
        Fy = np.repeat([0.0, 0.0, self.max_Fy, self.max_Fy], 16)
        Mx = np.repeat([-self.max_Mx, self.max_Mx, -self.max_Mx, self.max_Mx], 16)
        return self._assemble(Fy, Mx, corners).to_array()

    def describe(self) -> dict[str, object]:
        """Loads and box."""
        return {
            "kind": "Fy and Mx uniform, the pose in a box in its principal scores",
            "Fy": [0.0, self.max_Fy],
            "Mx": [-self.max_Mx, self.max_Mx],
            **self.box.describe(),
        }

    def _assemble(
        self, Fy: NDArray[np.float64], Mx: NDArray[np.float64], pose_values: NDArray[np.float64]
    ) -> Prescribed:
        columns = {"Fy": Fy, "Mx": Mx, **dict(zip(_POSE_VARIABLES, pose_values.T, strict=True))}
        return Prescribed(**{name: columns[name] for name in PRESCRIBED_COLUMNS})
