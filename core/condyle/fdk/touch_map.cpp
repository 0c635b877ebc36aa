// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/touch_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace condyle::fdk {
namespace {

using contact::ContactLoads;
using contact::Derivatives;

// The map's grid: x ±35 mm is beyond any insert; θz from 30° of hyperextension to 160° of flexion. Steps of 5 mm and 0.15 rad
// keep bilinear interpolation within 0.1 mm on sagittal radii of 17 mm and more.
constexpr double kLowestX = -0.035, kStepX = 0.005;
constexpr int kCountX = 15;
constexpr double kLowestThetaZ = -2.85, kStepThetaZ = 0.15;
constexpr int kCountThetaZ = 23;

constexpr double kTrusted = 0.5;
constexpr int kMaxLightSteps = 12;

bool touches(const ContactLoads& loads) {
  return loads.trust >= kTrusted && loads.total_wrench()[1] > 0.0;
}

int descend(const contact::ContactModel& model, const TouchSearch& search, double step, Pose& pose,
            ContactLoads& loads, bool& doubted) {
  const int steps = static_cast<int>(std::floor((search.y_high - search.y_low) / step));
  for (int k = 0; k <= steps; ++k) {
    pose[kY] = search.y_high - k * step;
    loads = model.evaluate(pose, Derivatives::kStiffness);
    if (touches(loads)) return k + 1;
    doubted = doubted || loads.trust < kTrusted;
  }
  loads = ContactLoads{};
  return steps + 1;
}

SideResponse mix(const std::array<const SideResponse*, 4>& corner,
                 const std::array<double, 4>& weight) {
  SideResponse side;
  side.known = true;
  double root = 0.0;
  for (int c = 0; c < 4; ++c) {
    const SideResponse& s = *corner[c];
    if (!s.known) return SideResponse{};
    side.y_touch += weight[c] * s.y_touch;
    side.lever += weight[c] * s.lever;
    side.arm += weight[c] * s.arm;
    side.arm_by_theta_x += weight[c] * s.arm_by_theta_x;
    root += weight[c] * std::log(s.coefficient);
    side.at.y += weight[c] * s.at.y;
    side.at.theta_x += weight[c] * s.at.theta_x;
  }
  side.coefficient = std::exp(root);
  return side;
}

}  // namespace

void require_valid(const TouchSearch& search) {
  const auto refuse = [](const char* setting, double value, const char* limit) {
    throw std::invalid_argument("touch search: " + std::string(setting) + " is " +
                                std::to_string(value) + ": must be " + limit);
  };
  if (!std::isfinite(search.y_low)) refuse("y_low", search.y_low, "finite [m]");
  if (!(search.y_high > search.y_low) || !std::isfinite(search.y_high)) {
    refuse("y_high", search.y_high, "finite and above y_low [m]");
  }
  if (!(search.step > 1e-6)) refuse("step", search.step, "above 1e-6 m");
  if (!(search.light_load > 0.0)) refuse("light_load", search.light_load, "above 0 N");
}

int descend_to_contact(const contact::ContactModel& model, const TouchSearch& search, Pose& pose,
                       ContactLoads& loads) {
  bool doubted = false;
  int evaluations = descend(model, search, search.step, pose, loads, doubted);
  // A surrogate may be trusted in a band of y thinner than the step: look once more, closely.
  if (doubted && !touches(loads)) {
    evaluations += descend(model, search, search.step / 5.0, pose, loads, doubted);
  }
  return evaluations;
}

KneeResponse light_contact(const contact::ContactModel& model, const TouchSearch& search, Pose pose,
                           int& evaluations) {
  KneeResponse response;
  ContactLoads loads;
  evaluations += descend_to_contact(model, search, pose, loads);
  int refinements = 0;
  for (int step = 0; step < kMaxLightSteps; ++step) {
    if (loads.trust < kTrusted) break;
    for (int s = 0; s < kSides; ++s) {
      const SideResponse fitted = fit_side_response(pose, loads.wrench[s], loads.stiffness[s]);
      if (fitted.known) response[s] = fitted;
    }
    // Both sides loaded: to the light load of the one that touches last. Else on down until both are.
    double y = pose[kY] - search.step / 2.0;
    if (response[kMedial].known && response[kLateral].known) {
      if (refinements++ == 2) break;
      y = HUGE_VAL;
      for (const SideResponse& side : response) {
        const double depth = side.depth_for(search.light_load);
        y = std::min(y, side.y_touch - side.lever * pose[kThetaX] - depth);
      }
    } else if (loads.implausible_depth) {
      break;
    }
    if (y < search.y_low) break;
    pose[kY] = y;
    loads = model.evaluate(pose, Derivatives::kStiffness);
    ++evaluations;
  }
  return response;
}

TouchMap::TouchMap(const contact::ContactModel& model, const TouchSearch& search)
    : model_(model), search_(search),
      nodes_(std::make_unique<Node[]>(static_cast<std::size_t>(kCountX * kCountThetaZ))) {
  require_valid(search);
}

TouchMap::~TouchMap() = default;

const KneeResponse& TouchMap::node(int i, int j) const {
  Node& node = nodes_[static_cast<std::size_t>(i * kCountThetaZ + j)];
  std::call_once(node.once, [&] {
    Pose pose = Pose::Zero();
    pose[kX] = kLowestX + i * kStepX;
    pose[kThetaZ] = kLowestThetaZ + j * kStepThetaZ;
    int evaluations = 0;
    node.response = light_contact(model_, search_, pose, evaluations);
    evaluations_ += evaluations;
  });
  return node.response;
}

KneeResponse TouchMap::at(double x, double theta_z) const {
  const double u = (x - kLowestX) / kStepX, v = (theta_z - kLowestThetaZ) / kStepThetaZ;
  KneeResponse response;
  if (!(u >= 0.0 && u <= kCountX - 1 && v >= 0.0 && v <= kCountThetaZ - 1)) return response;
  const int i = std::min(static_cast<int>(u), kCountX - 2);
  const int j = std::min(static_cast<int>(v), kCountThetaZ - 2);
  const double a = u - i, b = v - j;
  const std::array<const KneeResponse*, 4> corner{&node(i, j), &node(i + 1, j), &node(i, j + 1),
                                                  &node(i + 1, j + 1)};
  const std::array<double, 4> weight{(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
  for (int s = 0; s < kSides; ++s) {
    response[s] = mix({&(*corner[0])[s], &(*corner[1])[s], &(*corner[2])[s], &(*corner[3])[s]},
                      weight);
  }
  return response;
}

}  // namespace condyle::fdk
