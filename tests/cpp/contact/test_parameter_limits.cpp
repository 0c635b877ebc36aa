// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "condyle/contact/parameter_limits.hpp"

using namespace condyle::contact;

TEST_CASE("a value within its limits passes, bounds counted as the limit says") {
  CHECK_NOTHROW(require_above({"gap", "m"}, 2.0000001, 2.0));
  CHECK_NOTHROW(require_at_least({"gap", "m"}, 2.0, 2.0));
  CHECK_NOTHROW(require_between({"gap", "m"}, -0.99, -1.0, 0.5));
}

TEST_CASE("a value outside its limits is named with its unit and the limit") {
  CHECK_THROWS_WITH_AS(require_above({"gap", "m"}, 2.0, 2.0),
                       "gap is 2 m: must be finite and greater than 2", std::invalid_argument);
  CHECK_THROWS_WITH_AS(require_at_least({"share", ""}, 0.25, 0.75, "less is not stable"),
                       "share is 0.25: must be finite and at least 0.75; less is not stable",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(require_between({"angle", "rad"}, 0.5, -1.0, 0.5),
                       "angle is 0.5 rad: must be between -1 and 0.5, both excluded",
                       std::invalid_argument);
  CHECK_THROWS_AS(require_between({"angle", "rad"}, -1.0, -1.0, 0.5), std::invalid_argument);
}

TEST_CASE("what is not finite is in no limits") {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_AS(require_above({"gap", "m"}, value, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(require_at_least({"gap", "m"}, value, 0.0), std::invalid_argument);
    CHECK_THROWS_AS(require_between({"gap", "m"}, value, 0.0, 3.0), std::invalid_argument);
  }
}

TEST_CASE("a number in a message has six digits at most") {
  CHECK(short_text(9.3e9) == "9.3e+09");
  CHECK(short_text(0.0071234567) == "0.00712346");
}
