// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/knee_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace condyle::fdk {
namespace {

struct Spring {
  int coordinate;
  double stiffness, gap, reference;
};

std::array<Spring, 3> springs_of(const RestraintSprings& s) {
  return {{{kX, s.ap_stiffness, s.ap_gap, s.reference_x.value_or(0.0)},
           {kZ, s.ml_stiffness, s.ml_gap, s.reference_z.value_or(0.0)},
           {kThetaY, s.ie_stiffness, s.ie_gap, s.reference_theta_y.value_or(0.0)}}};
}

}  // namespace

Wrench applied_wrench(const KneeLoad& load, SideOfBody side_of_body, double axial_offset,
                      const Pose& pose) {
  const double medial = medial_direction(side_of_body);
  const double z_A = medial * axial_offset;
  const double F = load.axial_force, P = load.ap_force;
  Wrench wrench;
  wrench << -P, -F, 0.0, (z_A - pose[kZ]) * F, pose[kZ] * P + medial * load.ie_torque,
      pose[kX] * F - pose[kY] * P;
  return wrench;
}

Matrix6 applied_stiffness(const KneeLoad& load) {
  Matrix6 S = Matrix6::Zero();
  S(3, kZ) = -load.axial_force;
  S(4, kZ) = load.ap_force;
  S(5, kX) = load.axial_force;
  S(5, kY) = -load.ap_force;
  return S;
}

void require_valid(const RestraintSprings& springs) {
  const auto check = [](double value, const char* setting) {
    if (!(std::isfinite(value) && value >= 0.0)) {
      throw std::invalid_argument("restraint springs: " + std::string(setting) + " is " +
                                  std::to_string(value) + ": must be finite and at least 0");
    }
  };
  check(springs.ap_stiffness, "ap_stiffness");
  check(springs.ap_gap, "ap_gap");
  check(springs.ie_stiffness, "ie_stiffness");
  check(springs.ie_gap, "ie_gap");
  check(springs.ml_stiffness, "ml_stiffness");
  check(springs.ml_gap, "ml_gap");
  for (const auto& [value, setting] : {std::pair{springs.reference_x, "reference_x"},
                                       std::pair{springs.reference_z, "reference_z"},
                                       std::pair{springs.reference_theta_y, "reference_theta_y"}}) {
    if (value && !std::isfinite(*value)) {
      throw std::invalid_argument("restraint springs: " + std::string(setting) + " is " +
                                  std::to_string(*value) + ": must be finite");
    }
  }
}

Vector6 restraint_force(const RestraintSprings& springs, const Pose& pose) {
  Vector6 Q = Vector6::Zero();
  for (const Spring& s : springs_of(springs)) {
    const double u = pose[s.coordinate] - s.reference;
    Q[s.coordinate] = -s.stiffness * (u - std::clamp(u, -s.gap, s.gap));
  }
  return Q;
}

Matrix6 restraint_stiffness(const RestraintSprings& springs, const Pose& pose) {
  Matrix6 K = Matrix6::Zero();
  for (const Spring& s : springs_of(springs)) {
    if (std::abs(pose[s.coordinate] - s.reference) >= s.gap) {
      K(s.coordinate, s.coordinate) = -s.stiffness;
    }
  }
  return K;
}

}  // namespace condyle::fdk
