# SPDX-License-Identifier: Apache-2.0
"""Domain 3, single-sided: one side carries a light load, the other is off.

x, z, θx, θy, θz fill the widened box of their own principal scores; Fy is uniform in [0, 100] N;
θx is prescribed and y solved for. Reference curves hardly lift off, so θx is then stretched about
its middle until it spans, with the same widening, the lift-off angles of both sides under the
largest Fy at 64 poses of the box (:mod:`condyle.sampling.lift_off`). A candidate on which both
sides carry after all is kept, and flagged ``two_sided`` in the dataset.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError
from condyle.sampling.domain import CubeDomain
from condyle.sampling.equilibrium_protocol import Prescribed, StaticEquilibriumSolver
from condyle.sampling.hammersley import hammersley
from condyle.sampling.lift_off import lift_off_angles
from condyle.sampling.principal_axes import PrincipalBox
from condyle.sampling.reference_curves import ReferenceCurves
from condyle.sampling.thickening import thickened

_POSE_VARIABLES = ("x", "z", "theta_x", "theta_y", "theta_z")
_THETA_X = _POSE_VARIABLES.index("theta_x")
_PROBES = 64


@dataclass(frozen=True)
class SingleSidedDomain(CubeDomain):
    """See the module docstring.

    Attributes:
        box: The widened box in the scores of x, z, θx, θy, θz.
        theta_x_range: θx of the box's poses is stretched to this (low, high) [rad].
        lift_off: Least and greatest lift-off angle found [rad].
        probes: Poses at which both were found.
        max_Fy: Fy is in [0, max_Fy] [N].
    """

    box: PrincipalBox
    theta_x_range: tuple[float, float]
    lift_off: tuple[float, float]
    probes: int
    max_Fy: float

    number = 3

    @classmethod
    def around(
        cls,
        curves: ReferenceCurves,
        solver: StaticEquilibriumSolver,
        *,
        widening: float,
        margins: Mapping[str, float],
        max_Fy: float,
        theta_z_limits: tuple[float, float],
    ) -> SingleSidedDomain:
        """The domain of reference curves, each thickened by ± its margin in some variables.

        Args:
            curves: The reference curves.
            solver: Finds the lift-off angles.
            widening: Of the scores' box, and of θx beyond the lift-off angles.
            margins: See :func:`condyle.sampling.thickening.thickened`.
            max_Fy: Largest Fy [N].
            theta_z_limits: Poses beyond are not probed [rad].

        Raises:
            InputDataError: No pose of the box has a lift-off angle on both sides.
        """
        values = thickened(curves.table(_POSE_VARIABLES), _POSE_VARIABLES, margins)
        box = PrincipalBox.around(values, _POSE_VARIABLES, widening)
        poses = box.values(hammersley(_PROBES, len(_POSE_VARIABLES)))
        poses = poses[(poses[:, -1] >= theta_z_limits[0]) & (poses[:, -1] <= theta_z_limits[1])]
        columns = dict(zip(_POSE_VARIABLES, poses.T, strict=True))
        columns["Fy"], columns["Mx"] = np.full((2, len(poses)), max_Fy)
        angles = lift_off_angles(solver, Prescribed(**columns))
        found = angles[~np.isnan(angles[:, 0])]
        if not len(found):
            raise InputDataError(
                f"sampling domain 3 (single-sided): no side lifts off at {max_Fy:.6g} N at any of "
                f"{len(poses)} poses; do the reference curves belong to this implant?"
            )
        lift_off = (float(found.min()), float(found.max()))
        own = box.corners()[:, _THETA_X]
        low, high = min(lift_off[0], own.min()), max(lift_off[1], own.max())
        middle, half_length = (high + low) / 2, widening * (high - low) / 2
        theta_x_range = (float(middle - half_length), float(middle + half_length))
        return cls(box, theta_x_range, lift_off, len(found), max_Fy)

    def prescribe(self, unit: NDArray[np.float64]) -> Prescribed:
        """The equilibria of points (n, 6) of the unit cube: Fy, then the five scores."""
        return self._assemble(self.max_Fy * unit[:, 0], self.box.values(unit[:, 1:]))

    def envelope(self) -> NDArray[np.float64]:
        """The box's 32 corners at both ends of Fy: (64, 6) as PRESCRIBED_COLUMNS, Mx NaN."""
        Fy = np.repeat([0.0, self.max_Fy], 32)
        return self._assemble(Fy, np.tile(self.box.corners(), (2, 1))).to_array()

    def describe(self) -> dict[str, object]:
        """Loads, box and stretch."""
        return {
            "kind": "Fy uniform, the pose in a box in its principal scores, theta_x stretched",
            "Fy": [0.0, self.max_Fy],
            "theta_x": list(self.theta_x_range),
            "lift_off": list(self.lift_off),
            "lift_off_poses": self.probes,
            **self.box.describe(),
        }

    def _assemble(self, Fy: NDArray[np.float64], values: NDArray[np.float64]) -> Prescribed:
        columns = dict(zip(_POSE_VARIABLES, values.T, strict=True))
        own = self.box.corners()[:, _THETA_X]
        low, high = self.theta_x_range
        share = (columns["theta_x"] - own.min()) / (own.max() - own.min())
        columns["theta_x"] = low + (high - low) * share
        return Prescribed(Fy=Fy, Mx=np.full(len(Fy), np.nan), **columns)
