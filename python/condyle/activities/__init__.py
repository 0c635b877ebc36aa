# SPDX-License-Identifier: Apache-2.0
"""Activities: load cases of a knee simulator over time.

Five are built in (BUILT_IN), of the kinds that Marra et al. 2017 sampled around: ``iso_like_gait``,
``turn_like_gait``, ``leg_swing_like``, ``chair_rise_like`` and ``squat_like``, CSV files in this
package, meant to be copied and replaced. They are shaped after published figures and claim no compliance with any
standard; their header says what is known and what is not. A CSV of the user's own takes the same
columns: time_s, flexion_deg, axial_force_N, ap_force_N, ie_torque_Nm.

Signs: flexion positive; axial force ≥ 0 presses the femur onto the tibia; AP force and IE torque
act on the TIBIA, positive anterior and positive inward (internal rotation).
"""

from condyle.activities.load_case import (
    BUILT_IN,
    LOAD_CASE_COLUMNS,
    LoadCase,
    load_case,
    load_case_file,
)

__all__ = ["BUILT_IN", "LOAD_CASE_COLUMNS", "LoadCase", "load_case", "load_case_file"]
