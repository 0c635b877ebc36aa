// SPDX-License-Identifier: Apache-2.0
// The conventions of Condyle: what the six numbers of a pose and of a wrench mean, and the maps between them.
// Everything else calls this page; nothing restates it.
//
//   Axes, both frames   x anterior, y superior, z to the subject's RIGHT (medial in a left knee, lateral in a right).
//   Pose                (x, y, z, θx, θy, θz) of the femoral frame F relative to the tibial frame T. (x, y, z) is F's
//                       origin Fo in T. The angles are Tait–Bryan, intrinsic z-y-x FROM femoral TO tibial frame:
//                       R_FT = Rz(θz)·Ry(θy)·Rx(θx), hence R_TF = Rx(−θx)·Ry(−θy)·Rz(−θz).
//                       θz is knee extension: flexion is about −θz.
//   Wrench              (Fx, Fy, Fz, Mx, My, Mz) ON THE FEMUR, at Fo, expressed in T; compression is Fy > 0.
//   Units               m, rad, N, Nm.
#pragma once

#include "condyle/common/types.hpp"

namespace condyle {

/// (x, y, z [m], θx, θy, θz [rad]) of F relative to T.
using Pose = Vector6;
/// (Fx, Fy, Fz [N], Mx, My, Mz [Nm]) on the femur, at Fo, expressed in T.
using Wrench = Vector6;

/// Positions of the coordinates in a Pose; the same positions hold the conjugate loads.
enum PoseIndex : int { kX = 0, kY = 1, kZ = 2, kThetaX = 3, kThetaY = 4, kThetaZ = 5 };

/// R_TF = Rx(−θx)·Ry(−θy)·Rz(−θz): components in F to components in T.
Matrix3 rotation_TF(const Pose& pose);

/// X_TF: the placement of F in T.
RigidTransform transform_TF(const Pose& pose);

/// The pose of a placement, the inverse of transform_TF.
/// @pre X_TF.R is a rotation and |θy| < π/2 there (at ±π/2 θx and θz are not unique; θz is then set to 0).
/// @returns angles with θy in [−π/2, π/2], θx and θz in (−π, π].
Pose pose_from_transform(const RigidTransform& X_TF);

/// G(pose), 6×6: pose rates to the twist of F in T, (v_TFo_T, ω_TF_T) = G·ṗ.
/// Its columns are the axes that the coordinates turn or move about, expressed in T. Singular at cos θy = 0.
Matrix6 twist_map(const Pose& pose);

/// Generalised forces conjugate to the pose: Q = G(pose)ᵀ·wrench, so that power = Qᵀṗ.
///   Qx, Qy, Qz = Fx, Fy, Fz;  Qθx = −Mx;  Qθy = −cosθx·My + sinθx·Mz;
///   Qθz = sinθy·Mx − cosθy·sinθx·My − cosθy·cosθx·Mz.
Vector6 generalised_force(const Pose& pose, const Wrench& wrench_Fo_T);

/// The wrench whose generalised force is Q: G⁻ᵀ·Q. @pre cos θy ≠ 0.
Wrench wrench_from_generalised_force(const Pose& pose, const Vector6& generalised_force);

/// ∂Q/∂pose from a wrench and its stiffness: Gᵀ·S + ∂(Gᵀw)/∂pose at fixed w.
/// @param stiffness S[i][j] = ∂wrench_i/∂pose_j (no sign change; not symmetric).
/// @returns a matrix that is symmetric wherever the wrench derives from an energy.
Matrix6 generalised_stiffness(const Pose& pose, const Wrench& wrench_Fo_T,
                              const Matrix6& stiffness);

/// The inverse of generalised_stiffness in its last argument: S from ∂Q/∂pose. @pre cos θy ≠ 0.
Matrix6 stiffness_from_generalised(const Pose& pose, const Wrench& wrench_Fo_T,
                                   const Matrix6& generalised_stiffness);

}  // namespace condyle
