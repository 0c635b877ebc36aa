// SPDX-License-Identifier: Apache-2.0
// The settled pose: where the femur rests on the insert at a flexion, rotations zero, x, y and z free, under a light axial
// force. It needs no guess and serves as start and as reference of a simulation, and as the way to the seated pose
// (seating.hpp), which is its limit for no force at all.
#pragma once

#include "condyle/contact/contact_model.hpp"
#include "condyle/fdk/touch_map.hpp"
#include "condyle/numerics/newton_solver.hpp"

namespace condyle::fdk {

struct SettleSettings {
  double axial_force = 150.0;  ///< [N]: enough to load both sides, some 0.1 mm deep
  numerics::NewtonSettings newton{.max_iterations = 200};  ///< the way to the dish's bottom may be long
  TouchSearch touch;
};

struct SettledPose {
  Pose pose = Pose::Zero();  ///< θx = θy = 0, θz = −flexion
  bool touched = false;      ///< the descent found contact
  numerics::NewtonResult newton;  ///< of (x, y, z); not run unless touched
  int evaluations = 0;            ///< of the contact, all told

  bool converged() const { return touched && newton.converged(); }
};

/// Lowers the femur at x from −30 to 30 mm (every 5 mm; z = 0), starts at the lowest touch that has higher ones on both
/// sides (beyond the insert's ends the femur would fall) and solves Fx = Fz = 0, Fy = axial_force.
/// @throws std::invalid_argument if flexion is not finite or a setting is out of range.
SettledPose settled_pose(const contact::ContactModel& model, double flexion,
                         const SettleSettings& settings = {});

/// The same from a pose near it, without looking for the dish; its angles are kept.
/// @throws std::invalid_argument if `start` is not finite or a setting is out of range.
SettledPose settle_from(const contact::ContactModel& model, const Pose& start,
                        const SettleSettings& settings = {});

}  // namespace condyle::fdk
