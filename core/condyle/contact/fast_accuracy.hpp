// SPDX-License-Identifier: Apache-2.0
// How far one evaluation of the contact is from another, over the poses that a knee may take.
#pragma once

#include <cstdint>
#include <vector>

#include "condyle/contact/face_evaluation.hpp"

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
/// @throws std::invalid_argument if count < 1 or a range is empty, naming it.
std::vector<Pose> plausible_poses(const FaceEvaluation& contact, const PlausiblePoses& settings);

/// Largest and typical deviations of the wrench of a side. Relative ones over sides with at least
/// 20 N.
struct AccuracyReport {
  int sides = 0;              ///< sides compared (with force)
  double force_median = 0.0;  ///< |ΔF|/|F|
  double force_p99 = 0.0;
  double moment_median = 0.0;  ///< |ΔM|/|M|
  double moment_p99 = 0.0;
  double force_tolerance_p99 = 0.0;   ///< |ΔF| / (0.2 % |F| + 0.5 N); at most 1 is the aim
  double moment_tolerance_p99 = 0.0;  ///< |ΔM| / (0.2 % |M| + 0.02 Nm)
  double worst = 0.0;                 ///< the larger of those two ratios at the worst pose
  Pose worst_pose = Pose::Zero();
};

/// Compares `fast` to `exact` at poses. @param threads 0: all; the result does not depend on it.
AccuracyReport measure_accuracy(const FaceEvaluation& fast, const FaceEvaluation& exact,
                                const std::vector<Pose>& poses, int threads = 0);

}  // namespace condyle::contact
