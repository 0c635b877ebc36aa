// SPDX-License-Identifier: Apache-2.0
// Where contact begins, and the seated pose: the femur as low as possible without contact, rotations zero.
//
//   h(x, z; angles) = sup { y : the contact carries load at (x, y, z; angles) }      first touch
//   seated pose     = argmin over (x, z) of h(x, z; 0, 0, −flexion)                  locally, within reach of the middle
//
// No start is needed and none matters: the search comes from above, where there is no contact, so a deep overlap, or a
// femur that has passed through the insert, is never mistaken for touch. The settled pose (settled_pose.hpp), an
// equilibrium under a light force, leads to the dish; its force is lowered in steps to a hundredth; from there (x, z)
// sinks by polling a disc of points, then shrinking rings: a point that carries no load at the lowest touch so far has a
// lower one. That costs one evaluation a poll and needs no derivative, which h does not have: it is the upper envelope
// of a touch per integration point, with facets of some µm and as many local minima.
// Where h is level (flat condyles on a flat insert: z), the femur stays where it settled, which is near the middle: only
// a slope of `least_slope` moves it; facets may be that steep over the disc.
// A mesh contact touches at its integration points. On a coarse insert (faces 1 mm wide) they stand some 5 µm below its
// vertices, so that the seat is as much too low: refine the insert where that matters.
#pragma once

#include <string_view>

#include "condyle/contact/contact_model.hpp"
#include "condyle/fdk/settled_pose.hpp"

namespace condyle::fdk {

enum class SeatingStatus {
  kConverged,
  kNoContact,    ///< nothing touched over the whole descent
  kNoClearance,  ///< in contact as high as is searched
  kUntrusted,    ///< above first touch the model does not know (trust < 0.5): the edge of its trust was found instead
  kSlidesOff,    ///< the femur sinks on and on, away from where it settled: no dish within reach
};

/// Its name in results, and one sentence: what happened, and what the user can do next.
std::string_view name(SeatingStatus status);
std::string_view advice(SeatingStatus status);

struct SeatingSettings {
  SettleSettings settle;         ///< of the way to the dish; its `touch` is the first range of y that is searched
  double farthest = 0.15;        ///< y is searched to ± this where that range is loaded throughout or holds nothing [m]
  double tolerance = 1e-9;       ///< of first touch along y [m]
  double disc_radius = 0.5e-3;   ///< about (x, z), polled all over [m]: as far as unloading leaves to go
  double last_radius = 1e-6;     ///< of the ring with which the search ends [m]: h is level within a nanometre there
  double least_slope = 1e-4;     ///< a poll must sink by this share of its way [-]: 0.1 µm in 1 mm is level
  double longest_way = 10e-3;    ///< from the settled pose [m]: farther on, the femur slides off
};

/// First touch at the x, z and angles of a pose.
struct FirstTouch {
  Pose pose = Pose::Zero();  ///< its y is the highest that is loaded, within the tolerance; as given unless touched
  SeatingStatus status = SeatingStatus::kNoContact;
  int evaluations = 0;

  bool converged() const { return status == SeatingStatus::kConverged; }
};

struct SeatedPose {
  Pose pose = Pose::Zero();  ///< θx = θy = 0, θz = −flexion; loaded by less than settings.tolerance's depth
  SeatingStatus status = SeatingStatus::kNoContact;
  int evaluations = 0;

  bool converged() const { return status == SeatingStatus::kConverged; }
};

/// Lowers the femur, x, z and angles held, from above until contact begins. The y of `pose` does not matter.
/// @throws std::invalid_argument if the rest of `pose` is not finite or a setting is out of range.
FirstTouch first_touch(const contact::ContactModel& model, const Pose& pose,
                       const SeatingSettings& settings = {});

/// The seated pose at a flexion [rad].
/// @throws std::invalid_argument if flexion is not finite or a setting is out of range.
SeatedPose seated_pose(const contact::ContactModel& model, double flexion,
                       const SeatingSettings& settings = {});

}  // namespace condyle::fdk
