// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "condyle/contact/contact_sums.hpp"
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

/// Which body's frame moves: the one whose distance is taken, or the one that has the points.
enum class Moving { kDistance, kPoints };

// Points of a slab, all inside the body at the poses used.
std::vector<Vector3> points() {
  test::Draw draw(2);
  std::vector<Vector3> p;
  for (int i = 0; i < 60; ++i)
    p.emplace_back(draw(-0.006, 0.006), draw(0.0, 0.002), draw(-0.006, 0.006));
  return p;
}

CompartmentLoads evaluate(Moving moving, const Pose& pose, bool with_stiffness) {
  const Body body;
  const RigidTransform X_TF = transform_TF(pose);
  const RigidTransform X_DP = moving == Moving::kDistance ? X_TF.inverse() : X_TF;
  ContactSums sums;
  for (const Vector3& c : points()) {
    const double area = 1e-7 * (1.0 + 40.0 * c.x());
    const Vector3 q = X_DP * c;
    const double d = -body.value(q);
    REQUIRE(d > 0.0);
    const LoadedPoint point{q,        body.gradient(q), area,
                            d,        0.5 * kModulus * d * d, kModulus * d,
                            kModulus};
    sums.add(point);
    if (with_stiffness) sums.add_stiffness(point, body.hessian(q));
  }
  return moving == Moving::kDistance ? loads_of_moving_distance(sums, pose, with_stiffness)
                                     : loads_of_fixed_distance(sums, pose, with_stiffness);
}

}  // namespace

TEST_CASE("wrench and stiffness are the derivatives of the energy, whichever body moves") {
  test::Draw draw(77);
  for (const Moving moving : {Moving::kDistance, Moving::kPoints}) {
    CAPTURE(static_cast<int>(moving));
    for (int trial = 0; trial < 12; ++trial) {
      Pose pose;
      for (int i = 0; i < 3; ++i) pose[i] = draw(-0.003, 0.003);
      for (int i = 3; i < 6; ++i) pose[i] = draw(-1.2, 1.2);
      const CompartmentLoads at = evaluate(moving, pose, true);
      CHECK(at.wrench == evaluate(moving, pose, false).wrench);
      const Vector6 force = generalised_force(pose, at.wrench);
      Matrix6 stiffness;
      for (int i = 0; i < 6; ++i) {
        // Error of a central difference: third derivatives over the 0.015 to the body's middle give
        // (h/0.015)² = 5e-9 for lengths and 1e-10 for angles; rounding 1e-16 / (h/0.015) = 2e-12.
        const double h = i < 3 ? 1e-6 : 1e-5;
        Pose ahead = pose, behind = pose;
        ahead[i] += h;
        behind[i] -= h;
        const CompartmentLoads a = evaluate(moving, ahead, false);
        const CompartmentLoads b = evaluate(moving, behind, false);
        const double scale = i < 3 ? at.wrench.head<3>().norm() : 0.02 * at.wrench.head<3>().norm();
        CHECK(std::abs(force[i] + (a.energy - b.energy) / (2.0 * h)) < 1e-7 * scale);
        stiffness.col(i) = (a.wrench - b.wrench) / (2.0 * h);
      }
      CHECK((stiffness - at.stiffness).norm() < 1e-7 * at.stiffness.norm());
      const Matrix6 symmetric = generalised_stiffness(pose, at.wrench, at.stiffness);
      CHECK((symmetric - symmetric.transpose()).norm() < 1e-12 * symmetric.norm());
    }
  }
}

TEST_CASE("the centre of pressure is where the points are, in T") {
  Pose pose;
  pose << 0.002, -0.001, 0.0015, 0.3, -0.4, 0.9;
  const CompartmentLoads fixed_points = evaluate(Moving::kDistance, pose, false);
  const Vector3 fixed = fixed_points.pressure_moment / fixed_points.pressure_sum;
  CHECK(std::abs(fixed.x()) < 0.006);
  CHECK(fixed.y() > 0.0);
  CHECK(fixed.y() < 0.002);
  const CompartmentLoads moving_points = evaluate(Moving::kPoints, pose, false);
  const Vector3 moving = transform_TF(pose).inverse() *
                         Vector3(moving_points.pressure_moment / moving_points.pressure_sum);
  CHECK(std::abs(moving.x()) < 0.006);
  CHECK(moving.y() > 0.0);
  CHECK(moving.y() < 0.002);
}

TEST_CASE("the mean of two integrations") {
  Pose pose;
  pose << 0.002, -0.001, 0.0015, 0.3, -0.4, 0.9;
  const CompartmentLoads a = evaluate(Moving::kDistance, pose, true);
  const CompartmentLoads b = evaluate(Moving::kPoints, pose, true);
  const CompartmentLoads m = mean(a, b);
  CHECK((m.wrench - 0.5 * (a.wrench + b.wrench)).norm() == 0.0);
  CHECK((m.stiffness - 0.5 * (a.stiffness + b.stiffness)).norm() == 0.0);
  CHECK(m.energy == 0.5 * (a.energy + b.energy));
  CHECK(m.max_depth == std::max(a.max_depth, b.max_depth));
}
