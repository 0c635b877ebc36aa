// SPDX-License-Identifier: Apache-2.0
// Sides of the body and of the knee. Which compartment is medial follows from the side of the body, never from a
// sign written into a capability.
#pragma once

#include <string_view>

namespace condyle {

enum class SideOfBody { kLeft, kRight };

/// Order of the two sides of the knee in every array of loads: medial first.
enum Side : int { kMedial = 0, kLateral = 1 };
inline constexpr int kSides = 2;

/// Sign of z towards the medial compartment: +1 in a left knee, −1 in a right one (z points to the subject's right).
constexpr double medial_direction(SideOfBody side) { return side == SideOfBody::kLeft ? 1.0 : -1.0; }

constexpr std::string_view name(SideOfBody side) {
  return side == SideOfBody::kLeft ? "left" : "right";
}
constexpr std::string_view name(Side side) { return side == kMedial ? "medial" : "lateral"; }

/// Reads "left" or "right". @throws std::invalid_argument for anything else, naming the text.
SideOfBody side_of_body_from_name(std::string_view text);

}  // namespace condyle
