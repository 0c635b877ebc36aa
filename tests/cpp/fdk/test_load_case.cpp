// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/load_case.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

using condyle::fdk::LoadCase;
using condyle::fdk::require_valid;

namespace {

LoadCase three_rows() {
  return {{0.0, 0.1, 0.25}, {0.02, 0.3, 0.9}, {168.0, 2600.0, 500.0}, {-30.0, 20.0, 5.0}, {0.3, -0.7, 2.1}};
}

}  // namespace

TEST_CASE("a sound load case is accepted [property]") {
  CHECK_NOTHROW(require_valid(three_rows(), "sound"));
}

TEST_CASE("what is wrong with a load case is named: file, field, row, value, limit [error]") {
  LoadCase c = three_rows();
  c.flexion[1] = 58.0;  // degrees
  CHECK_THROWS_WITH_AS(require_valid(c, "gait.csv"),
                       "load case 'gait.csv': flexion in row 1 is 58.000000: must lie within "
                       "-0.600000 and 3.000000 rad",
                       std::invalid_argument);
  c = three_rows();
  c.time[2] = 0.1;
  CHECK_THROWS_WITH_AS(require_valid(c, "gait.csv"),
                       "load case 'gait.csv': time in row 2 is 0.100000: must be above the row "
                       "before, 0.100000",
                       std::invalid_argument);
  c = three_rows();
  c.ap_force.pop_back();
  CHECK_THROWS_WITH_AS(require_valid(c, "gait.csv"),
                       "load case 'gait.csv': ap_force has 2 values, time has 3",
                       std::invalid_argument);
  c = three_rows();
  c.ie_torque[0] = NAN;
  CHECK_THROWS_AS(require_valid(c, "gait.csv"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(require_valid(LoadCase{}, "empty.csv"), "load case 'empty.csv': has no rows",
                       std::invalid_argument);
}
