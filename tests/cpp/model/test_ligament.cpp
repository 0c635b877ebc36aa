// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/ligament.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

// Nothing is 1, and the slack length is that of a real bundle: a stiffness multiplied by it would show.
Ligament general_ligament(double strain, const Pose& pose) {
  Ligament ligament;
  ligament.name = "general";
  ligament.p_FoA_F = Vector3(-0.0173, 0.0061, 0.0412);
  ligament.p_ToB_T = Vector3(0.0119, -0.0537, 0.0268);
  ligament.stiffness = 2730.0;
  ligament.transition = 0.027;
  ligament.slack_length = 0.05;
  ligament.slack_length = slack_length(ligament, pose, strain);
  return ligament;
}

Pose near_knee(test::Draw& draw) {
  Pose pose;
  pose << draw(-0.01, 0.01), draw(0.039, 0.045), draw(-0.004, 0.004), draw(-0.1, 0.1),
      draw(-0.2, 0.2), draw(-1.5, 0.1);
  return pose;
}

}  // namespace

TEST_CASE("the law is Blankevoort's: slack, toe and linear regions [oracle]") {
  test::Draw draw(31);
  const Pose pose = near_knee(draw);
  const Ligament l = general_ligament(0.0, pose);
  const double L0 = l.slack_length;
  CHECK(tension(l, 0.97 * L0) == 0.0);
  CHECK(tension(l, 1.02 * L0) == doctest::Approx(2730.0 * 0.02 * 0.02 / (4 * 0.027)).epsilon(1e-12));
  CHECK(tension(l, 1.09 * L0) == doctest::Approx(2730.0 * (0.09 - 0.027)).epsilon(1e-12));
  // In the linear region dF/dL = k/L₀.
  CHECK(tension_by_length(l, 1.09 * L0) == doctest::Approx(2730.0 / L0).epsilon(1e-12));
}

TEST_CASE("tension is the energy's slope and its stiffness the tension's, in every region [derivative]") {
  test::Draw draw(32);
  const Ligament l = general_ligament(0.0, near_knee(draw));
  for (const double strain : {-0.04, 0.013, 0.041, 0.0535, 0.0545, 0.11}) {
    const double L = l.slack_length * (1.0 + strain), h = 1e-6;
    // Central differences: truncation h²·k/(L₀³ε₀)/6 ~ 1e-12·1e8, rounding 1e-16·10/1e-6.
    CHECK(std::abs((energy(l, L + h) - energy(l, L - h)) / (2 * h) - tension(l, L)) < 1e-4);
    CHECK(std::abs((tension(l, L + h) - tension(l, L - h)) / (2 * h) - tension_by_length(l, L)) <
          1e-3 * l.stiffness / l.slack_length * 1e-3 + 1e-3);
  }
  CHECK(tension(l, l.slack_length * (1 + 0.054 - 1e-12)) ==
        doctest::Approx(tension(l, l.slack_length * (1 + 0.054 + 1e-12))).epsilon(1e-9));
}

TEST_CASE("the reference strain is met at the reference pose [property]") {
  test::Draw draw(33);
  const Pose pose = near_knee(draw);
  for (const double strain : {-0.24, 0.03, 0.08}) {
    const Ligament l = general_ligament(strain, pose);
    CHECK(length(l, pose) / l.slack_length - 1.0 == doctest::Approx(strain).epsilon(1e-12));
  }
}

TEST_CASE("the wrench is minus the energy's gradient, the stiffness the wrench's derivative [derivative]") {
  test::Draw draw(34);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose pose = near_knee(draw);
    const Ligament l = general_ligament(draw(0.01, 0.12), pose);
    const Vector6 Q = generalised_force(pose, ligament_wrench(l, pose));
    const Matrix6 S = ligament_stiffness(l, pose);
    CHECK(Q.norm() > 1.0);
    CHECK(S.norm() > 100.0);
    const double h = 1e-6;
    for (int j = 0; j < 6; ++j) {
      Pose ahead = pose, behind = pose;
      ahead[j] += h;
      behind[j] -= h;
      const double slope =
          (energy(l, length(l, ahead)) - energy(l, length(l, behind))) / (2 * h);
      // Rounding eps·U/h ~ 1e-16·10/1e-6 = 1e-9; truncation h²·Q'' ~ 1e-12·1e8.
      CHECK(std::abs(Q[j] + slope) < 2e-4);
      const Wrench difference = (ligament_wrench(l, ahead) - ligament_wrench(l, behind)) / (2 * h);
      CHECK((difference - S.col(j)).norm() < 1e-5 * S.norm());
    }
    const Matrix6 K = generalised_stiffness(pose, ligament_wrench(l, pose), S);
    CHECK((K - K.transpose()).norm() < 1e-12 * K.norm());
  }
}

TEST_CASE("the force pulls the attachments together, along the line [property]") {
  test::Draw draw(35);
  const Pose pose = near_knee(draw);
  const Ligament l = general_ligament(0.05, pose);
  const Wrench w = ligament_wrench(l, pose);
  const Vector3 A = transform_TF(pose) * l.p_FoA_F;
  const Vector3 u = (l.p_ToB_T - A).normalized();
  CHECK((w.head<3>() - tension(l, length(l, pose)) * u).norm() < 1e-10);
  const Vector3 moment = (A - pose.head<3>()).cross(Vector3(w.head<3>()));
  CHECK((moment - w.tail<3>()).norm() < 1e-12);
}

TEST_CASE("default ligaments of a left knee mirror those of a right one [property]") {
  Pose pose;
  pose << 0.0013, 0.0421, 0.0007, 0.011, -0.013, -0.09;
  Pose mirrored = pose;
  for (const int i : {kZ, kThetaX, kThetaY}) mirrored[i] = -pose[i];
  const auto right = default_ligaments(SideOfBody::kRight, pose);
  const auto left = default_ligaments(SideOfBody::kLeft, mirrored);
  REQUIRE(right.size() == 8);
  REQUIRE(left.size() == 8);
  Pose flexed = pose, flexed_mirrored = mirrored;
  flexed[kThetaZ] = flexed_mirrored[kThetaZ] = -0.7;
  double total = 0.0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    require_valid(right[i]);
    CHECK(right[i].slack_length == doctest::Approx(left[i].slack_length).epsilon(1e-14));
    const Wrench a = ligament_wrench(right[i], flexed), b = ligament_wrench(left[i], flexed_mirrored);
    Wrench expected = a;
    for (const int k : {2, 3, 4}) expected[k] = -a[k];
    CHECK((b - expected).norm() < 1e-10 * (1.0 + a.norm()));
    total += a.norm();
    if (right[i].name.starts_with("mcl")) {
      CHECK(right[i].p_FoA_F.z() < 0.0);
      CHECK(left[i].p_FoA_F.z() > 0.0);
    }
  }
  CHECK(total > 10.0);
}

TEST_CASE("a ligament that cannot be is refused, naming it and the field [error]") {
  Ligament l = general_ligament(0.03, Pose::Zero());
  l.slack_length = -0.02;
  CHECK_THROWS_WITH_AS(
      require_valid(l),
      "ligament 'general': slack_length is -0.020000: must be above 0 and below 1 [m]",
      std::invalid_argument);
  l = general_ligament(0.03, Pose::Zero());
  l.stiffness = NAN;
  CHECK_THROWS_WITH_AS(require_valid(l),
                       "ligament 'general': stiffness is nan: must be finite and at least 0 "
                       "[N per unit strain]",
                       std::invalid_argument);
}
