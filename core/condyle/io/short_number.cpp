// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/short_number.hpp"

#include <cstdio>

namespace condyle::io {

std::string short_number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace condyle::io
