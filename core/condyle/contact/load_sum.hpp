// SPDX-License-Identifier: Apache-2.0
// From faces to wrench and stiffness: the one sum that every evaluation of the mesh contact shares.
//
// The contact energy of one side is U(pose) = Σ A·W(d), d = −φ(q), with q the face's centroid seen from the femur and φ
// the femur's signed distance (negative inside). With p = W'(d) the pressure, g = ∇φ and H = ∇²φ expressed in T, and
// r = c − Fo the centroid's arm, the wrench on the femur is
//
//   F = −Σ A p g,      M = −Σ A p r × g,
//
// and for a twist (v, ω) of the femur about Fo, δd = gᵀ(v + ω×r), δg = ω×g − H(v + ω×r), δr = −v, which gives ∂wrench.
//
// Source: gradient and Hessian of the elastic-foundation energy, derived here; the law is Marra et al. 2015, 2017.
#pragma once

#include "condyle/common/pose.hpp"

namespace condyle::contact {

/// One loaded face (or quadrature point), everything expressed in T.
struct LoadedPoint {
  Vector3 arm;                ///< r = c − Fo [m]
  Vector3 gradient;           ///< g = ∇φ, unit where φ is an exact distance
  double area = 0.0;          ///< A [m²]
  double pressure = 0.0;      ///< W'(d) [Pa]
  double pressure_rate = 0.0; ///< W''(d) [Pa/m]
};

/// Running sums over loaded points of one side at one pose. No allocation.
class LoadSum {
 public:
  /// Adds a point's share of the wrench only.
  void add_wrench(const LoadedPoint& point);

  /// Adds a point's share of the wrench and of its derivative. @param hessian H = ∇²φ in T [1/m].
  void add(const LoadedPoint& point, const Matrix3& hessian);

  const Wrench& wrench() const { return wrench_; }

  /// ∂wrench/∂pose [N/m, N/rad, Nm/m, Nm/rad] of what add() was given.
  Matrix6 stiffness(const Pose& pose) const;

 private:
  Wrench wrench_ = Wrench::Zero();
  Matrix6 twist_stiffness_ = Matrix6::Zero();  // ∂wrench/∂(v, ω)
};

}  // namespace condyle::contact
