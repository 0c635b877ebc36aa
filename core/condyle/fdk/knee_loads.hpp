// SPDX-License-Identifier: Apache-2.0
// What a knee simulator applies to the femur, apart from contact: axial force, AP force, internal–external torque and
// restraint springs. Each load comes with its derivative.
//
//   axial force F ≥ 0   acts along −y_T on the line through A = (0, ·, z_A), z_A = offset medial of To:
//                       f = (0, −F, 0),  m_Fo = (A − Fo) × f = ((z_A − z) F, 0, x F)
//   AP force P          on the tibia along +x_T; its reaction on the femur acts on the line through To along x_T:
//                       f = (−P, 0, 0),  m_Fo = (To − Fo) × f = (0, z P, −y P)
//   IE torque T         on the tibia about y_T, positive inward (internal rotation); on the femur
//                       m = (0, ±T, 0), + in a left knee, − in a right one
//
// No medial–lateral force and no abduction moment about the axial line are applied. All lines are fixed in T.
//
// Restraint springs stand for the soft tissue, as in force-controlled simulators: linear, acting on the coordinates x
// (AP), θy (IE) and, if asked for, z (ML), each with a free play of ± gap about the reference:
//   Q = −k · (u − clamp(u, −gap, gap)),   u = coordinate − reference.
// Defaults are the 2002 edition's figures as widely quoted: 30 N/mm and 0.6 Nm/deg ("ISO-like", no claim of compliance).
#pragma once

#include <optional>

#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"

namespace condyle::fdk {

/// Loads of one instant, as a load case gives them.
struct KneeLoad {
  double axial_force = 0.0;  ///< [N]
  double ap_force = 0.0;     ///< on the tibia, anterior positive [N]
  double ie_torque = 0.0;    ///< on the tibia, inward positive [Nm]
};

/// Wrench of the applied loads on the femur, at Fo, expressed in T.
/// @param axial_offset how far medial of To the axial line lies [m].
Wrench applied_wrench(const KneeLoad& load, SideOfBody side_of_body, double axial_offset,
                      const Pose& pose);
/// ∂wrench_i/∂pose_j of it.
Matrix6 applied_stiffness(const KneeLoad& load);

struct RestraintSprings {
  double ap_stiffness = 30e3;    ///< on x [N/m]; 0: none
  double ap_gap = 0.0;           ///< free play ± [m]
  double ie_stiffness = 34.377;  ///< on θy [Nm/rad]: 0.6 Nm/deg; 0: none
  double ie_gap = 0.0;           ///< free play ± [rad]
  double ml_stiffness = 0.0;     ///< on z [N/m]: simulators leave ML free
  double ml_gap = 0.0;           ///< free play ± [m]
  std::optional<double> reference_x;        ///< [m]; the settled pose's at zero flexion unless given
  std::optional<double> reference_z;        ///< [m]; likewise
  std::optional<double> reference_theta_y;  ///< [rad]; likewise
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const RestraintSprings& springs);

/// Generalised force of the springs on the pose; a reference that is not set counts as 0.
Vector6 restraint_force(const RestraintSprings& springs, const Pose& pose);
/// Its derivative ∂Q_i/∂pose_j: diagonal; at the edge of the free play, the engaged side's.
Matrix6 restraint_stiffness(const RestraintSprings& springs, const Pose& pose);

}  // namespace condyle::fdk
