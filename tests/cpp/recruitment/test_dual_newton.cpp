// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/dual_newton.hpp"

#include <doctest/doctest.h>

#include "condyle/recruitment/kkt.hpp"
#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using condyle::test::settings;
using Outcome = DualNewton::Outcome;

TEST_CASE("the optimality conditions hold to rounding, 1 < p ≤ 3 [property]") {
  for (double p : {1.05, 1.25, 1.5, 2.0, 2.5, 3.0}) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const auto problem = random_problem(seed, seed % 2 == 0, seed % 3 == 0);
      const auto how = settings(p, seed % 4 != 0);
      ScaledProblem s(problem.setup, how);
      s.set_frame(problem.frame(), how.upper_bounds);
      DualNewton newton(s.n, s.m, p);
      CAPTURE(p);
      CAPTURE(seed);
      REQUIRE(newton.solve(s, false, 200, 1e-9) == Outcome::kConverged);
      // Rounding of sums of order one, through the power q = 1/(p − 1) ≤ 20.
      CHECK(kkt_residuals(s, how.criterion, newton.x, newton.y, newton.multipliers).largest() <= 5e-13);
    }
  }
}

TEST_CASE("from its own solution it takes no step; from a neighbour's few") {
  auto problem = random_problem(7, false, false);
  const auto how = settings(3.0);
  ScaledProblem s(problem.setup, how);
  s.set_frame(problem.frame(), true);
  DualNewton newton(s.n, s.m, 3.0);
  REQUIRE(newton.solve(s, false, 200, 1e-9) == Outcome::kConverged);
  const int cold = newton.iterations;
  REQUIRE(newton.solve(s, true, 200, 1e-9) == Outcome::kConverged);
  CHECK(newton.iterations <= 1);
  problem.loads *= 1.01;
  s.set_frame(problem.frame(), true);
  REQUIRE(newton.solve(s, true, 200, 1e-9) == Outcome::kConverged);
  CHECK(newton.iterations < cold);
}

TEST_CASE("loads out of reach: the dual is unbounded") {
  auto problem = random_problem(8, false, false);
  problem.loads *= 30.0;
  for (double p : {1.5, 2.0, 3.0}) {
    ScaledProblem s(problem.setup, settings(p));
    s.set_frame(problem.frame(), true);
    DualNewton newton(s.n, s.m, p);
    CHECK(newton.solve(s, false, 200, 1e-9) == Outcome::kUnbounded);
  }
}
