// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_model.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/common/parallel.hpp"

namespace condyle::contact {

void require_finite(const Pose& pose) {
  static constexpr const char* kNames[] = {"x", "y", "z", "theta_x", "theta_y", "theta_z"};
  for (int i = 0; i < 6; ++i) {
    if (!std::isfinite(pose[i])) {
      throw std::invalid_argument("pose: " + std::string(kNames[i]) + " is " +
                                  std::to_string(pose[i]) + ": must be finite");
    }
  }
}

void ContactModel::evaluate_batch(std::span<const Pose> poses, Derivatives derivatives, int threads,
                                  std::span<ContactLoads> loads) const {
  if (loads.size() != poses.size()) {
    throw std::invalid_argument("evaluate_batch: " + std::to_string(loads.size()) +
                                " results for " + std::to_string(poses.size()) + " poses");
  }
  parallel_for(poses.size(), threads, [&](std::size_t i) {
    try {
      loads[i] = evaluate(poses[i], derivatives);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("row " + std::to_string(i) + ": " + error.what());
    }
  });
}

}  // namespace condyle::contact
