// SPDX-License-Identifier: Apache-2.0
// How one side of the knee answers to a small change of its sensitive direction (y, θx): a local law fitted to one
// contact evaluation, good enough to predict the next.
//
//   Fy(y, θx) = c · max(0, d)ⁿ,   d = y_touch − y − lever·θx,   Mx = arm(y, θx) · Fy
//
// d is the depth of the side, n = 1.75 lies between a line contact (1.5) and a point contact (2) on an elastic foundation.
// The law matches Fy, Mx and their first derivatives at the pose that it was fitted to, so steps from it converge like
// Newton's, but near-touch curvature and lift-off are in it too, which the tangent alone does not have.
#pragma once

#include "condyle/common/pose.hpp"

namespace condyle::fdk {

/// The sensitive direction of a knee: what a static equilibrium solves for.
struct SensitivePoint {
  double y = 0.0;        ///< [m]
  double theta_x = 0.0;  ///< [rad]
};

struct SideResponse {
  bool known = false;      ///< fitted to a loaded contact
  double y_touch = 0.0;    ///< y at first touch with θx = 0, by this law [m]
  double lever = 0.0;      ///< −∂y/∂θx at constant depth [m/rad]
  double coefficient = 0.0;  ///< c [N/mⁿ]
  double arm = 0.0;        ///< Mx/Fy at `at` [m]
  double arm_by_y = 0.0;        ///< ∂arm/∂y [-]
  double arm_by_theta_x = 0.0;  ///< ∂arm/∂θx [m/rad]
  SensitivePoint at;       ///< where the law was fitted
  int misses = 0;          ///< how often seen_unloaded contradicted the law

  static constexpr double kExponent = 1.75;

  /// d, negative out of contact [m].
  double depth(const SensitivePoint& p) const { return y_touch - p.y - lever * p.theta_x; }
  /// Depth at which this side carries `force` ≥ 0 [m].
  double depth_for(double force) const;
  /// Fy by the law [N].
  double force(const SensitivePoint& p) const;
  /// Mx/Fy by the law, kept within ±15 mm of its value where fitted: half a condyle's width [m].
  double arm_at(const SensitivePoint& p) const;
  /// Turns the law's slopes, along the way back to `p`, so that it gives the force and arm that were seen there (Broyden's
  /// rank-one correction). The contact's stiffness is one-sided where faces enter: on a few loaded faces it misleads.
  void match(const SensitivePoint& p, double force_seen, double arm_seen);
  /// Tells the law that this side is out of contact at `p`: it then touches beyond, by a gap that doubles from 0.1 mm
  /// each time that the law was wrong.
  void seen_unloaded(const SensitivePoint& p);
};

/// The law of one side from its wrench and stiffness at a pose.
/// @returns known = false where the side carries no compression or does not stiffen with depth.
SideResponse fit_side_response(const Pose& pose, const Wrench& wrench_Fo_T,
                               const Matrix6& stiffness);

}  // namespace condyle::fdk
