// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/settled_pose.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/fdk/knee_equilibrium.hpp"

namespace condyle::fdk {
namespace {

constexpr int kColumns = 13, kMiddle = kColumns / 2;
constexpr double kSpacing = 5e-3;  // [m] of the columns along x: a dish is some 40 mm long

void require_valid(const SettleSettings& settings) {
  fdk::require_valid(settings.touch);
  if (std::isfinite(settings.axial_force) && settings.axial_force > 0.0) return;
  throw std::invalid_argument("settled pose: axial_force is " +
                              std::to_string(settings.axial_force) +
                              ": must be finite and above 0 N");
}

// Whether going from column i towards `step` the touch rises before it falls below that of i. A column without touch lies
// lowest of all: there the femur would fall past the insert.
bool rises(const std::array<double, kColumns>& touch, int i, int step) {
  for (int k = i + step; k >= 0 && k < kColumns; k += step) {
    if (touch[k] != touch[i]) return touch[k] > touch[i];
  }
  return false;
}

// Sets x and y of `pose` to the dish's lowest column; false if nothing touches.
bool find_dish(const contact::ContactModel& model, const TouchSearch& search, Pose& pose,
               int& evaluations) {
  std::array<double, kColumns> touch;
  for (int i = 0; i < kColumns; ++i) {
    Pose column = pose;
    column[kX] = (i - kMiddle) * kSpacing;
    contact::ContactLoads loads;
    evaluations += descend_to_contact(model, search, column, loads);
    touch[i] = loads.total_wrench()[1] > 0.0 ? column[kY] : -HUGE_VAL;
  }
  // From the middle outwards, so that the nearest of equals is taken. Without any dish (a surrogate known in a narrow
  // band only), the lowest touch there is.
  int chosen = -1;
  for (const bool enclosed : {true, false}) {
    for (int n = 0; n < kColumns; ++n) {
      const int i = kMiddle + (n % 2 == 0 ? -n / 2 : (n + 1) / 2);
      if (!std::isfinite(touch[i])) continue;
      if (enclosed && !(rises(touch, i, -1) && rises(touch, i, +1))) continue;
      if (chosen < 0 || touch[i] < touch[chosen]) chosen = i;
    }
    if (chosen >= 0) break;
  }
  if (chosen < 0) return false;
  pose[kX] = (chosen - kMiddle) * kSpacing;
  pose[kY] = touch[chosen];
  return true;
}

}  // namespace

SettledPose settle_from(const contact::ContactModel& model, const Pose& start,
                        const SettleSettings& settings) {
  contact::require_finite(start);
  require_valid(settings);
  SettledPose settled;
  settled.touched = true;
  KneeSetup setup{model, 0.0, {}, {}};
  setup.restraint.ap_stiffness = setup.restraint.ie_stiffness = 0.0;
  constexpr std::array<int, 3> kFree{kX, kY, kZ};
  KneeEquilibrium problem(setup, {settings.axial_force, 0.0, 0.0}, start, kFree);
  settled.newton = solve_newton(problem, problem.unknowns(start), settings.newton);
  settled.pose = problem.pose(settled.newton.alpha);
  settled.evaluations = settled.newton.statistics.evaluations;
  return settled;
}

SettledPose settled_pose(const contact::ContactModel& model, double flexion,
                         const SettleSettings& settings) {
  if (!std::isfinite(flexion)) {
    throw std::invalid_argument("settled pose: flexion is " + std::to_string(flexion) +
                                ": must be finite [rad]");
  }
  require_valid(settings);
  Pose dish = Pose::Zero();
  dish[kThetaZ] = -flexion;
  int evaluations = 0;
  const bool touched = find_dish(model, settings.touch, dish, evaluations);
  SettledPose settled;
  settled.pose = dish;
  if (touched) settled = settle_from(model, dish, settings);
  settled.evaluations += evaluations;
  return settled;
}

}  // namespace condyle::fdk
