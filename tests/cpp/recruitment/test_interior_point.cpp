// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/interior_point.hpp"

#include <doctest/doctest.h>

#include "condyle/recruitment/dual_newton.hpp"
#include "condyle/recruitment/kkt.hpp"
#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using condyle::test::settings;

TEST_CASE("it finds what Newton's method on the dual finds, p = 3 [oracle]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto problem = random_problem(seed, seed % 2 == 0, seed % 3 == 0);
    const auto how = settings(3.0, seed % 4 != 0);
    ScaledProblem s(problem.setup, how);
    s.set_frame(problem.frame(), how.upper_bounds);
    DualNewton newton(s.n, s.m, 3.0);
    InteriorPoint interior(s.n, s.m, 3.0);
    newton.solve(s, false, 200, 1e-9);
    // A start that knows nothing of the solution.
    const Vector start = Vector::Constant(s.m, 0.3 * newton.x.maxCoeff());
    CAPTURE(seed);
    REQUIRE(interior.solve(s, start, 200));
    // The gap stops at 1e-17 of the start's activity cubed: its cube root at worst, where a muscle begins to act.
    CHECK((interior.x - newton.x).cwiseAbs().maxCoeff() <= 2e-6 * newton.x.maxCoeff());
    CHECK(kkt_residuals(s, how.criterion, interior.x, interior.y, interior.multipliers).largest() <= 1e-9);
  }
}

TEST_CASE("p = 4 and 6: the optimality conditions hold [property]") {
  for (double p : {4.0, 6.0}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const auto problem = random_problem(seed, false, false);
      const auto how = settings(p);
      ScaledProblem s(problem.setup, how);
      s.set_frame(problem.frame(), true);
      InteriorPoint interior(s.n, s.m, p);
      CAPTURE(p);
      CAPTURE(seed);
      REQUIRE(interior.solve(s, Vector::Constant(s.m, 0.1 * s.upper[0]), 200));
      CHECK(kkt_residuals(s, how.criterion, interior.x, interior.y, interior.multipliers).largest() <= 1e-7);
    }
  }
}
