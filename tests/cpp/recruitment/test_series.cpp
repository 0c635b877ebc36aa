// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/series.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using condyle::test::settings;

TEST_CASE("a series is its time frames, and one that fails does not stop the next") {
  const auto problem = random_problem(61, false, false);
  const int n = 7, m = 43, t = 4;
  std::vector<double> arms, loads;
  const double factors[t] = {1.0, 1.02, 60.0, 0.98};
  for (double factor : factors) {
    arms.insert(arms.end(), problem.moment_arms.data(), problem.moment_arms.data() + n * m);
    for (int j = 0; j < n; ++j) loads.push_back(factor * problem.loads[j]);
  }
  const std::span<const double> strengths(problem.strengths.data(), m);
  RecruitmentSolver solver(problem.setup, settings(3.0));
  const auto series = recruit_series(solver, {arms, loads, strengths, {}}, true, true);
  CHECK(series.status[2] == RecruitmentStatus::kInfeasible);
  CHECK(series.message[2].find("infeasible") == 0);
  CHECK(series.message[1].empty());
  CHECK(std::isnan(series.forces_by_loads(2 * m, 0)));
  for (int i : {0, 1, 3}) {
    auto frame = problem;
    frame.loads *= factors[i];
    const Recruitment& alone = solver.solve(frame.frame());
    CHECK((series.forces.row(i).transpose() - alone.forces).norm() <= 1e-9 * alone.forces.norm());
    RowMatrix df(m, n), de(n, n);
    solver.forces_by_loads(df, de);
    CHECK((series.forces_by_loads.middleRows(i * m, m) - df).norm() <= 1e-6 * df.norm());
  }
}

TEST_CASE("sizes that do not fit and wrong values say where [error]") {
  const auto problem = random_problem(62, false, false);
  RecruitmentSolver solver(problem.setup, settings(3.0));
  const std::vector<double> arms(2 * 7 * 43, 0.01), loads(14, 1.0), few(42, 100.0);
  CHECK_THROWS_WITH_AS(recruit_series(solver, {arms, loads, few, {}}, true, false),
                       "recruitment: strengths has 42 values: must be 86", std::invalid_argument);
  std::vector<double> negative(86, 100.0);
  negative[50] = -1.0;
  CHECK_THROWS_WITH_AS(recruit_series(solver, {arms, loads, negative, {}}, true, false),
                       "time frame 1: recruitment: strength of muscle 7 = -1: must be finite and at least 0",
                       std::invalid_argument);
}
