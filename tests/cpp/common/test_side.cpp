// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/side.hpp"

#include <doctest/doctest.h>

#include <stdexcept>

using namespace condyle;

TEST_CASE("z points to the subject's right, so medial is +z in a left knee [oracle]") {
  CHECK(medial_direction(SideOfBody::kLeft) == 1.0);
  CHECK(medial_direction(SideOfBody::kRight) == -1.0);
}

TEST_CASE("names read back, and anything else is refused by its text [error]") {
  for (const SideOfBody side : {SideOfBody::kLeft, SideOfBody::kRight}) {
    CHECK(side_of_body_from_name(name(side)) == side);
  }
  CHECK_THROWS_WITH_AS(side_of_body_from_name("Left"),
                       "side_of_body is 'Left': must be 'left' or 'right'", std::invalid_argument);
}
