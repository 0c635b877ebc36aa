// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/io/short_number.hpp"

using condyle::io::short_number;

TEST_CASE("numbers have as many digits as asked, and no trailing zeros") {
  CHECK(short_number(0.2) == "0.2");
  CHECK(short_number(3.0) == "3");
  CHECK(short_number(2.4062345) == "2.40623");
  CHECK(short_number(2.4062345, 3) == "2.41");
  CHECK(short_number(1e-9) == "1e-09");
  CHECK(short_number(-1234567.0, 4) == "-1.235e+06");
}
