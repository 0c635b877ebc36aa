// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "condyle/contact/contact_law.hpp"
#include "condyle/contact/parameter_limits.hpp"

namespace condyle::contact {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("contact law table: " + what);
}

std::string named(const char* quantity, std::size_t i, double value, const char* unit) {
  return std::string(quantity) + " " + std::to_string(i) + " is " + short_text(value) + unit;
}

// Depth i and pressure i against those before.
void require_point(const std::vector<double>& depth, const std::vector<double>& pressure,
                   std::size_t i) {
  if (!std::isfinite(depth[i])) refuse(named("depth", i, depth[i], " m: must be finite"));
  if (!std::isfinite(pressure[i])) {
    refuse(named("pressure", i, pressure[i], " Pa: must be finite"));
  }
  if (i == 0) {
    if (depth[0] != 0.0) refuse(named("depth", 0, depth[0], " m: must be 0"));
    if (pressure[0] != 0.0) refuse(named("pressure", 0, pressure[0], " Pa: must be 0"));
    return;
  }
  if (!(depth[i] > depth[i - 1])) {
    refuse(named("depth", i, depth[i], " m: must be greater than the one before, ") +
           short_text(depth[i - 1]) + " m");
  }
  if (!(pressure[i] >= pressure[i - 1])) {
    refuse(named("pressure", i, pressure[i], " Pa: must be at least the one before, ") +
           short_text(pressure[i - 1]) + " Pa");
  }
}

}  // namespace

TableLaw::TableLaw(std::vector<double> depth, std::vector<double> pressure)
    : depth_(std::move(depth)), pressure_(std::move(pressure)) {
  if (depth_.size() != pressure_.size()) {
    refuse(std::to_string(depth_.size()) + " depths and " + std::to_string(pressure_.size()) +
           " pressures: must be as many");
  }
  if (depth_.size() < 2) {
    refuse(std::to_string(depth_.size()) + " points: must be at least 2, the first (0, 0)");
  }
  energy_.assign(depth_.size(), 0.0);
  for (std::size_t i = 0; i < depth_.size(); ++i) {
    require_point(depth_, pressure_, i);
    if (i == 0) continue;
    const double mean = 0.5 * (pressure_[i - 1] + pressure_[i]);
    energy_[i] = energy_[i - 1] + mean * (depth_[i] - depth_[i - 1]);
  }
  if (!(pressure_.back() > 0.0)) refuse("every pressure is 0 Pa: the last must be greater than 0");
}

LawValue TableLaw::at(double d) const {
  // The segment that ends at or beyond d; the last one for all depths beyond.
  const auto found = std::lower_bound(depth_.begin() + 1, depth_.end() - 1, d);
  const auto end = static_cast<std::size_t>(found - depth_.begin());
  const std::size_t start = end - 1;
  const double slope = (pressure_[end] - pressure_[start]) / (depth_[end] - depth_[start]);
  const double t = d - depth_[start];
  return {energy_[start] + t * (pressure_[start] + 0.5 * t * slope), pressure_[start] + t * slope,
          slope};
}

}  // namespace condyle::contact
