// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/active_system.hpp"

#include <doctest/doctest.h>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;

TEST_CASE("levels and free forces answer the rows that they are given") {
  const auto p = random_problem(41, true, false, 5, 14);
  ScaledProblem s(p.setup, {});
  s.set_frame(p.frame(), true);
  std::vector<int> held(14 + 2 * 5, kAtLower);
  for (int i : {0, 3, 5}) held[static_cast<std::size_t>(i)] = 0;
  for (int i : {7, 9}) held[static_cast<std::size_t>(i)] = 1;
  for (int i : {2, 11}) held[static_cast<std::size_t>(i)] = kFree;
  held[14 + 5 + 1] = kFree;  // the reserve of coordinate 1, backwards
  ActiveSystem system(5, 14);
  REQUIRE(system.build(s, held, 2));
  CHECK(system.unknowns() == 5);
  CHECK(system.determined());
  Vector rows(5), dx(14), dy(5);
  rows << 0.3, -0.2, 0.7, 0.1, -0.4;
  system.solve(rows, dx, dy);
  CHECK((s.A * dx + s.reserve.cwiseProduct(dy) - rows).norm() <= 1e-11);
  CHECK(dx[3] * s.weight[3] == doctest::Approx(system.level(0)));
  CHECK(dx[9] * s.weight[9] == doctest::Approx(system.level(1)));
  CHECK(dx[1] == 0.0);
  for (int i = 0; i < 14; ++i) held[static_cast<std::size_t>(i)] = kFree;
  CHECK(!system.build(s, held, 0));
}
