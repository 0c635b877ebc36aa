# SPDX-License-Identifier: Apache-2.0
"""The loads that instrumented knees have measured, and how far a lax one lets the femur go.

What :mod:`condyle.sampling.conformity` measures an implant with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from condyle.errors import InputDataError


@dataclass(frozen=True)
class ConformitySettings:
    """Loads, and where to look. The defaults' sources are named; what has none is Condyle's own.

    Attributes:
        body_weight: [N].
        max_flexion: Flexion goes from 0 to this [rad].
        flexion_step: At most this between two flexions [rad].
        low_force: Of the lightest load [body weights]: the swing phase.
        walking_force: Load under which shear and torque count [body weights]; 2.3, the peak in
            walking of the subject whose shear this is (D'Lima et al. 2007, J Biomech 40, S11).
        high_force: Of the highest load; 3.46, descending stairs, the mean peak of five instrumented
            knees (Kutzner et al. 2010, J Biomech 43, 2164).
        medial_share: Least and greatest share of the load on the medial side; in walking it is about
            0.6 to 0.8 (as quoted by Erhart et al. 2010, J Orthop Res, PMC2965044), the lower end is
            Condyle's own.
        ap_shear: Along x [body weights]; 0.30, the peak in walking (D'Lima et al. 2007).
        ml_shear: Along z [body weights]; a tenth of the load: peak shear is 10 to 20 times below the
            axial force (Kutzner et al. 2010).
        torque: About y [Nm]; 10.5, the peak in walking (Bergmann et al. 2014, PLOS ONE, e0086035).
        travel_x: At most this from the settled pose, either way [m].
        travel_z: Likewise [m].
        travel_theta_y: Likewise [rad].
    """

    body_weight: float = 750.0
    max_flexion: float = np.pi / 2
    flexion_step: float = np.pi / 12
    low_force: float = 0.1
    walking_force: float = 2.3
    high_force: float = 3.46
    medial_share: tuple[float, float] = (0.3, 0.8)
    ap_shear: float = 0.30
    ml_shear: float = 0.23
    torque: float = 10.5
    travel_x: float = 5e-3
    travel_z: float = 2e-3
    travel_theta_y: float = np.pi / 18

    def __post_init__(self) -> None:
        """Checks.

        Raises:
            InputDataError: A value outside its limits, or loads out of order.
        """
        limits = {
            "body_weight": (50.0, 3000.0),
            "max_flexion": (0.1, 2.7),
            "flexion_step": (0.01, 0.6),
            "low_force": (0.01, 10.0),
            "walking_force": (self.low_force, 10.0),
            "high_force": (self.walking_force, 10.0),
            "ap_shear": (1e-3, 10.0),
            "ml_shear": (1e-3, 10.0),
            "torque": (1e-2, 100.0),
            "travel_x": (1e-4, 0.02),
            "travel_z": (1e-4, 0.02),
            "travel_theta_y": (1e-3, 0.5),
        }
        for name, (low, high) in limits.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputDataError(
                    f"conformity: {name} is {value!r}; it must be {low:.6g} to {high:.6g}"
                )
        if not 0.0 < self.medial_share[0] < self.medial_share[1] < 1.0:
            raise InputDataError(
                f"conformity: medial_share is {self.medial_share!r}; two rising shares between 0 "
                "and 1 are needed"
            )

    @property
    def travels(self) -> NDArray[np.float64]:
        """(3,) by MOVED [m, m, rad]."""
        return np.array([self.travel_x, self.travel_z, self.travel_theta_y])

    @property
    def resistances(self) -> NDArray[np.float64]:
        """(3,) by MOVED [N, N, Nm]."""
        shears = self.body_weight * np.array([self.ap_shear, self.ml_shear])
        return np.append(shears, self.torque)
