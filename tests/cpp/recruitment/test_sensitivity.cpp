// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/sensitivity.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::Draw;
using condyle::test::random_problem;
using condyle::test::RandomProblem;
using condyle::test::settings;

namespace {

constexpr double kMinMax = std::numeric_limits<double>::infinity();

// A direction in general position, changes of the size of what they change.
struct Direction {
  RowMatrix loads, moment_arms, strengths;
};

Direction random_direction(const RandomProblem& p, std::uint64_t seed) {
  Draw draw(seed);
  Direction d{RowMatrix::Zero(1, p.setup.coordinates), p.moment_arms, RowMatrix::Zero(1, p.setup.muscles)};
  for (int j = 0; j < p.setup.coordinates; ++j) d.loads(0, j) = draw(-20.0, 20.0);
  for (int i = 0; i < p.setup.muscles; ++i) {
    d.strengths(0, i) = p.strengths[i] * draw(-0.7, 0.7);
    for (int j = 0; j < p.setup.coordinates; ++j) {
      if (p.moment_arms(j, i) != 0.0) d.moment_arms(j, i) = draw(-0.04, 0.04);
    }
  }
  return d;
}

Recruitment solve_at(RandomProblem p, RecruitmentSolver& solver, const Direction& d, double length) {
  p.loads += length * d.loads.row(0).transpose();
  p.moment_arms += length * d.moment_arms;
  p.strengths += length * d.strengths.row(0).transpose();
  return solver.solve(p.frame());
}

}  // namespace

TEST_CASE("derivatives along loads, moment arms and strengths against central differences [derivative]") {
  for (double p : {1.0, 1.5, 2.0, 3.0, 4.0, kMinMax}) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const bool minima = seed % 3 == 0, reserves = p != 4.0 && seed % 2 == 0;
      auto problem = random_problem(seed, reserves, minima);
      RecruitmentSolver solver(problem.setup, settings(p, seed % 4 != 1));
      const Direction d = random_direction(problem, 100 + seed);
      CAPTURE(p);
      CAPTURE(seed);
      // Steps of 1e-7 of what changes: second derivatives and rounding (1e-14/1e-7) leave 1e-6; p > 2 bends
      // sharply where a muscle begins to act, and minima hold their force while strengths change.
      const double step = 1e-7;
      const Recruitment ahead = solve_at(problem, solver, d, step);
      const Recruitment behind = solve_at(problem, solver, d, -step);
      REQUIRE(ahead.converged());
      REQUIRE(behind.converged());
      // A kink between them has no derivative to compare with.
      if (ahead.states != behind.states) continue;
      REQUIRE(solver.solve(problem.frame()).converged());
      RowMatrix df(1, problem.setup.muscles), de(1, problem.setup.coordinates);
      solver.forces_along(d.loads, d.moment_arms, d.strengths, df, de);
      const Vector forces = (ahead.forces - behind.forces) / (2.0 * step);
      const Vector helped = (ahead.reserves - behind.reserves) / (2.0 * step);
      CHECK(solver.sensitivity_is_regular());
      CHECK((df.row(0).transpose() - forces).norm() <= 1e-5 * forces.norm());
      CHECK((de.row(0).transpose() - helped).norm() <= 1e-5 * (helped.norm() + 1.0));
      CHECK(forces.norm() > 1.0);
      CHECK(df.row(0).transpose() != forces);
    }
  }
}

TEST_CASE("a load's change is carried: R df/dτ + de/dτ = 1 [property]") {
  for (double p : {1.0, 1.5, 2.0, 3.0, 5.0, kMinMax}) {
    const auto problem = random_problem(77, p != 5.0, false);
    RecruitmentSolver solver(problem.setup, settings(p));
    REQUIRE(solver.solve(problem.frame()).converged());
    const int n = problem.setup.coordinates, m = problem.setup.muscles;
    RowMatrix df(m, n), de(n, n);
    solver.forces_by_loads(df, de);
    const Eigen::MatrixXd carried = problem.moment_arms * df + de;
    CAPTURE(p);
    CHECK((carried - Eigen::MatrixXd::Identity(n, n)).norm() <= 1e-8);
    // The one along a direction is their combination.
    RowMatrix change(1, n), along(1, m), helped(1, n);
    for (int j = 0; j < n; ++j) change(0, j) = 3.0 - j;
    solver.forces_along(change, RowMatrix(0, m), RowMatrix(0, m), along, helped);
    CHECK((along.row(0).transpose() - df * change.row(0).transpose()).norm() <= 1e-9 * along.norm());
  }
}

TEST_CASE("loads that take all there is: every muscle at its strength") {
  RecruitmentSetup setup;
  setup.coordinates = 1;
  setup.muscles = 2;
  RowMatrix R(1, 2);
  R << 0.05, 0.03;
  Vector N(2), loads(1);
  N << 700.0, 400.0;
  loads << 0.05 * 700.0 + 0.03 * 400.0;
  RecruitmentSolver solver(setup, settings(2.0));
  REQUIRE(solver.solve({R, loads, N, Vector()}).converged());
  CHECK(solver.result().forces.isApprox(N, 1e-9));
}
