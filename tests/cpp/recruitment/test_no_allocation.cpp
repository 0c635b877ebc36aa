// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>

#include "condyle/recruitment/recruitment.hpp"
#include "random_problem.hpp"
#include "support/count_allocations.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using condyle::test::settings;

namespace {

constexpr double kMinMax = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("what was solved before does not matter, and nothing is allocated [property]") {
  for (double p : {1.0, 1.7, 2.0, 3.0, 5.0, kMinMax}) {
    const auto problem = random_problem(53, p <= 3.0, true);
    auto other = random_problem(54, false, true);
    other.loads *= 40.0;
    RecruitmentSolver solver(problem.setup, settings(p));
    const Recruitment first = solver.solve(problem.frame());
    REQUIRE(first.converged());
    const WarmStart warm = solver.warm_start();
    solver.solve(other.frame());
    const long allocated = condyle::test::count_allocations([&] {
      solver.solve(problem.frame());
    });
    CAPTURE(p);
    CHECK(allocated == 0);
    CHECK(solver.result().forces == first.forces);
    CHECK(condyle::test::count_allocations([&] { solver.solve(problem.frame(), warm); }) == 0);
    CHECK((solver.result().forces - first.forces).norm() <= 1e-9 * first.forces.norm());
    RowMatrix df(43, 7), de(7, 7);
    CHECK(condyle::test::count_allocations([&] { solver.forces_by_loads(df, de); }) == 0);
  }
}
