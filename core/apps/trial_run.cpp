// SPDX-License-Identifier: Apache-2.0
#include "trial_run.hpp"

#include <algorithm>
#include <cmath>

namespace condyle::apps {
namespace {

/// The largest of a curve over the time frames in equilibrium.
template <typename Curve>
std::optional<Peak> peak_of(const TrialRun& run, std::string name, const Curve& curve) {
  std::optional<Peak> peak;
  for (std::size_t i = 0; i < run.times.size(); ++i) {
    if (!run.simulation.records[i].converged()) continue;
    const double value = curve(static_cast<Eigen::Index>(i));
    if (!peak || value > peak->value) peak = Peak{name, value, run.times[i]};
  }
  return peak;
}

}  // namespace

std::vector<double> scaled_residuals(const TrialRun& run) {
  const numerics::NewtonSettings& newton = run.settings.solver.newton;
  std::vector<double> scaled;
  for (const fdk::ForceDependentRecord& record : run.simulation.records) {
    double largest = 0.0;
    for (Eigen::Index a = 0; a < record.residual.size(); ++a) {
      const int c = run.simulation.force_dependent[static_cast<std::size_t>(a)];
      const auto& coordinate = run.model.description().coordinates[static_cast<std::size_t>(c)];
      const double tolerance =
          coordinate.rotational ? newton.moment_tolerance : newton.force_tolerance;
      const double now = std::abs(record.residual[a] / tolerance);
      // NaN is the largest there is.
      if (!(now <= largest)) largest = now;
    }
    scaled.push_back(largest);
  }
  return scaled;
}

const char* peak_load(const TrialContact& contact) { return contact.one_sided ? "|F|" : "Fy"; }

std::vector<Peak> contact_peaks(const TrialRun& run, std::size_t c) {
  const auto wrench = [&](Eigen::Index row, Side side) {
    const auto first = static_cast<Eigen::Index>(12 * c + 6 * side);
    return Wrench(run.simulation.contact_wrenches.row(row).segment<6>(first).transpose());
  };
  const auto total = [&](Eigen::Index row) {
    const Wrench sum = wrench(row, kMedial) + wrench(row, kLateral);
    return run.contacts[c].one_sided ? sum.head<3>().norm() : sum[1];
  };
  std::vector<Peak> peaks;
  if (const auto peak = peak_of(run, "total", total)) peaks.push_back(*peak);
  if (run.contacts[c].one_sided) return peaks;
  for (const Side side : {kMedial, kLateral}) {
    const auto one = [&](Eigen::Index row) { return wrench(row, side)[1]; };
    if (const auto peak = peak_of(run, std::string(name(side)), one)) peaks.push_back(*peak);
  }
  return peaks;
}

std::optional<Peak> largest(const TrialRun& run, const fdk::TimeFrames& table,
                            std::span<const std::string> names) {
  std::optional<Peak> peak;
  for (std::size_t i = 0; i < run.times.size(); ++i) {
    if (!run.simulation.records[i].converged()) continue;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const double value = table(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      if (!peak || std::abs(value) > std::abs(peak->value)) {
        peak = Peak{names[k], value, run.times[i]};
      }
    }
  }
  return peak;
}

}  // namespace condyle::apps
