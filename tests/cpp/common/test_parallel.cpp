// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/parallel.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

using condyle::parallel_for;

TEST_CASE("every index is visited exactly once, for any number of threads [property]") {
  for (const int threads : {0, 1, 2, 5, 64}) {
    std::vector<std::atomic<int>> visits(137);
    parallel_for(visits.size(), threads, [&](std::size_t i) { ++visits[i]; });
    for (const auto& count : visits) CHECK(count == 1);
  }
}

TEST_CASE("the failure of the lowest index is the one thrown [error]") {
  for (const int threads : {1, 3}) {
    std::string message;
    try {
      parallel_for(500, threads, [](std::size_t i) {
        if (i == 41 || i > 300) throw std::runtime_error("index " + std::to_string(i));
      });
    } catch (const std::runtime_error& error) {
      message = error.what();
    }
    CHECK(message == "index 41");
  }
}

TEST_CASE("a negative number of threads is refused [error]") {
  CHECK_THROWS_WITH_AS(parallel_for(3, -2, [](std::size_t) {}),
                       "threads is -2: must be 0 (all) or a positive number", std::invalid_argument);
}
