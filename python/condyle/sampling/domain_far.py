# SPDX-License-Identifier: Apache-2.0
"""Domain 6, far: out of contact, from the highest boundary point up to 10 cm.

The pose is prescribed: y and θx uniform, θx over the range that the boundary points have; x, z, θy,
θz in domain 4's box. A pose that touches, as may happen at the lowest y, is not far: it is rejected
as ``in_contact``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from condyle.conventions import POSE_COLUMNS
from condyle.errors import InputDataError
from condyle.sampling.domain import CubeDomain
from condyle.sampling.equilibrium_protocol import PRESCRIBED_COLUMNS, Prescribed
from condyle.sampling.principal_axes import PrincipalBox


@dataclass(frozen=True)
class FarDomain(CubeDomain):
    """See the module docstring.

    Attributes:
        box: Domain 4's, in the scores of x, z, θy, θz.
        y_range: (low, high) [m].
        theta_x_range: (low, high) [rad].
    """

    box: PrincipalBox
    y_range: tuple[float, float]
    theta_x_range: tuple[float, float]

    number = 6
    contact_free: ClassVar[bool] = True

    @classmethod
    def above(
        cls, box: PrincipalBox, boundary_poses: NDArray[np.float64], *, max_y: float
    ) -> FarDomain:
        """The domain above boundary points.

        Args:
            box: Domain 4's.
            boundary_poses: (m, 6) domain 4's samples [m, rad].
            max_y: Top of the domain [m].

        Raises:
            InputDataError: The boundary points reach ``max_y``.
        """
        y = boundary_poses[:, POSE_COLUMNS.index("y")]
        tilt = boundary_poses[:, POSE_COLUMNS.index("theta_x")]
        if not y.max() < max_y:
            raise InputDataError(
                f"sampling domain 6 (far): far_max_y is {max_y:.6g} m; it must be above the "
                f"highest contact boundary sample, {y.max():.6g} m"
            )
        return cls(box, (float(y.max()), max_y), (float(tilt.min()), float(tilt.max())))

    def prescribe(self, unit: NDArray[np.float64]) -> Prescribed:
        """The poses of points (n, 6) of the unit cube: y, θx, then the four scores."""
        columns = dict(zip(self.box.axes.columns, self.box.values(unit[:, 2:]).T, strict=True))
        for column, (name, (low, high)) in enumerate(
            (("y", self.y_range), ("theta_x", self.theta_x_range))
        ):
            columns[name] = low + (high - low) * unit[:, column]
        return Prescribed.from_poses(np.column_stack([columns[name] for name in POSE_COLUMNS]))

    def envelope(self) -> NDArray[np.float64]:
        """The box's 16 corners: (16, 6) as PRESCRIBED_COLUMNS, Fy and Mx NaN."""
        corners = dict(zip(self.box.axes.columns, self.box.corners().T, strict=True))
        unknown = np.full(16, np.nan)
        return np.column_stack([corners.get(name, unknown) for name in PRESCRIBED_COLUMNS])

    def describe(self) -> dict[str, object]:
        """Ranges and box."""
        return {
            "kind": "y and theta_x uniform, the rest in a box in its principal scores",
            "y": list(self.y_range),
            "theta_x": list(self.theta_x_range),
            **self.box.describe(),
        }
