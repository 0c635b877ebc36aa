# SPDX-License-Identifier: Apache-2.0
"""Names of the pose coordinates, load components and sides, in their one order.

The mathematics of the conventions lives in ``core/condyle/common/pose.hpp``; this module only names columns.
Pose: femoral frame F relative to the tibial frame T, m and rad. Loads: on the femur, at Fo, expressed in T, N and Nm.
"""

from typing import Final, Literal

POSE_COLUMNS: Final = ("x", "y", "z", "theta_x", "theta_y", "theta_z")
LOAD_COLUMNS: Final = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
SIDES: Final = ("medial", "lateral")
#: medial_Fx ... medial_Mz, lateral_Fx ... lateral_Mz: a (2, 6) wrench, flattened row by row.
WRENCH_COLUMNS: Final = tuple(f"{side}_{load}" for side in SIDES for load in LOAD_COLUMNS)
#: Clinical kinematics (Grood and Suntay 1983), in the order of every (n, 6) array of them.
KINEMATICS_COLUMNS: Final = (
    "flexion_rad",
    "adduction_rad",
    "tibial_external_rotation_rad",
    "anterior_tibial_translation_m",
    "distraction_m",
    "lateral_tibial_translation_m",
)
LOAD_UNITS: Final = ("N", "N", "N", "Nm", "Nm", "Nm")

SideOfBody = Literal["left", "right"]


def medial_direction(side_of_body: SideOfBody) -> int:
    """Sign of z towards the medial compartment: +1 in a left knee, -1 in a right one (z points to the right)."""
    return 1 if side_of_body == "left" else -1
