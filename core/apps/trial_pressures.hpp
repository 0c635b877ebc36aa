// SPDX-License-Identifier: Apache-2.0
// Where and how hard surfaces press at the poses that a simulation has found: one evaluation of the
// meshes a time frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/fdk/trial_analysis.hpp"
#include "trial_contacts.hpp"

namespace condyle::apps {

/// One part's pressure at one pose; NaN throughout where the pose is not finite.
struct PartPressure {
  Wrench wrench;             ///< on F, at Fo, in T [N, Nm]
  Vector3 centre;            ///< of pressure, in T; NaN out of contact [m]
  double peak = 0.0;         ///< [Pa]
  double mean = 0.0;         ///< over the loaded faces; of a knee's sides [Pa]
  double area = 0.0;         ///< of the loaded faces [m²]
  double max_depth = 0.0;    ///< [m]
  double border_area = 0.0;  ///< of overlap beyond the other surface's open border [m²]
};

struct ContactPressures {
  std::vector<std::string> parts;  ///< medial and lateral; of a pair of bodies the fixed one
  bool has_mean = false;
  std::vector<std::vector<PartPressure>> frames;  ///< (T) of each part
};

/// Evaluates a contact's meshes; nothing where it has none.
/// @param poses (T, 6 C) as TrialSimulation::contact_poses. @param c which of the contacts.
/// @param threads 0: all; the result does not depend on them.
std::optional<ContactPressures> contact_pressures(const TrialContact& contact,
                                                  const fdk::TimeFrames& poses, Eigen::Index c,
                                                  int threads);

}  // namespace condyle::apps
