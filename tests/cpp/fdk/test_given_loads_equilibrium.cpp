// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads_equilibrium.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "fdk/given_loads_fixture.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

Pose loaded_pose(test::Draw& draw, double flexion) {
  Pose pose;
  pose << draw(0.0, 0.008), draw(0.0410, 0.0416), draw(-0.002, 0.002), draw(-0.01, 0.01),
      draw(-0.1, 0.1), -flexion;
  return pose;
}

}  // namespace

TEST_CASE("the Jacobian is the residual's derivative, muscles' answer included [derivative]") {
  const test::AnalyticContact contact;
  test::Draw draw(81);
  for (const double exponent : {2.0, 3.0}) {
    for (const bool flexion_positive : {true, false}) {
      GivenLoadsSetup setup = test::leg_setup();
      setup.knee_counts_flexion = flexion_positive;
      recruitment::RecruitmentSettings settings;
      settings.criterion.exponent = exponent;
      recruitment::RecruitmentSolver solver(setup.muscles, settings);
      GivenLoadsFrame frame = test::leg_frame();
      if (!flexion_positive) {
        frame.loads[1] = -frame.loads[1];
        frame.moment_arms.row(1) = -frame.moment_arms.row(1).eval();
      }
      test::let_arms_move(frame, draw);
      frame.strengths *= 10.0;  // away from equilibrium contact asks for more than a leg has
      setup.restraint = RestraintSprings{.ie_gap = 0.01, .ml_stiffness = 430.0, .reference_x = 0.001};
      frame.wrench << 31.0, -170.0, 23.0, 2.3, -1.7, 3.1;
      const Pose pose = loaded_pose(draw, frame.flexion);
      GivenLoadsEquilibrium problem(contact, setup, solver, frame);
      const numerics::Unknowns alpha = problem.unknowns(pose);
      CHECK((problem.pose(alpha) - pose).norm() == 0.0);
      numerics::Unknowns r(5), ahead(5), behind(5);
      numerics::Jacobian J(5, 5), difference(5, 5);
      problem.residual_and_jacobian(alpha, r, J);
      REQUIRE(problem.muscles().converged());
      const double h = 1e-7;
      for (int j = 0; j < 5; ++j) {
        numerics::Unknowns moved = alpha;
        moved[j] += h;
        problem.residual(moved, ahead);
        moved[j] -= 2 * h;
        problem.residual(moved, behind);
        difference.col(j) = (ahead - behind) / (2 * h);
        // Rounding eps·1e4 N/h ~ 1e-5, and forces known to 1e-9 of the loads: 1e-9·1e3 N/h ~ 1e1 at worst of columns
        // of 1e6 N/m; truncation h·(curvature of dⁿ near touch) ~ 1e-6 of the column.
        CHECK((difference.col(j) - J.col(j)).norm() < 2e-5 * J.col(j).norm() + 1e-2);
      }
      // The muscles' part is seen: without it J would be off by far more than that.
      GivenLoadsSetup apart = setup;
      apart.knee_coordinate = -1;
      GivenLoadsEquilibrium other(contact, apart, solver, frame);
      numerics::Jacobian without(5, 5);
      other.residual_and_jacobian(alpha, r, without);
      CHECK((without - J).norm() > 1e-2 * J.norm());
    }
  }
}

TEST_CASE("one muscle, no contact: the residual has a closed form [oracle]") {
  const test::AnalyticContact contact;
  GivenLoadsSetup setup;
  setup.muscles.coordinates = setup.muscles.muscles = 1;
  setup.knee_coordinate = 0;
  recruitment::RecruitmentSolver solver(setup.muscles, {});
  GivenLoadsFrame frame;
  frame.flexion = 0.31;
  frame.loads = recruitment::Vector::Constant(1, -17.0);
  frame.moment_arms = recruitment::RowMatrix::Constant(1, 1, -0.043);
  frame.secondary_arms.resize(5, 1);
  frame.secondary_arms << -0.23, -0.96, 0.07, -0.0031, 0.0022;
  frame.secondary_loads << 19.0, 480.0, -13.0, 7.0, 1.1;
  frame.strengths = recruitment::Vector::Constant(1, 2900.0);
  Pose pose;
  pose << 0.003, 0.09, -0.002, 0.04, -0.07, -0.31;  // 5 cm above the insert
  GivenLoadsEquilibrium problem(contact, setup, solver, frame);
  numerics::Unknowns r(5);
  problem.residual(problem.unknowns(pose), r);
  const double f = 17.0 / 0.043;
  const Secondary expected = frame.secondary_arms.col(0) * f - frame.secondary_loads;
  // Recruitment is exact to 1e-9 of the load.
  CHECK((r - expected).norm() < 1e-7 * expected.norm());

  // A wrench instead: what acts on α is its generalised force.
  frame.wrench << 19.0, 480.0, -13.0, -9.0, 6.0, 2.0;
  frame.secondary_loads.setZero();
  problem.residual(problem.unknowns(pose), r);
  const Vector6 Q = generalised_force(pose, frame.wrench);
  CHECK((r - (frame.secondary_arms.col(0) * f - Q.head<5>())).norm() < 1e-7 * expected.norm());
}

TEST_CASE("what contact and ligaments give about flexion is taken off the muscles [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  recruitment::RecruitmentSolver solver(setup.muscles, {});
  GivenLoadsFrame frame = test::leg_frame();
  frame.strengths *= 10.0;  // as above
  test::Draw draw(83);
  const Pose pose = loaded_pose(draw, frame.flexion);
  GivenLoadsEquilibrium problem(contact, setup, solver, frame);
  numerics::Unknowns r(5);
  problem.residual(problem.unknowns(pose), r);
  REQUIRE(problem.muscles().converged());
  Wrench w = contact.evaluate(pose, contact::Derivatives::kNone).total_wrench();
  for (const auto& ligament : setup.ligaments) w += model::ligament_wrench(ligament, pose);
  const Vector6 Q = generalised_force(pose, w);
  CHECK(std::abs(Q[kThetaZ]) > 1.0);
  recruitment::Vector needed = frame.loads;
  needed[1] += Q[kThetaZ];  // flexion is −θz
  const auto& f = problem.muscles().forces;
  CHECK((frame.moment_arms * f - needed).norm() < 1e-7 * needed.norm());
  CHECK((r - (Q.head<5>() + frame.secondary_arms * f - frame.secondary_loads)).norm() < 1e-9 * Q.norm());
}

TEST_CASE("restraint springs add their force and nothing else [oracle]") {
  const test::AnalyticContact contact;
  GivenLoadsSetup setup = test::leg_setup();
  recruitment::RecruitmentSolver solver(setup.muscles, {});
  GivenLoadsFrame frame = test::leg_frame();
  frame.strengths *= 10.0;  // as above
  test::Draw draw(87);
  const Pose pose = loaded_pose(draw, frame.flexion);
  numerics::Unknowns without(5), with(5);
  GivenLoadsEquilibrium(contact, setup, solver, frame).residual(pose.head<5>(), without);
  setup.restraint = RestraintSprings{.reference_x = 0.0011, .reference_theta_y = 0.02};
  GivenLoadsEquilibrium(contact, setup, solver, frame).residual(pose.head<5>(), with);
  Secondary springs = Secondary::Zero();
  springs[kX] = -30e3 * (pose[kX] - 0.0011);
  springs[kThetaY] = -34.377 * (pose[kThetaY] - 0.02);
  // Muscles twice from different warm starts: 1e-9 of 1e4 N.
  CHECK((with - without - springs).norm() < 1e-5);
  CHECK(springs.norm() > 1.0);
}
