// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "condyle/common/parallel.hpp"

namespace condyle::contact {
namespace {

void require(bool holds, const char* name, double value, const char* limit) {
  if (holds) return;
  throw std::invalid_argument("plausible poses: " + std::string(name) + " is " +
                              std::to_string(value) + ": must be " + limit);
}

double total_force(const FaceEvaluation& contact, const Pose& pose) {
  double force = 0.0;
  for (const Side side : {kMedial, kLateral}) {
    force += contact.evaluate(pose, side, Derivatives::kNone).wrench[1];
  }
  return force;
}

// The p-quantile, by rank; 0 of nothing.
double quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace

std::vector<Pose> plausible_poses(const FaceEvaluation& contact, const PlausiblePoses& settings) {
  require(settings.count >= 1, "count", settings.count, "at least 1");
  require(settings.lowest_force > 0.0, "lowest_force", settings.lowest_force, "positive");
  require(settings.highest_force >= settings.lowest_force, "highest_force", settings.highest_force,
          "at least lowest_force");
  std::mt19937_64 engine(settings.seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1.0p-53);
  };
  std::vector<Pose> poses(static_cast<std::size_t>(settings.count));
  for (Pose& pose : poses) {
    pose = settings.settled;
    pose[kX] += draw(-settings.x, settings.x);
    pose[kZ] += draw(-settings.z, settings.z);
    pose[kThetaX] = draw(-settings.theta_x, settings.theta_x);
    pose[kThetaY] = draw(-settings.theta_y, settings.theta_y);
    pose[kThetaZ] = -draw(0.0, settings.flexion);
    const double force =
        std::exp(draw(std::log(settings.lowest_force), std::log(settings.highest_force)));
    // 10 mm either way holds the contact's height over the whole box; 30 halvings end at 20 pm.
    double low = settings.settled[kY] - 0.01, high = settings.settled[kY] + 0.01;
    for (int i = 0; i < 30; ++i) {
      pose[kY] = 0.5 * (low + high);
      const double now = total_force(contact, pose);
      if (std::abs(now - force) < 0.01 * force) break;
      (now > force ? low : high) = pose[kY];
    }
  }
  return poses;
}

AccuracyReport measure_accuracy(const FaceEvaluation& fast, const FaceEvaluation& exact,
                                const std::vector<Pose>& poses, int threads) {
  struct Deviation {
    double force, moment, of_force, of_moment;
  };
  std::vector<std::array<Deviation, kSides>> all(poses.size());
  parallel_for(poses.size(), threads, [&](std::size_t i) {
    for (const Side side : {kMedial, kLateral}) {
      const Wrench w = exact.evaluate(poses[i], side, Derivatives::kNone).wrench;
      const Wrench d = fast.evaluate(poses[i], side, Derivatives::kNone).wrench - w;
      all[i][side] = {d.head<3>().norm(), d.tail<3>().norm(), w.head<3>().norm(),
                      w.tail<3>().norm()};
    }
  });
  AccuracyReport report;
  std::vector<double> force, moment, force_ratio, moment_ratio;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Deviation& d : all[i]) {
      if (d.of_force == 0.0 && d.force == 0.0) continue;
      ++report.sides;
      force_ratio.push_back(d.force / (0.002 * d.of_force + 0.5));
      moment_ratio.push_back(d.moment / (0.002 * d.of_moment + 0.02));
      const double worst = std::max(force_ratio.back(), moment_ratio.back());
      if (worst > report.worst) {
        report.worst = worst;
        report.worst_pose = poses[i];
      }
      if (d.of_force < 20.0) continue;
      force.push_back(d.force / d.of_force);
      moment.push_back(d.moment / d.of_moment);
    }
  }
  report.force_median = quantile(force, 0.5);
  report.force_p99 = quantile(force, 0.99);
  report.moment_median = quantile(moment, 0.5);
  report.moment_p99 = quantile(moment, 0.99);
  report.force_tolerance_p99 = quantile(force_ratio, 0.99);
  report.moment_tolerance_p99 = quantile(moment_ratio, 0.99);
  return report;
}

}  // namespace condyle::contact
