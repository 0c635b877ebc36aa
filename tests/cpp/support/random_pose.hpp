// SPDX-License-Identifier: Apache-2.0
// Seeded draws for tests in a general pose.
#pragma once

#include <cstdint>
#include <random>

#include "condyle/common/pose.hpp"

namespace condyle::test {

/// Uniform doubles in [low, high) from one seed: the same numbers on every platform.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1.0p-53;
    return low + (high - low) * unit;
  }

 private:
  std::mt19937_64 engine_;
};

/// A pose with every coordinate well away from zero in general; angles within ±`angle` [rad].
inline Pose general_pose(Draw& draw, double angle = 1.2) {
  Pose pose;
  for (int i = 0; i < 3; ++i) pose[i] = draw(-0.05, 0.05);
  for (int i = 3; i < 6; ++i) pose[i] = draw(-angle, angle);
  return pose;
}

inline Wrench general_wrench(Draw& draw) {
  Wrench wrench;
  for (int i = 0; i < 3; ++i) wrench[i] = draw(-900.0, 900.0);
  for (int i = 3; i < 6; ++i) wrench[i] = draw(-30.0, 30.0);
  return wrench;
}

}  // namespace condyle::test
