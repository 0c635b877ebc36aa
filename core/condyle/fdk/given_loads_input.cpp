// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads_input.hpp"

#include <cmath>
#include <stdexcept>

namespace condyle::fdk {
namespace {

using recruitment::RowMatrix;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("given loads: " + what);
}

std::string shape(Eigen::Index rows, Eigen::Index columns) {
  std::string text = "(";
  text += std::to_string(rows) + ", " + std::to_string(columns) + ")";
  return text;
}

template <typename Matrix>
void require_field(const std::string& frame, const char* field, const Matrix& values,
                   Eigen::Index rows, Eigen::Index columns) {
  if (values.rows() != rows || values.cols() != columns) {
    refuse(frame + field + " has shape " + shape(values.rows(), values.cols()) + ": must be " +
           shape(rows, columns));
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      if (std::isfinite(values(i, j))) continue;
      refuse(frame + field + "[" + std::to_string(i) + "][" + std::to_string(j) + "] is " +
             std::to_string(values(i, j)) + ": must be finite");
    }
  }
}

}  // namespace

void require_valid(const GivenLoadsSetup& setup, const contact::ContactModel& contact) {
  if (contact.side_of_body() != setup.side_of_body) {
    refuse("the contact model is of a " + std::string(name(contact.side_of_body())) +
           " knee, the loads are of a " + std::string(name(setup.side_of_body)) + " one");
  }
  const int n = setup.muscles.coordinates;
  if (setup.knee_coordinate < -1 || setup.knee_coordinate >= n) {
    refuse("knee_coordinate is " + std::to_string(setup.knee_coordinate) + ": must be 0 to " +
           std::to_string(n - 1) + ", or -1 for none");
  }
  for (const model::Ligament& ligament : setup.ligaments) require_valid(ligament);
  if (setup.restraint) require_valid(*setup.restraint);
}

void require_valid(const GivenLoadsFrame& frame, const GivenLoadsSetup& setup, std::size_t index) {
  const std::string owner = "time frame " + std::to_string(index) + ": ";
  const Eigen::Index n = setup.muscles.coordinates, m = setup.muscles.muscles;
  if (!std::isfinite(frame.flexion)) {
    refuse(owner + "flexion is " + std::to_string(frame.flexion) + ": must be finite [rad]");
  }
  require_field(owner, "loads", frame.loads, n, 1);
  require_field(owner, "secondary_loads", frame.secondary_loads, 5, 1);
  require_field(owner, "wrench", frame.wrench, 6, 1);
  require_field(owner, "moment_arms", frame.moment_arms, n, m);
  require_field(owner, "secondary_arms", frame.secondary_arms, 5, m);
  require_field(owner, "strengths", frame.strengths, m, 1);
  if (frame.minima.size() > 0) require_field(owner, "minima", frame.minima, m, 1);
  if (frame.arms_by_pose.rows() > 0) {
    require_field(owner, "arms_by_pose", frame.arms_by_pose, 5 * (n + 5), m);
    require_field(owner, "arms_at", frame.arms_at, 5, 1);
  }
}

GivenLoadsFrame between(const GivenLoadsFrame& a, const GivenLoadsFrame& b, double t) {
  GivenLoadsFrame mixed = a;
  const auto mix = [t](auto& into, const auto& goal) { into += t * (goal - into); };
  mix(mixed.flexion, b.flexion);
  mix(mixed.loads, b.loads);
  mix(mixed.secondary_loads, b.secondary_loads);
  mix(mixed.wrench, b.wrench);
  mix(mixed.moment_arms, b.moment_arms);
  mix(mixed.secondary_arms, b.secondary_arms);
  mix(mixed.strengths, b.strengths);
  mix(mixed.minima, b.minima);
  mix(mixed.arms_by_pose, b.arms_by_pose);
  mix(mixed.arms_at, b.arms_at);
  return mixed;
}

GivenLoadsFrame unloaded(const GivenLoadsFrame& frame) {
  GivenLoadsFrame without = frame;
  without.loads.setZero();
  without.secondary_loads.setZero();
  without.wrench.setZero();
  return without;
}

}  // namespace condyle::fdk
