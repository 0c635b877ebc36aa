// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/recruitment.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using condyle::test::settings;

namespace {

constexpr double kMinMax = std::numeric_limits<double>::infinity();

struct Small {
  RecruitmentSetup setup;
  RowMatrix arms;
  Vector loads, strengths, minima;
  Recruitment solve(double p, bool bounds = true) const {
    RecruitmentSolver solver(setup, settings(p, bounds));
    return solver.solve({arms, loads, strengths, minima});
  }
};

Small one_equation() {
  Small s;
  s.setup.coordinates = 1;
  s.setup.muscles = 4;
  s.arms.resize(1, 4);
  s.arms << 0.043, 0.027, 0.061, -0.035;
  s.strengths.resize(4);
  s.strengths << 830.0, 1450.0, 390.0, 900.0;
  s.loads.resize(1);
  s.loads << 19.0;
  return s;
}

}  // namespace

TEST_CASE("one equation: f_i ∝ (r_i N_i^p)^(1/(p−1)) of those that pull [oracle]") {
  const Small s = one_equation();
  for (double p : {1.3, 2.0, 3.0, 5.0, 8.0}) {
    const Recruitment r = s.solve(p, false);
    REQUIRE(r.converged());
    Vector share = Vector::Zero(4);
    for (int i = 0; i < 3; ++i) {
      share[i] = std::pow(s.arms(0, i) * std::pow(s.strengths[i], p), 1.0 / (p - 1.0));
    }
    share *= s.loads[0] / s.arms.row(0).dot(share);
    CAPTURE(p);
    CHECK((r.forces - share).norm() <= 1e-11 * share.norm());
    CHECK(r.forces[3] == 0.0);
  }
}

TEST_CASE("p = 1 takes the best lever first [oracle]") {
  Small s = one_equation();
  Recruitment r = s.solve(1.0);
  REQUIRE(r.converged());
  // r N: 35.7, 39.2, 23.8 Nm a unit of activity.
  CHECK(r.forces[1] == doctest::Approx(19.0 / 0.027).epsilon(1e-13));
  CHECK(r.forces[0] == 0.0);
  s.loads << 50.0;
  r = s.solve(1.0);
  REQUIRE(r.converged());
  CHECK(r.forces[1] == 1450.0);
  CHECK(r.forces[0] == doctest::Approx((50.0 - 0.027 * 1450.0) / 0.043).epsilon(1e-12));
  CHECK(r.multipliers[0] == doctest::Approx(1.0 / (0.043 * 830.0)).epsilon(1e-12));
}

TEST_CASE("min–max: all that pull are equally active [oracle]") {
  const Small s = one_equation();
  const Recruitment r = s.solve(kMinMax);
  REQUIRE(r.converged());
  const double t = 19.0 / (0.043 * 830.0 + 0.027 * 1450.0 + 0.061 * 390.0);
  for (int i = 0; i < 3; ++i) CHECK(r.activities[i] == doctest::Approx(t).epsilon(1e-13));
  CHECK(r.activities[3] == 0.0);
  CHECK(r.objective == doctest::Approx(t).epsilon(1e-13));
}

TEST_CASE("p → ∞ is min–max [property]") {
  const auto problem = random_problem(2, false, false, 4, 15);
  RecruitmentSolver power(problem.setup, settings(12.0)), extreme(problem.setup, settings(kMinMax));
  const double largest = power.solve(problem.frame()).activities.cwiseProduct(problem.setup.weights).maxCoeff();
  const double level = extreme.solve(problem.frame()).objective;
  // Σ w a^p ≤ … within the 15 w's p-th root.
  CHECK(largest >= level * (1.0 - 1e-9));
  CHECK(largest <= level * std::pow(15.0 * 1.7 / 0.6, 1.0 / 12.0));
}

TEST_CASE("identical muscles share equally; a bound that acts is met exactly") {
  Small s = one_equation();
  s.arms << 0.04, 0.04, 0.04, 0.01;
  s.strengths << 500.0, 500.0, 500.0, 1500.0;
  for (double p : {1.5, 2.0, 3.0, 5.0}) {
    s.loads << 40.0;
    Recruitment r = s.solve(p);
    REQUIRE(r.converged());
    CHECK(r.forces[0] == doctest::Approx(r.forces[1]).epsilon(1e-13));
    CHECK(r.forces[0] == doctest::Approx(r.forces[2]).epsilon(1e-13));
    s.loads << 74.0;
    r = s.solve(p);
    REQUIRE(r.converged());
    for (int i = 0; i < 3; ++i) CHECK(r.forces[i] == doctest::Approx(500.0).epsilon(1e-12));
    CHECK(r.forces[3] == doctest::Approx(1400.0).epsilon(1e-11));
    CHECK(s.solve(p, false).forces[0] > 500.0);
  }
}

TEST_CASE("units do not matter: arms in mm, loads in N mm; loads and strengths α times [property]") {
  for (double p : {1.0, 1.5, 2.0, 3.0, 5.0, kMinMax}) {
    auto problem = random_problem(19, false, true);
    RecruitmentSolver solver(problem.setup, settings(p));
    const Vector forces = solver.solve(problem.frame()).forces;
    auto scaled = problem;
    scaled.moment_arms *= 1000.0;
    scaled.loads *= 1000.0;
    CAPTURE(p);
    CHECK((solver.solve(scaled.frame()).forces - forces).norm() <= 1e-9 * forces.norm());
    scaled = problem;
    scaled.loads *= 37.0;
    scaled.strengths *= 37.0;
    scaled.minima *= 37.0;
    CHECK((solver.solve(scaled.frame()).forces - 37.0 * forces).norm() <= 1e-9 * 37.0 * forces.norm());
  }
}

TEST_CASE("the optimality conditions hold, all criteria [property]") {
  for (double p : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, kMinMax}) {
    for (std::uint64_t seed = 0; seed < 25; ++seed) {
      const bool reserves = p <= 3.0 || p == kMinMax ? seed % 2 == 0 : false;
      const auto problem = random_problem(seed, reserves, seed % 3 == 0);
      RecruitmentSolver solver(problem.setup, settings(p, seed % 4 != 0));
      const Recruitment& r = solver.solve(problem.frame());
      CAPTURE(p);
      CAPTURE(seed);
      CHECK(r.converged());
      CHECK(r.kkt.largest() <= 1e-9);
      // Loads of tens of Nm, forces of up to 3 000 N.
      CHECK(r.unmet.cwiseAbs().maxCoeff() <= 1e-9);
      CHECK((problem.loads - problem.moment_arms * r.forces - r.reserves - r.unmet).norm() <= 1e-12);
    }
  }
}

TEST_CASE("multipliers are the objective's derivatives [derivative]") {
  for (double p : {1.0, 1.5, 2.0, 3.0, kMinMax}) {
    auto problem = random_problem(29, true, false);
    RecruitmentSolver solver(problem.setup, settings(p));
    const Vector multipliers = solver.solve(problem.frame()).multipliers;
    for (int j = 0; j < problem.setup.coordinates; j += 3) {
      const double step = 1e-4;  // of some 20 Nm: 1e-9 of curvature, 1e-11 of rounding
      auto moved = problem;
      moved.loads[j] += step;
      const double ahead = solver.solve(moved.frame()).objective;
      moved.loads[j] -= 2.0 * step;
      const double slope = (ahead - solver.solve(moved.frame()).objective) / (2.0 * step);
      CAPTURE(p);
      CHECK(multipliers[j] == doctest::Approx(slope).epsilon(1e-6));
      CHECK(slope != 0.0);
    }
  }
}

TEST_CASE("loads out of reach name their coordinate; a reserve there makes them feasible") {
  for (double p : {1.0, 1.5, 2.0, 3.0, 5.0, kMinMax}) {
    auto problem = random_problem(37, false, false);
    for (int j = 0; j < 7; ++j) problem.setup.coordinate_names.push_back("angle_" + std::to_string(j));
    problem.loads[4] += 500.0;
    RecruitmentSolver solver(problem.setup, settings(p));
    const Recruitment& r = solver.solve(problem.frame());
    CAPTURE(p);
    REQUIRE(r.status == RecruitmentStatus::kInfeasible);
    REQUIRE(!r.unmet_coordinates.empty());
    CHECK(r.unmet_coordinates[0] == 4);
    CHECK(solver.message().find("angle_4 by ") != std::string::npos);
    CHECK(r.unmet[4] > 100.0);
    CHECK(solver.warm_start().empty());
    RowMatrix df(43, 7), de(7, 7);
    CHECK_THROWS_AS(solver.forces_by_loads(df, de), std::logic_error);
    problem.setup.reserve_strengths = Vector::Zero(7);
    problem.setup.reserve_strengths[4] = 20.0;
    RecruitmentSolver helped(problem.setup, settings(p));
    CHECK(helped.solve(problem.frame()).converged());
    CHECK(helped.result().reserves[4] > 100.0);
  }
}

TEST_CASE("a coordinate without muscles: feasible at zero load only") {
  auto problem = random_problem(43, false, false);
  problem.moment_arms.row(3).setZero();
  problem.loads[3] = 0.0;
  for (double p : {1.0, 2.0, 3.0, kMinMax}) {
    RecruitmentSolver solver(problem.setup, settings(p));
    auto here = problem;
    // The other loads were of forces that moved coordinate 3 as well; they can still be carried.
    CHECK(solver.solve(here.frame()).converged());
    here.loads[3] = 0.5;
    REQUIRE(solver.solve(here.frame()).status == RecruitmentStatus::kInfeasible);
    CHECK(solver.result().unmet_coordinates == std::vector<int>{3});
  }
}

TEST_CASE("a muscle of zero strength carries nothing; no load, no force") {
  auto problem = random_problem(47, false, false);
  problem.strengths[10] = 0.0;
  for (double p : {1.0, 1.5, 2.0, 3.0, 5.0, kMinMax}) {
    for (bool bounds : {true, false}) {
      RecruitmentSolver solver(problem.setup, settings(p, bounds));
      CAPTURE(p);
      REQUIRE(solver.solve(problem.frame()).converged());
      CHECK(solver.result().forces[10] == 0.0);
      CHECK(solver.result().activities[10] == 0.0);
      auto idle = problem;
      idle.loads.setZero();
      REQUIRE(solver.solve(idle.frame()).converged());
      CHECK(solver.result().forces.maxCoeff() == 0.0);
    }
  }
}

TEST_CASE("a warm start of another size is refused [error]") {
  const auto problem = random_problem(3, false, false);
  RecruitmentSolver solver(problem.setup, settings(3.0));
  WarmStart warm;
  warm.multipliers = Vector::Zero(5);
  CHECK_THROWS_WITH_AS(solver.solve(problem.frame(), warm),
                       "recruitment: warm start of a problem of another size: must be of 7 coordinates and 43 muscles",
                       std::invalid_argument);
}
