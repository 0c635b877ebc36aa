// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <vector>

#include "condyle/fdk/substeps.hpp"

using condyle::fdk::go_in_substeps;

TEST_CASE("substeps double where they are found and end at 1 exactly") {
  std::vector<double> at;
  const auto done = go_in_substeps(8, [&](double t) {
    at.push_back(t);
    return true;
  });
  CHECK(done.reached);
  CHECK(done.taken == 2);
  CHECK(at == std::vector<double>{0.5, 1.0});
}

TEST_CASE("a substep that fails is halved, from the last one found") {
  // No more than 0.3 of the way is bridged at once.
  double here = 0.0;
  std::vector<double> tried;
  const auto done = go_in_substeps(16, [&](double t) {
    tried.push_back(t);
    if (t - here > 0.3) return false;
    here = t;
    return true;
  });
  CHECK(done.reached);
  CHECK(here == 1.0);
  CHECK(tried.front() == 0.5);
  CHECK(tried[1] == 0.25);
  CHECK(done.taken == 4);
}

TEST_CASE("substeps below the smallest end the way where it stands") {
  double here = 0.0;
  int calls = 0;
  const auto done = go_in_substeps(4, [&](double t) {
    ++calls;
    if (t > 0.6) return false;
    here = t;
    return true;
  });
  CHECK_FALSE(done.reached);
  CHECK(here == 0.5);
  CHECK(done.taken == 1);
  // 0.5; then 1 and 0.75 (a quarter is the least), no more.
  CHECK(calls == 3);
  CHECK(go_in_substeps(1, [](double) { return false; }).taken == 0);
}
