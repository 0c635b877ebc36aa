// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/side.hpp"

#include <stdexcept>
#include <string>

namespace condyle {

SideOfBody side_of_body_from_name(std::string_view text) {
  if (text == "left") return SideOfBody::kLeft;
  if (text == "right") return SideOfBody::kRight;
  throw std::invalid_argument("side_of_body is '" + std::string(text) +
                              "': must be 'left' or 'right'");
}

}  // namespace condyle
