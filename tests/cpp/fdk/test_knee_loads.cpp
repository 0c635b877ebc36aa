// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/knee_loads.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::fdk;

TEST_CASE("applied loads are forces on their lines [oracle]") {
  test::Draw draw(41);
  for (const SideOfBody side : {SideOfBody::kLeft, SideOfBody::kRight}) {
    const Pose pose = test::general_pose(draw, 0.4);
    const KneeLoad load{1730.0, -213.0, 4.7};
    const double offset = 0.0053;
    // Forces at points of their lines, moved to Fo; the torque of the tibia on the femur, reversed.
    const double medial = side == SideOfBody::kLeft ? 1.0 : -1.0;
    const Vector3 Fo = pose.head<3>();
    const Vector3 A(0.0, 0.31, medial * offset), axial(0.0, -1730.0, 0.0);
    const Vector3 B(-0.7, 0.0, 0.0), ap(213.0, 0.0, 0.0);
    Wrench expected;
    expected.head<3>() = axial + ap;
    const Vector3 moment = (A - Fo).cross(axial) + (B - Fo).cross(ap);
    // Inward rotation of the tibia turns its front medially: about +y in a right knee (z, its right, is lateral).
    expected.tail<3>() = moment + Vector3(0.0, side == SideOfBody::kRight ? -4.7 : 4.7, 0.0);
    CHECK((applied_wrench(load, side, offset, pose) - expected).norm() < 1e-10);
  }
}

TEST_CASE("an inward torque turns the tibia inward against the femur [property]") {
  // At rest with the femur under its reaction, θy must move so that clinical external rotation falls. Q_θy = −cosθx My + …
  for (const SideOfBody side : {SideOfBody::kLeft, SideOfBody::kRight}) {
    Pose pose = Pose::Zero();
    const Vector6 Q = generalised_force(pose, applied_wrench({0.0, 0.0, 3.0}, side, 0.0, pose));
    // Tibial external rotation is +θy in a left knee and −θy in a right one (common/clinical_kinematics.hpp).
    const double external = side == SideOfBody::kLeft ? Q[kThetaY] : -Q[kThetaY];
    CHECK(external == doctest::Approx(-3.0));
  }
}

TEST_CASE("derivatives of applied loads and springs are theirs [derivative]") {
  test::Draw draw(42);
  const Pose pose = test::general_pose(draw, 0.4);
  const KneeLoad load{1730.0, -213.0, 4.7};
  RestraintSprings springs;
  springs.ap_gap = 0.0021;
  springs.ie_gap = 0.03;
  springs.ml_stiffness = 870.0;
  springs.reference_x = pose[kX] + 0.0057;
  springs.reference_theta_y = pose[kThetaY] + 0.02;  // inside its free play
  const double h = 1e-6;
  Matrix6 applied, restraint;
  for (int j = 0; j < 6; ++j) {
    Pose a = pose, b = pose;
    a[j] += h;
    b[j] -= h;
    applied.col(j) = (applied_wrench(load, SideOfBody::kLeft, 0.005, a) -
                      applied_wrench(load, SideOfBody::kLeft, 0.005, b)) / (2 * h);
    restraint.col(j) = (restraint_force(springs, a) - restraint_force(springs, b)) / (2 * h);
  }
  // Linear functions: rounding only, eps·2000 N/h.
  CHECK((applied - applied_stiffness(load)).norm() < 1e-5);
  CHECK((restraint - restraint_stiffness(springs, pose)).norm() < 1e-5);
  CHECK(restraint_force(springs, pose)[kX] == doctest::Approx(30e3 * (0.0057 - 0.0021)));
  CHECK(restraint_force(springs, pose)[kThetaY] == 0.0);
  CHECK(restraint_force(springs, pose)[kZ] == doctest::Approx(-870.0 * pose[kZ]));
}

TEST_CASE("a spring that cannot be is refused [error]") {
  RestraintSprings springs;
  springs.ie_gap = -0.1;
  CHECK_THROWS_WITH_AS(
      require_valid(springs),
      "restraint springs: ie_gap is -0.100000: must be finite and at least 0",
      std::invalid_argument);
}
