// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/knee_equilibrium.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "fdk/analytic_contact.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::fdk;

TEST_CASE("the Jacobian is the residual's derivative in a general pose [derivative]") {
  const test::AnalyticContact model;
  test::Draw draw(51);
  constexpr std::array<int, 5> kFree{kX, kY, kZ, kThetaX, kThetaY};
  for (int trial = 0; trial < 10; ++trial) {
    Pose pose;
    pose << draw(0.0, 0.008), draw(0.0410, 0.0416), draw(-0.002, 0.002), draw(-0.01, 0.01),
        draw(-0.1, 0.1), draw(-0.6, -0.1);
    Pose reference = pose;
    reference[kThetaZ] = -0.02;
    KneeSetup setup{model, 0.0049, {}, model::default_ligaments(SideOfBody::kRight, reference)};
    setup.restraint.reference_x = 0.0031;
    setup.restraint.ml_stiffness = 430.0;
    KneeEquilibrium problem(setup, {1930.0, -170.0, 3.9}, pose, kFree);
    const numerics::Unknowns alpha = problem.unknowns(pose);
    numerics::Unknowns r(5), ahead(5), behind(5);
    numerics::Jacobian J(5, 5), difference(5, 5);
    problem.residual_and_jacobian(alpha, r, J);
    const double h = 1e-7;
    for (int j = 0; j < 5; ++j) {
      numerics::Unknowns moved = alpha;
      moved[j] += h;
      problem.residual(moved, ahead);
      moved[j] -= 2 * h;
      problem.residual(moved, behind);
      difference.col(j) = (ahead - behind) / (2 * h);
      // Rounding eps·1e4 N/h ~ 1e-5; truncation h·(curvature of dⁿ near touch) ~ 1e-6 of the column.
      CHECK((difference.col(j) - J.col(j)).norm() < 1e-5 * J.col(j).norm() + 1e-3);
    }
    CHECK(J.norm() > 1e4);
    CHECK((J - difference).norm() > 0.0);
    CHECK((problem.pose(alpha) - pose).norm() == 0.0);
  }
}

TEST_CASE("springs alone: equilibrium has a closed form [oracle]") {
  // Far above the insert: no contact. AP force against the AP spring, torque against the IE spring.
  const test::AnalyticContact model;
  KneeSetup setup{model, 0.0, {}, {}};
  setup.restraint.reference_x = 0.0017;
  setup.restraint.reference_theta_y = -0.031;
  Pose pose = Pose::Zero();
  pose[kY] = 0.06;
  pose[kThetaZ] = -0.4;
  constexpr std::array<int, 2> kFree{kX, kThetaY};
  KneeEquilibrium problem(setup, {0.0, 84.0, 2.6}, pose, kFree);
  numerics::NewtonSettings settings;
  settings.force_tolerance = settings.moment_tolerance = 1e-9;
  const auto result = solve_newton(problem, problem.unknowns(pose), settings);
  REQUIRE(result.converged());
  const Pose found = problem.pose(result.alpha);
  // 84 N anterior on the tibia push the femur back by 84/30e3 m; θx = 0, so Q_θy = −My = T (right knee).
  CHECK(found[kX] == doctest::Approx(0.0017 - 84.0 / 30e3).epsilon(1e-9));
  CHECK(found[kThetaY] == doctest::Approx(-0.031 + 2.6 / 34.377).epsilon(1e-9));
}
