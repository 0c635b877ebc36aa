// SPDX-License-Identifier: Apache-2.0
// How far one contact model is from another, over the poses that a knee may take: of the `fast`
// evaluation against the `exact` one.
//
// An error is measured against the tolerance 0.2 % + 0.5 N of a force, 0.2 % + 0.02 Nm of a moment:
// |ΔF| / (0.002 |F| + 0.5 N), at most 1 where the model holds it.
#pragma once

#include <cstdint>
#include <vector>

#include "condyle/contact/contact_model.hpp"

namespace condyle::contact {

/// A box of poses about a settled one, and the range of load; defaults: a knee replacement in gait
/// and stairs.
struct PlausiblePoses {
  Pose settled = Pose::Zero();    ///< x, z of the femur resting on the insert, y to start from
  double x = 4e-3;                ///< ± about settled [m]
  double z = 1.5e-3;              ///< ± about settled [m]
  double theta_x = 0.0175;        ///< ± [rad], 1°
  double theta_y = 0.122;         ///< ± [rad], 7°
  double flexion = 1.134;         ///< θz from 0 down to minus this [rad], 65°
  double lowest_force = 20.0;     ///< total Fy, log-uniform [N]
  double highest_force = 3500.0;  ///< [N]
  int count = 200;
  std::uint64_t seed = 1;
};

/// Draws poses and moves each along y until the total Fy is the load drawn, to 1 %. The same for
/// the same seed.
/// @param threads 0: all; the result does not depend on it.
/// @returns those that carry their load: fewer than `count` where the femur slips past the insert.
/// @throws std::invalid_argument if count < 1 or a range is empty, naming it.
std::vector<Pose> plausible_poses(const ContactModel& model, const PlausiblePoses& settings,
                                  int threads = 0);

/// Deviations of one kind (forces or moments) over wrenches. Relative ones over wrenches with at
/// least 20 N.
struct Deviations {
  double median = 0.0;           ///< |Δ|/|·|
  double p99 = 0.0;              ///< 99th percentile
  double worst = 0.0;            ///< largest
  double tolerance_p99 = 0.0;    ///< of error/tolerance
  double tolerance_worst = 0.0;  ///< of error/tolerance
};

/// Of all sides, or of all totals, over some poses.
struct WrenchDeviations {
  int count = 0;  ///< wrenches compared: those that carry force
  Deviations force, moment;
  Pose worst_pose = Pose::Zero();  ///< where error/tolerance is largest
};

/// Poses whose total force |F| lies between two values.
struct LoadRange {
  double from = 0.0, to = 0.0;  ///< [N]
  WrenchDeviations sides, total;
};

struct AccuracyReport {
  WrenchDeviations sides, total;   ///< over all poses
  std::vector<LoadRange> by_load;  ///< limits 20, 60, 200, 600, 2 000, 3 500 N, the outer ones open
};

/// Compares `fast` to `exact` at poses. @param threads 0: all; the result does not depend on it.
AccuracyReport measure_accuracy(const ContactModel& fast, const ContactModel& exact,
                                const std::vector<Pose>& poses, int threads = 0);

}  // namespace condyle::contact
