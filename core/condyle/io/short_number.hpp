// SPDX-License-Identifier: Apache-2.0
// For messages: a number with few digits.
#pragma once

#include <string>

namespace condyle::io {

/// As printf's %g: 0.2, 2.406, 1e-09.
std::string short_number(double value, int digits = 6);

}  // namespace condyle::io
