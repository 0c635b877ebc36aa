// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/load_sum.hpp"

#include <Eigen/Geometry>

namespace condyle::contact {
namespace {

Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

}  // namespace

void LoadSum::add_wrench(const LoadedPoint& point) {
  const Vector3 force = -point.area * point.pressure * point.gradient;
  wrench_.head<3>() += force;
  wrench_.tail<3>() += point.arm.cross(force);
}

void LoadSum::add(const LoadedPoint& point, const Matrix3& hessian) {
  add_wrench(point);
  const Vector3& r = point.arm;
  const Vector3& g = point.gradient;
  const Matrix3 arm = cross_matrix(r);
  const Vector3 force = -point.area * point.pressure * g;

  Vector6 b;  // δd = bᵀ(v, ω)
  b << g, r.cross(g);
  twist_stiffness_.noalias() -= (point.area * point.pressure_rate) * (b * b.transpose());

  // δf at fixed pressure, −A p δg = A p [H(v + ω×r) − ω×g]; then δm = r×δf − v×f.
  const Matrix3 by_v = (point.area * point.pressure) * hessian;
  const Matrix3 by_w = -by_v * arm - cross_matrix(force);
  twist_stiffness_.topLeftCorner<3, 3>() += by_v;
  twist_stiffness_.topRightCorner<3, 3>() += by_w;
  twist_stiffness_.bottomLeftCorner<3, 3>() += arm * by_v + cross_matrix(force);
  twist_stiffness_.bottomRightCorner<3, 3>() += arm * by_w;
}

Matrix6 LoadSum::stiffness(const Pose& pose) const { return twist_stiffness_ * twist_map(pose); }

}  // namespace condyle::contact
