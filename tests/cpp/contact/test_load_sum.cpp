// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "condyle/contact/load_sum.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::contact;

namespace {

// An ellipsoid-like body about s in F: φ(q) = |D (q − s)| − R, with gradient and Hessian in closed
// form (no distance, but the sum only needs a smooth function).
struct Body {
  Vector3 s{0.009, 0.025, 0.012};
  Vector3 D{1.1, 0.8, 1.3};
  double R = 0.06;

  double value(const Vector3& q) const { return D.cwiseProduct(q - s).norm() - R; }
  Vector3 gradient(const Vector3& q) const {
    const Vector3 u = D.cwiseProduct(q - s);
    return D.cwiseProduct(u) / u.norm();
  }
  Matrix3 hessian(const Vector3& q) const {
    const Vector3 u = D.cwiseProduct(q - s), n = u.normalized();
    return D.asDiagonal() * ((Matrix3::Identity() - n * n.transpose()) / u.norm()) * D.asDiagonal();
  }
};

constexpr double kModulus = 9.3e9;

struct Sums {
  double energy = 0.0;
  Wrench wrench;
  Matrix6 stiffness;
};

// Points of a slab in T, all inside the body at the poses used.
std::vector<Vector3> points() {
  test::Draw draw(2);
  std::vector<Vector3> p;
  for (int i = 0; i < 60; ++i)
    p.emplace_back(draw(-0.006, 0.006), draw(0.0, 0.002), draw(-0.006, 0.006));
  return p;
}

Sums evaluate(const Pose& pose, bool with_stiffness) {
  const Body body;
  const RigidTransform X_TF = transform_TF(pose), X_FT = X_TF.inverse();
  LoadSum sum;
  Sums sums;
  for (const Vector3& c : points()) {
    const double area = 1e-7 * (1.0 + 40.0 * c.x());
    const Vector3 q = X_FT * c;
    const double d = -body.value(q);
    REQUIRE(d > 0.0);
    sums.energy += area * 0.5 * kModulus * d * d;
    const LoadedPoint point{c - X_TF.p, X_TF.R * body.gradient(q), area, kModulus * d, kModulus};
    if (with_stiffness) {
      sum.add(point, X_TF.R * body.hessian(q) * X_TF.R.transpose());
    } else {
      sum.add_wrench(point);
    }
  }
  sums.wrench = sum.wrench();
  sums.stiffness = sum.stiffness(pose);
  return sums;
}

}  // namespace

TEST_CASE("wrench and stiffness are the derivatives of the energy in general poses") {
  test::Draw draw(77);
  for (int trial = 0; trial < 12; ++trial) {
    Pose pose;
    for (int i = 0; i < 3; ++i) pose[i] = draw(-0.003, 0.003);
    for (int i = 3; i < 6; ++i) pose[i] = draw(-1.2, 1.2);
    const Sums at = evaluate(pose, true);
    CHECK(at.wrench == evaluate(pose, false).wrench);
    const Vector6 force = generalised_force(pose, at.wrench);
    Matrix6 stiffness;
    for (int i = 0; i < 6; ++i) {
      // Error of a central difference: third derivatives over the 0.015 to the body's middle give
      // (h/0.015)² = 5e-9 for lengths and 1e-10 for angles; rounding 1e-16 / (h/0.015) = 2e-12.
      const double h = i < 3 ? 1e-6 : 1e-5;
      Pose ahead = pose, behind = pose;
      ahead[i] += h;
      behind[i] -= h;
      const Sums a = evaluate(ahead, false), b = evaluate(behind, false);
      const double scale = i < 3 ? at.wrench.head<3>().norm() : 0.02 * at.wrench.head<3>().norm();
      CHECK(std::abs(force[i] + (a.energy - b.energy) / (2.0 * h)) < 1e-7 * scale);
      stiffness.col(i) = (a.wrench - b.wrench) / (2.0 * h);
    }
    CHECK((stiffness - at.stiffness).norm() < 1e-7 * at.stiffness.norm());
    const Matrix6 symmetric = generalised_stiffness(pose, at.wrench, at.stiffness);
    CHECK((symmetric - symmetric.transpose()).norm() < 1e-12 * symmetric.norm());
  }
}
