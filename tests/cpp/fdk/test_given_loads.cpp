// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "fdk/given_loads_fixture.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// r = contact + ligaments + muscles − given, from the public pieces; the balanced coordinates likewise.
void check_equilibrium(const contact::ContactModel& contact, const GivenLoadsSetup& setup,
                       const GivenLoadsFrame& frame, const GivenLoadsResult& result) {
  CHECK(result.pose[kThetaZ] == -frame.flexion);
  Wrench w = contact.evaluate(result.pose, contact::Derivatives::kNone).total_wrench();
  for (std::size_t i = 0; i < setup.ligaments.size(); ++i) {
    const model::Ligament& ligament = setup.ligaments[i];
    w += model::ligament_wrench(ligament, result.pose);
    CHECK(result.ligament_tensions[i] == tension(ligament, length(ligament, result.pose)));
  }
  const Vector6 Q = generalised_force(result.pose, w);
  const Secondary r = Q.head<5>() + frame.secondary_arms * result.muscle_forces -
                      frame.secondary_loads -
                      generalised_force(result.pose, frame.wrench).head<5>();
  CHECK(r.head<3>().cwiseAbs().maxCoeff() <= 0.01 + 1e-6);
  CHECK(r.tail<2>().cwiseAbs().maxCoeff() <= 5e-4 + 1e-6);
  // Computed twice from the same pose, muscles from other warm starts: 1e-9 of 1e3 N.
  CHECK((r - result.residual).norm() < 1e-6);
  recruitment::Vector needed = frame.loads;
  if (setup.knee_coordinate >= 0) needed[setup.knee_coordinate] -= setup.knee_sign() * Q[kThetaZ];
  CHECK((frame.moment_arms * result.muscle_forces + result.reserves - needed).norm() < 1e-6);
  CHECK(result.muscle_forces.minCoeff() >= 0.0);
  CHECK((result.muscle_forces - frame.strengths).maxCoeff() <= 0.0);
}

}  // namespace

TEST_CASE("every time frame of a stance is in equilibrium, quickly [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  const auto frames = test::leg_stance(31);
  const auto simulation = solve_given_loads(contact, setup, frames);
  INFO(summary(simulation));
  REQUIRE(simulation.converged());
  CHECK(summary(simulation) == "31 of 31 time frames converged");
  long evaluations = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    INFO("time frame " << i);
    check_equilibrium(contact, setup, frames[i], simulation.frames[i]);
    evaluations += simulation.frames[i].evaluations;
    CHECK(simulation.frames[i].message == "");
  }
  // Newton from a warm start takes 4 to 8 steps.
  MESSAGE("evaluations a time frame: " << double(evaluations) / 31.0);
  CHECK(evaluations < 31 * 12);
}

TEST_CASE("few time frames far apart need continuation, and reach the same equilibria [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  const auto dense = test::leg_stance(31), sparse = test::leg_stance(4);
  const auto a = solve_given_loads(contact, setup, dense);
  const auto b = solve_given_loads(contact, setup, sparse);
  REQUIRE(a.converged());
  REQUIRE(b.converged());
  for (std::size_t i = 0; i < 4; ++i) {
    check_equilibrium(contact, setup, sparse[i], b.frames[i]);
    // Tolerances of 0.01 N and 5e-4 Nm over the softest stiffness, some 1e3 N/m and 10 Nm/rad.
    CHECK((a.frames[10 * i].pose - b.frames[i].pose).norm() < 2e-4);
  }
}

TEST_CASE("five starts, one equilibrium [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  const std::vector<GivenLoadsFrame> frames{test::leg_frame()};
  const Pose first = solve_given_loads(contact, setup, frames).frames[0].pose;
  test::Draw draw(91);
  for (int k = 0; k < 5; ++k) {
    GivenLoadsSettings settings;
    settings.initial_pose = first;
    for (int i = 0; i < 3; ++i) (*settings.initial_pose)[i] += draw(-3e-3, 3e-3);
    for (int i = 3; i < 5; ++i) (*settings.initial_pose)[i] += draw(-0.05, 0.05);
    const auto again = solve_given_loads(contact, setup, frames, settings);
    REQUIRE(again.converged());
    CHECK((again.frames[0].pose - first).norm() < 2e-4);  // as above
  }
}

TEST_CASE("muscles that pull straight down add their force to the compression, no more and no less [oracle]") {
  const test::AnalyticContact contact;
  GivenLoadsSetup setup = test::leg_setup();
  setup.ligaments.clear();
  GivenLoadsFrame frame = test::leg_frame();
  frame.secondary_arms.setZero();
  frame.secondary_loads << 0.0, 540.0, 0.0, -3.0, 0.0;
  const auto compression = [&](double down) {
    frame.secondary_arms.row(1).head(3).setConstant(-down);
    const auto simulation = solve_given_loads(contact, setup, std::span(&frame, 1));
    INFO(summary(simulation));
    REQUIRE(simulation.converged());
    const GivenLoadsResult& r = simulation.frames[0];
    check_equilibrium(contact, setup, frame, r);
    const double knee = r.muscle_forces.head(3).sum();
    CHECK(knee > 100.0);
    CHECK(r.loads.total_wrench()[1] == doctest::Approx(540.0 + down * knee).epsilon(0.011 / 540.0));
    // The adduction moment alone splits it: Qθx = −Mx.
    CHECK(std::abs(r.loads.total_wrench()[3] - 3.0) < 6e-4);
    return r.loads.total_wrench()[1];
  };
  const double none = compression(0.0);
  CHECK(none == doctest::Approx(540.0).epsilon(0.011 / 540.0));
  CHECK(compression(0.95) > none + 100.0);
}

TEST_CASE("a wrench says the same as its generalised forces at the pose found [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  GivenLoadsFrame frame = test::leg_frame();
  frame.secondary_loads.setZero();
  frame.wrench << 23.0, 540.0, 11.0, 11.0, -2.0, 4.0;
  const auto a = solve_given_loads(contact, setup, std::span(&frame, 1));
  REQUIRE(a.converged());
  check_equilibrium(contact, setup, frame, a.frames[0]);
  frame.secondary_loads = generalised_force(a.frames[0].pose, frame.wrench).head<5>();
  frame.wrench.setZero();
  const auto b = solve_given_loads(contact, setup, std::span(&frame, 1));
  REQUIRE(b.converged());
  CHECK((a.frames[0].pose - b.frames[0].pose).norm() < 2e-4);  // as above
}

TEST_CASE("arms that move with the pose: equilibrium with the arms there [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  GivenLoadsFrame frame = test::leg_frame();
  test::Draw draw(97);
  test::let_arms_move(frame, draw);
  const auto simulation = solve_given_loads(contact, setup, std::span(&frame, 1));
  INFO(summary(simulation));
  REQUIRE(simulation.converged());
  GivenLoadsFrame there = frame;
  for (int j = 0; j < 5; ++j) {
    const double moved = simulation.frames[0].pose[j] - frame.arms_at[j];
    there.moment_arms += moved * frame.arms_by_pose.middleRows(8 * j, 3);
    there.secondary_arms += moved * frame.arms_by_pose.middleRows(8 * j + 3, 5);
  }
  CHECK((there.secondary_arms - frame.secondary_arms).norm() > 1e-4);
  check_equilibrium(contact, setup, there, simulation.frames[0]);
}

TEST_CASE("the same bytes twice, and the medial side carries the adduction [property]") {
  const test::AnalyticContact contact;
  const GivenLoadsSetup setup = test::leg_setup();
  const auto frames = test::leg_stance(9);
  const auto a = solve_given_loads(contact, setup, frames);
  const auto b = solve_given_loads(contact, setup, frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    CHECK((a.frames[i].pose.array() == b.frames[i].pose.array()).all());
    CHECK((a.frames[i].muscle_forces.array() == b.frames[i].muscle_forces.array()).all());
  }
  const auto& loads = a.frames[4].loads;
  CHECK(loads.wrench[kMedial][1] > loads.wrench[kLateral][1] + 100.0);
}

TEST_CASE("loads beyond the muscles are infeasible by name; the other time frames are kept") {
  const test::AnalyticContact contact;
  GivenLoadsSetup setup = test::leg_setup();
  auto frames = test::leg_stance(9);
  frames[4].loads[2] = -900.0;  // ankle: 1800·0.044 + 3600·0.041 = 227 Nm is all there is
  const auto simulation = solve_given_loads(contact, setup, frames);
  CHECK_FALSE(simulation.converged());
  CHECK(simulation.infeasible == 1);
  CHECK(simulation.frames[4].status == GivenLoadsStatus::kInfeasible);
  CHECK(simulation.frames[4].message.find("ankle") != std::string::npos);
  CHECK(summary(simulation).find("8 of 9 time frames converged, 1 asked too much of the muscles; "
                                 "the first not: time frame 4") == 0);
  CHECK(simulation.frames[5].status == GivenLoadsStatus::kConverged);
  CHECK(std::abs(simulation.frames[4].unmet[2]) > 100.0);

  setup.muscles.reserve_strengths = recruitment::Vector::Constant(3, 1.0);
  const auto helped = solve_given_loads(contact, setup, frames);
  CHECK(helped.infeasible == 0);
  CHECK(std::abs(helped.frames[4].reserves[2]) > 100.0);
}

TEST_CASE("a knee pulled apart does not converge, and says so") {
  const test::AnalyticContact contact;
  GivenLoadsSetup setup = test::leg_setup();
  setup.ligaments.clear();
  GivenLoadsFrame frame = test::leg_frame();
  frame.secondary_loads[1] = -2000.0;
  GivenLoadsSettings settings;
  settings.max_substeps = 4;
  const auto simulation = solve_given_loads(contact, setup, std::span(&frame, 1), settings);
  CHECK(simulation.not_converged == 1);
  CHECK(simulation.frames[0].status == GivenLoadsStatus::kNotConverged);
  CHECK(simulation.frames[0].message.find("residual") == 0);
  CHECK(summary(simulation).find("0 of 1 time frames converged; the first not: time frame 0, residual") == 0);
}

TEST_CASE("wrong side, nothing given, impossible settings: refused") {
  test::KneeShape shape;
  shape.side_of_body = SideOfBody::kLeft;
  const test::AnalyticContact left(shape), right;
  const GivenLoadsSetup setup = test::leg_setup();
  const GivenLoadsFrame frame = test::leg_frame();
  CHECK_THROWS_WITH_AS(solve_given_loads(left, setup, std::span(&frame, 1)),
                       doctest::Contains("of a left knee, the loads are of a right one"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(solve_given_loads(right, setup, {}), "given loads: there are no time frames",
                       std::invalid_argument);
  GivenLoadsSettings settings;
  settings.max_substeps = 0;
  CHECK_THROWS_WITH_AS(solve_given_loads(right, setup, std::span(&frame, 1), settings),
                       doctest::Contains("max_substeps is 0"), std::invalid_argument);
  auto frames = test::leg_stance(3);
  frames[2].minima = 0.1 * frames[2].strengths;
  CHECK_THROWS_WITH_AS(solve_given_loads(right, setup, frames),
                       doctest::Contains("time frame 2: minima and arms_by_pose must be given"),
                       std::invalid_argument);
}
