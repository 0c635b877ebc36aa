// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/static_equilibrium.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "fdk/analytic_contact.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// A load in the range of a gait sample, in a general pose.
StaticLoad general_load(test::Draw& draw) {
  StaticLoad load;
  load.x = draw(-0.006, 0.009);
  load.z = draw(-0.003, 0.003);
  load.theta_y = draw(-0.15, 0.15);
  load.theta_z = draw(-1.4, 0.05);
  load.Fy = draw(20.0, 3200.0);
  load.Mx = draw(-0.021, 0.021) * load.Fy;
  return load;
}

bool meets(const StaticEquilibrium& e, const StaticLoad& load) {
  const Wrench w = e.loads.total_wrench();
  const bool Mx_met =
      load.theta_x || std::abs(w[3] - load.Mx) <= 1e-3 * std::abs(load.Mx) + 5e-4;
  return std::abs(w[1] - load.Fy) <= 1e-3 * load.Fy + 0.01 && Mx_met;
}

}  // namespace

TEST_CASE("the test's contact model is the gradient of its energy [derivative]") {
  const test::AnalyticContact model;
  test::Draw draw(21);
  for (int trial = 0; trial < 20; ++trial) {
    Pose pose;
    pose << draw(-0.005, 0.005), draw(0.0412, 0.0418), draw(-0.003, 0.003), draw(-0.03, 0.03),
        draw(-0.1, 0.1), draw(-0.5, 0.1);
    const auto loads = model.evaluate(pose, contact::Derivatives::kStiffness);
    const Vector6 Q = generalised_force(pose, loads.total_wrench());
    for (int j = 0; j < 6; ++j) {
      // Truncation h²·U''' ~ 1e-12·1e12·1e-? and rounding eps·U/h ~ 1e-16·2/1e-6: both far below 1e-3 N.
      const double h = 1e-6;
      Pose ahead = pose, behind = pose;
      ahead[j] += h;
      behind[j] -= h;
      const double slope = (model.energy(ahead) - model.energy(behind)) / (2.0 * h);
      CHECK(std::abs(Q[j] + slope) < 1e-5 * Q.norm() + 1e-6);
      const Wrench change = (model.evaluate(ahead, contact::Derivatives::kNone).total_wrench() -
                             model.evaluate(behind, contact::Derivatives::kNone).total_wrench()) /
                            (2.0 * h);
      const Wrench column = loads.total_stiffness().col(j);
      CHECK((change - column).norm() < 1e-4 * column.norm() + 1e-3);
    }
  }
}

TEST_CASE("a prescribed load is carried, in at most 8 evaluations from cold [property]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSolver solver(model);
  test::Draw draw(22);
  long evaluations = 0;
  int worst = 0;
  const int count = 400;
  for (int trial = 0; trial < count; ++trial) {
    const StaticLoad load = general_load(draw);
    const StaticEquilibrium e = solver.solve(load);
    INFO("trial " << trial << " Fy " << load.Fy << " Mx " << load.Mx << " status " << name(e.status)
                  << " evaluations " << e.evaluations);
    REQUIRE(e.status == EquilibriumStatus::kConverged);
    // Recomputed from the model at the pose, not read from the result.
    StaticEquilibrium again = e;
    again.loads = model.evaluate(e.pose, contact::Derivatives::kNone);
    CHECK(meets(again, load));
    CHECK(e.pose[kX] == load.x);
    CHECK(e.pose[kThetaZ] == load.theta_z);
    evaluations += e.evaluations;
    worst = std::max(worst, e.evaluations);
  }
  MESSAGE("evaluations a sample: mean " << double(evaluations) / count << ", worst " << worst
                                        << "; map " << solver.map_evaluations());
  CHECK(double(evaluations) / count <= 8.0);
}

TEST_CASE("one sphere a side: depth and tilt have a closed form [oracle]") {
  test::KneeShape shape;
  shape.spheres = 1;
  shape.coronal_radius = 1e9;  // flat across: no z-force
  const test::AnalyticContact model(shape);
  const StaticEquilibriumSolver solver(model);
  StaticLoad load;
  load.x = shape.centre_x * -1.0;  // spheres above the dish's lowest line: no x-force
  load.Fy = 871.0;
  load.Mx = 6.3;
  const StaticEquilibrium e = solver.solve(load);
  REQUIRE(e.status == EquilibriumStatus::kConverged);
  // Moments about Fo, small tilt: Mx = −Σ z F (right knee: medial z < 0), so F_m − F_l = 2 Mx / spacing.
  const double F_m = 0.5 * (load.Fy + 2.0 * load.Mx / shape.spacing);
  const double F_l = load.Fy - F_m;
  const double d_m = std::pow(F_m / shape.stiffness, 1.0 / shape.exponent);
  const double d_l = std::pow(F_l / shape.stiffness, 1.0 / shape.exponent);
  const double y = shape.dish_height + shape.radius - shape.centre_y - 0.5 * (d_m + d_l);
  // Tolerances: 0.1 % of load over a power law, and terms of second order in the tilt (1e-3).
  CHECK(std::abs(e.pose[kY] - y) < 1e-3 * (d_m + d_l) + 1e-6 * shape.spacing);
  const double tilt = (d_m - d_l) / shape.spacing;
  CHECK(std::abs(std::abs(e.pose[kThetaX]) - tilt) < 0.01 * tilt + 2e-3 * (d_m + d_l) / shape.spacing);
  CHECK(e.loads.wrench[kMedial][1] == doctest::Approx(F_m).epsilon(5e-3));
}

TEST_CASE("with θx given, only Fy is met, single-sided or not [property]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSolver solver(model);
  test::Draw draw(23);
  int single = 0;
  long evaluations = 0;
  for (int trial = 0; trial < 200; ++trial) {
    StaticLoad load = general_load(draw);
    load.Fy = draw(0.5, 100.0);
    load.Mx = NAN;  // not used
    load.theta_x = draw(-0.12, 0.12);
    const StaticEquilibrium e = solver.solve(load);
    REQUIRE(e.status == EquilibriumStatus::kConverged);
    CHECK(meets(e, load));
    CHECK(e.pose[kThetaX] == *load.theta_x);
    single += e.loads.wrench[0][1] == 0.0 || e.loads.wrench[1][1] == 0.0;
    evaluations += e.evaluations;
  }
  CHECK(single > 100);
  CHECK(evaluations / 200.0 <= 8.0);
}

TEST_CASE("moments beyond what contact can carry are no equilibrium, those within are found [property]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSolver solver(model);
  // The outermost spheres bound the arm in this pose: spacing/2 + half_width from the middle, plus a little of
  // y·Fz from the dish's coronal slope.
  const double edge = 0.5 * model.shape().spacing + model.shape().half_width;
  test::Draw draw(24);
  int searched = 0;
  for (int trial = 0; trial < 100; ++trial) {
    StaticLoad load;
    load.x = draw(-0.002, 0.008);
    load.theta_z = draw(-1.0, 0.0);
    load.Fy = draw(5.0, 100.0);
    const double direction = trial % 2 == 0 ? 1.0 : -1.0;
    load.Mx = direction * 0.93 * edge * load.Fy;
    const StaticEquilibrium within = solver.solve(load);
    INFO("trial " << trial << " " << name(within.status) << " after " << within.evaluations);
    CHECK(within.status == EquilibriumStatus::kConverged);
    CHECK(meets(within, load));
    load.Mx = direction * 1.17 * edge * load.Fy;
    const StaticEquilibrium beyond = solver.solve(load);
    CHECK(beyond.status == EquilibriumStatus::kNoEquilibrium);
    searched += beyond.searched;
    load.Mx = direction * 2.0 * edge * load.Fy;
    CHECK(solver.solve(load).evaluations == 0);
  }
  CHECK(searched == 100);
}

TEST_CASE("a mirrored knee has the mirrored equilibrium [property]") {
  const test::AnalyticContact right;
  test::KneeShape shape;
  shape.side_of_body = SideOfBody::kLeft;
  const test::AnalyticContact left(shape);
  const StaticEquilibriumSolver solver_right(right), solver_left(left);
  test::Draw draw(25);
  for (int trial = 0; trial < 30; ++trial) {
    const StaticLoad load = general_load(draw);
    StaticLoad mirrored = load;
    mirrored.z = -load.z;
    mirrored.theta_y = -load.theta_y;
    mirrored.Mx = -load.Mx;
    const Pose a = solver_right.solve(load).pose, b = solver_left.solve(mirrored).pose;
    CHECK(std::abs(a[kY] - b[kY]) < 1e-12);
    CHECK(std::abs(a[kThetaX] + b[kThetaX]) < 1e-10);
  }
}

TEST_CASE("a batch is the same bytes for any number of threads and any split [property]") {
  const test::AnalyticContact model;
  test::Draw draw(26);
  std::vector<StaticLoad> loads(60);
  for (StaticLoad& load : loads) load = general_load(draw);
  const auto whole = StaticEquilibriumSolver(model).solve_batch(loads, 1);
  const auto threaded = StaticEquilibriumSolver(model).solve_batch(loads, 3);
  const auto tail =
      StaticEquilibriumSolver(model).solve_batch(std::span(loads).subspan(41), 2);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    CHECK(std::memcmp(whole[i].pose.data(), threaded[i].pose.data(), sizeof(Pose)) == 0);
    CHECK(whole[i].evaluations == threaded[i].evaluations);
    if (i >= 41) {
      CHECK(std::memcmp(whole[i].pose.data(), tail[i - 41].pose.data(), sizeof(Pose)) == 0);
    }
  }
}

TEST_CASE("what cannot be solved ends in the status that says why [error]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSolver solver(model);
  StaticLoad load;
  load.theta_z = -0.3;
  load.Fy = -50.0;
  CHECK(solver.solve(load).status == EquilibriumStatus::kNoEquilibrium);
  load.Fy = 4e5;
  CHECK(solver.solve(load).status == EquilibriumStatus::kOverclosure);
  load.Fy = 300.0;
  load.x = 0.055;
  CHECK(solver.solve(load).status == EquilibriumStatus::kOffInsert);
  CHECK(std::string(advice(EquilibriumStatus::kOffInsert)).find("y_low") != std::string::npos);
}

TEST_CASE("a load that is not finite is refused, naming row and field [error]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSolver solver(model);
  std::vector<StaticLoad> loads(3);
  for (StaticLoad& load : loads) load.Fy = 100.0;
  loads[2].theta_y = INFINITY;
  CHECK_THROWS_WITH_AS(solver.solve_batch(loads, 1),
                       "row 2: static load: theta_y is inf: must be finite", std::invalid_argument);
  StaticEquilibriumSettings settings;
  settings.touch.y_high = 0.001;
  CHECK_THROWS_WITH_AS(StaticEquilibriumSolver(model, settings),
                       "touch search: y_high is 0.001000: must be finite and above y_low [m]",
                       std::invalid_argument);
}
