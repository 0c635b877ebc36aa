// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/settled_pose.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/fdk/knee_equilibrium.hpp"

namespace condyle::fdk {

SettledPose settled_pose(const contact::ContactModel& model, double flexion,
                         const SettleSettings& settings) {
  if (!std::isfinite(flexion)) {
    throw std::invalid_argument("settled pose: flexion is " + std::to_string(flexion) +
                                ": must be finite [rad]");
  }
  if (!(std::isfinite(settings.axial_force) && settings.axial_force > 0.0)) {
    throw std::invalid_argument("settled pose: axial_force is " +
                                std::to_string(settings.axial_force) +
                                ": must be finite and above 0 N");
  }
  require_valid(settings.touch);

  SettledPose settled;
  settled.pose[kThetaZ] = -flexion;
  double lowest = HUGE_VAL;
  for (const double x : {0.0, 0.005, -0.005, 0.01, -0.01, 0.015, -0.015}) {
    Pose pose = Pose::Zero();
    pose[kThetaZ] = -flexion;
    pose[kX] = x;
    contact::ContactLoads loads;
    descend_to_contact(model, settings.touch, pose, loads);
    if (!(loads.total_wrench()[1] > 0.0) || !(pose[kY] < lowest)) continue;
    lowest = pose[kY];
    settled.pose = pose;
    settled.touched = true;
  }
  if (!settled.touched) return settled;

  KneeSetup setup{model, 0.0, {}, {}};
  setup.restraint.ap_stiffness = setup.restraint.ie_stiffness = 0.0;
  constexpr std::array<int, 3> kFree{kX, kY, kZ};
  KneeEquilibrium problem(setup, {settings.axial_force, 0.0, 0.0}, settled.pose, kFree);
  settled.newton = solve_newton(problem, problem.unknowns(settled.pose), settings.newton);
  settled.pose = problem.pose(settled.newton.alpha);
  return settled;
}

}  // namespace condyle::fdk
