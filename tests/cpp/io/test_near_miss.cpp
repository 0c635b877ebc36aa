// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <vector>

#include "condyle/io/near_miss.hpp"

using condyle::io::did_you_mean;
using condyle::io::listed;
using condyle::io::near_miss;

TEST_CASE("the nearest name is found, whatever its case [property]") {
  const std::vector<std::string> names{"femur_r", "tibia_r", "tibia_l", "patella_r"};
  CHECK(near_miss("tibia_l", names) == "tibia_l");
  CHECK(near_miss("Tibia_R", names) == "tibia_r");
  CHECK(near_miss("tiiba_l", names) == "tibia_l");  // neighbours swapped: one change
  CHECK(near_miss("patela_r", names) == "patella_r");
  CHECK(did_you_mean("femurr", names) == ", did you mean 'femur_r'?");
}

TEST_CASE("what is far is no near miss [property]") {
  const std::vector<std::string> names{"femur_r", "x"};
  CHECK(near_miss("sacrum", names).empty());
  CHECK(near_miss("", names) == "x");  // one letter is always near
  CHECK(near_miss("anything", {}).empty());
  CHECK(did_you_mean("sacrum", names).empty());
}

TEST_CASE("a long list is cut and counted [property]") {
  const std::vector<std::string> names{"a", "b", "c", "d"};
  CHECK(listed(names) == "a, b, c, d");
  CHECK(listed(names, 2) == "a, b … and 2 more");
  CHECK(listed({}).empty());
}
