// SPDX-License-Identifier: Apache-2.0
// Fixed-size linear algebra types that every capability shares.
#pragma once

#include <Eigen/Core>

namespace condyle {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
/// Row-major, so that its memory is `stiffness[i][j]` for a NumPy or ONNX reader.
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// A placement of frame B in frame A: `p_AQ = R_AB * p_BQ + p_ABo_A`.
struct RigidTransform {
  Matrix3 R = Matrix3::Identity();    ///< R_AB: maps components in B to components in A.
  Vector3 p = Vector3::Zero();        ///< p_ABo_A: B's origin, measured from A's and expressed in A [m].

  Vector3 operator*(const Vector3& p_BQ) const { return R * p_BQ + p; }
  RigidTransform inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
  RigidTransform operator*(const RigidTransform& X_BC) const { return {R * X_BC.R, R * X_BC.p + p}; }
};

}  // namespace condyle
