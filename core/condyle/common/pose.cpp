// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/pose.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace condyle {
namespace {

// ∂(Gᵀw)/∂pose at fixed w: only θx and θy enter G, and only the moment rows depend on them.
Matrix6 geometric_stiffness(const Pose& pose, const Wrench& w) {
  const double sx = std::sin(pose[kThetaX]), cx = std::cos(pose[kThetaX]);
  const double sy = std::sin(pose[kThetaY]), cy = std::cos(pose[kThetaY]);
  const double Mx = w[3], My = w[4], Mz = w[5];
  Matrix6 geometric = Matrix6::Zero();
  geometric(kThetaY, kThetaX) = sx * My + cx * Mz;
  geometric(kThetaZ, kThetaX) = -cy * cx * My + cy * sx * Mz;
  geometric(kThetaZ, kThetaY) = cy * Mx + sy * sx * My + sy * cx * Mz;
  return geometric;
}

}  // namespace

Matrix3 rotation_TF(const Pose& pose) {
  const double sx = std::sin(pose[kThetaX]), cx = std::cos(pose[kThetaX]);
  const double sy = std::sin(pose[kThetaY]), cy = std::cos(pose[kThetaY]);
  const double sz = std::sin(pose[kThetaZ]), cz = std::cos(pose[kThetaZ]);
  // The transpose of Rz(θz)·Ry(θy)·Rx(θx), written out row by row.
  Matrix3 R;
  R << cz * cy, sz * cy, -sy,                                          //
      cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx,         //
      cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx;
  return R;
}

RigidTransform transform_TF(const Pose& pose) { return {rotation_TF(pose), pose.head<3>()}; }

Pose pose_from_transform(const RigidTransform& X_TF) {
  const Matrix3& R = X_TF.R;
  Pose pose;
  pose.head<3>() = X_TF.p;
  const double cy = std::hypot(R(1, 2), R(2, 2));
  pose[kThetaY] = std::atan2(-R(0, 2), cy);
  if (cy > 1e-12) {
    pose[kThetaX] = std::atan2(R(1, 2), R(2, 2));
    pose[kThetaZ] = std::atan2(R(0, 1), R(0, 0));
  } else {  // gimbal lock: only θx ∓ θz is defined; put all of it in θx
    pose[kThetaX] = std::atan2(-R(2, 1), R(1, 1));
    pose[kThetaZ] = 0.0;
  }
  return pose;
}

Matrix6 twist_map(const Pose& pose) {
  const double sx = std::sin(pose[kThetaX]), cx = std::cos(pose[kThetaX]);
  const double sy = std::sin(pose[kThetaY]), cy = std::cos(pose[kThetaY]);
  Matrix6 G = Matrix6::Zero();
  G.topLeftCorner<3, 3>().setIdentity();
  G.col(kThetaX).tail<3>() = Vector3(-1.0, 0.0, 0.0);
  G.col(kThetaY).tail<3>() = Vector3(0.0, -cx, sx);
  G.col(kThetaZ).tail<3>() = Vector3(sy, -cy * sx, -cy * cx);
  return G;
}

Vector6 generalised_force(const Pose& pose, const Wrench& wrench_Fo_T) {
  return twist_map(pose).transpose() * wrench_Fo_T;
}

Wrench wrench_from_generalised_force(const Pose& pose, const Vector6& generalised_force) {
  const Matrix3 moment_map = twist_map(pose).bottomRightCorner<3, 3>().transpose();
  Wrench wrench = generalised_force;
  wrench.tail<3>() = moment_map.inverse() * generalised_force.tail<3>();
  return wrench;
}

Matrix6 generalised_stiffness(const Pose& pose, const Wrench& wrench_Fo_T,
                              const Matrix6& stiffness) {
  return twist_map(pose).transpose() * stiffness + geometric_stiffness(pose, wrench_Fo_T);
}

Matrix6 stiffness_from_generalised(const Pose& pose, const Wrench& wrench_Fo_T,
                                   const Matrix6& generalised_stiffness) {
  const Matrix3 moment_map = twist_map(pose).bottomRightCorner<3, 3>().transpose();
  Matrix6 stiffness = generalised_stiffness - geometric_stiffness(pose, wrench_Fo_T);
  stiffness.bottomRows<3>() = moment_map.inverse() * stiffness.bottomRows<3>().eval();
  return stiffness;
}

}  // namespace condyle
