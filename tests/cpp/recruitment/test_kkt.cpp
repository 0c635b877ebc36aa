// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/kkt.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "condyle/recruitment/dual_newton.hpp"
#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using condyle::test::settings;

TEST_CASE("each residual sees its own fault") {
  const auto problem = random_problem(31, true, false);
  const auto how = settings(2.0);
  ScaledProblem s(problem.setup, how);
  s.set_frame(problem.frame(), true);
  DualNewton newton(s.n, s.m, 2.0);
  newton.solve(s, false, 200, 1e-9);
  const auto residuals = [&](const Vector& x, const Vector& y, const Vector& multipliers) {
    return kkt_residuals(s, how.criterion, x, y, multipliers);
  };
  REQUIRE(residuals(newton.x, newton.y, newton.multipliers).largest() <= 1e-12);
  Vector x = newton.x;
  int acting = 0;
  x.maxCoeff(&acting);
  x[acting] *= 0.99;
  CHECK(residuals(x, newton.y, newton.multipliers).primal > 1e-4);
  const Vector multipliers = 1.01 * newton.multipliers;
  CHECK(residuals(newton.x, newton.y, multipliers).complementarity > 1e-3);
  CHECK(residuals(newton.x, newton.y, multipliers).stationarity > 1e-5);  // of the reserves
  CHECK(residuals(newton.x, newton.y, multipliers).primal <= 1e-12);
}
