// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/side_response.hpp"

#include <algorithm>
#include <cmath>

namespace condyle::fdk {
namespace {

constexpr int kFy = 1, kMx = 3;
// Below this force a side is as good as lifted off: its arm and stiffness are noise of a few loaded faces.
constexpr double kLeastForce = 1e-6;
constexpr double kArmRange = 0.015;
// A law interpolated from the map is wrong by some 0.1 mm.
constexpr double kFirstGap = 1e-4;

}  // namespace

double SideResponse::depth_for(double force) const {
  return std::pow(std::max(force, 0.0) / coefficient, 1.0 / kExponent);
}

double SideResponse::force(const SensitivePoint& p) const {
  const double d = depth(p);
  return d > 0.0 ? coefficient * std::pow(d, kExponent) : 0.0;
}

double SideResponse::arm_at(const SensitivePoint& p) const {
  const double change = arm_by_y * (p.y - at.y) + arm_by_theta_x * (p.theta_x - at.theta_x);
  return arm + std::clamp(change, -kArmRange, kArmRange);
}

void SideResponse::match(const SensitivePoint& p, double force_seen, double arm_seen) {
  // Steps in metres at the condyle: dy and 24 mm · dθx.
  constexpr double kRadius = 0.024;
  const double dy = p.y - at.y, dt = kRadius * (p.theta_x - at.theta_x);
  const double squared = dy * dy + dt * dt;
  if (!(squared > 0.0) || !(force_seen > 0.0)) return;
  // depth(p) = depth(at) − slope_y dy − lever dθx with slope_y = 1: only the lever is free, so dy must not rule the step.
  if (std::abs(dt) > 0.3 * std::abs(dy)) {
    const double error = depth_for(force_seen) - depth(p);
    const double lever_change = -error / (p.theta_x - at.theta_x);
    y_touch += lever_change * at.theta_x;
    lever += lever_change;
  }
  const double arm_error =
      arm_seen - (arm + arm_by_y * dy + arm_by_theta_x * (p.theta_x - at.theta_x));
  arm_by_y += arm_error * dy / squared;
  arm_by_theta_x += arm_error * kRadius * dt / squared;
}

void SideResponse::seen_unloaded(const SensitivePoint& p) {
  const double d = depth(p);
  if (d > 0.0) y_touch -= d + kFirstGap * std::ldexp(1.0, misses++);
}

SideResponse fit_side_response(const Pose& pose, const Wrench& w, const Matrix6& S) {
  SideResponse side;
  const double Fy = w[kFy];
  const double Fy_by_y = S(kFy, kY);
  if (!(Fy > kLeastForce) || !(Fy_by_y < 0.0) || !S.allFinite()) return side;
  side.known = true;
  side.at = {pose[kY], pose[kThetaX]};
  const double depth = -SideResponse::kExponent * Fy / Fy_by_y;
  side.lever = S(kFy, kThetaX) / Fy_by_y;
  side.coefficient = Fy / std::pow(depth, SideResponse::kExponent);
  side.y_touch = side.at.y + side.lever * side.at.theta_x + depth;
  side.arm = w[kMx] / Fy;
  side.arm_by_y = (S(kMx, kY) - side.arm * Fy_by_y) / Fy;
  side.arm_by_theta_x = (S(kMx, kThetaX) - side.arm * S(kFy, kThetaX)) / Fy;
  return side;
}

}  // namespace condyle::fdk
