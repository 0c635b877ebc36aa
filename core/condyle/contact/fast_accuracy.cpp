// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_accuracy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "condyle/common/parallel.hpp"

namespace condyle::contact {
namespace {

constexpr double kShare = 0.002, kForce = 0.5, kMoment = 0.02;  // the tolerance
constexpr double kLeastForce = 20.0;  // below, a relative error says nothing
constexpr std::array kLimits = {20.0, 60.0, 200.0, 600.0, 2000.0, 3500.0};

void require(bool holds, const char* name, double value, const char* limit) {
  if (holds) return;
  throw std::invalid_argument("plausible poses: " + std::string(name) + " is " +
                              std::to_string(value) + ": must be " + limit);
}

// Moves `pose` along y until the total Fy is `force`, to 1 %; false if it never is.
bool press(const ContactModel& model, double force, Pose& pose) {
  const auto carried = [&](double y) {
    pose[kY] = y;
    return model.evaluate(pose, Derivatives::kNone).total_wrench()[kY];
  };
  // Walked to from where it is, in steps smaller than what a condyle may sink in, so that the force
  // is monotonic over the last one; 30 mm either way is more than a femur's origin rises with
  // flexion.
  constexpr double kStep = 1e-3;
  constexpr int kSteps = 30;
  const double y = pose[kY];
  const bool down = carried(y) < force;
  double high = y, low = y;
  for (int i = 1; i <= kSteps; ++i) {
    (down ? low : high) = y + (down ? -i : i) * kStep;
    if ((carried(down ? low : high) < force) != down) break;
    if (i == kSteps) return false;
    (down ? high : low) = down ? low : high;
  }
  for (int i = 0; i < 30; ++i) {
    const double now = carried(0.5 * (low + high));
    if (std::abs(now - force) < 0.01 * force) return true;
    (now > force ? low : high) = pose[kY];
  }
  return false;
}

struct Deviation {
  double force = 0.0, moment = 0.0, of_force = 0.0, of_moment = 0.0;

  Deviation() = default;
  Deviation(const Wrench& fast, const Wrench& exact)
      : force((fast - exact).head<3>().norm()),
        moment((fast - exact).tail<3>().norm()),
        of_force(exact.head<3>().norm()),
        of_moment(exact.tail<3>().norm()) {}

  bool loaded() const { return of_force > 0.0 || force > 0.0; }
  double force_ratio() const { return force / (kShare * of_force + kForce); }
  double moment_ratio() const { return moment / (kShare * of_moment + kMoment); }
};

struct PoseDeviation {
  std::array<Deviation, kSides> sides;
  Deviation total;
};

// The p-quantile, by rank; 0 of nothing.
double quantile(const std::vector<double>& sorted, double p) {
  if (sorted.empty()) return 0.0;
  return sorted[static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1) + 0.5)];
}

Deviations summary(std::vector<double> relative, std::vector<double> ratio) {
  std::sort(relative.begin(), relative.end());
  std::sort(ratio.begin(), ratio.end());
  return {quantile(relative, 0.5), quantile(relative, 0.99), quantile(relative, 1.0),
          quantile(ratio, 0.99), quantile(ratio, 1.0)};
}

// Gathers wrenches, each with its pose.
class Gathered {
 public:
  void add(const Deviation& d, const Pose& pose) {
    if (!d.loaded()) return;
    force_ratio_.push_back(d.force_ratio());
    moment_ratio_.push_back(d.moment_ratio());
    const double worst = std::max(d.force_ratio(), d.moment_ratio());
    if (worst > worst_) {
      worst_ = worst;
      result_.worst_pose = pose;
    }
    if (d.of_force < kLeastForce) return;
    force_.push_back(d.force / d.of_force);
    moment_.push_back(d.moment / d.of_moment);
  }

  WrenchDeviations result() const {
    WrenchDeviations result = result_;
    result.count = static_cast<int>(force_ratio_.size());
    result.force = summary(force_, force_ratio_);
    result.moment = summary(moment_, moment_ratio_);
    return result;
  }

 private:
  std::vector<double> force_, moment_, force_ratio_, moment_ratio_;
  double worst_ = 0.0;
  WrenchDeviations result_;
};

// Sides and totals of the poses whose total force lies in [from, to).
LoadRange range_of(const std::vector<PoseDeviation>& all, const std::vector<Pose>& poses,
                   double from, double to) {
  Gathered sides, total;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].total.of_force < from || all[i].total.of_force >= to) continue;
    for (const Deviation& side : all[i].sides) sides.add(side, poses[i]);
    total.add(all[i].total, poses[i]);
  }
  return {from, to, sides.result(), total.result()};
}

}  // namespace

std::vector<Pose> plausible_poses(const ContactModel& model, const PlausiblePoses& settings,
                                  int threads) {
  require(settings.count >= 1, "count", settings.count, "at least 1");
  require(settings.lowest_force > 0.0, "lowest_force", settings.lowest_force, "positive");
  require(settings.highest_force >= settings.lowest_force, "highest_force", settings.highest_force,
          "at least lowest_force");
  std::mt19937_64 engine(settings.seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1.0p-53);
  };
  std::vector<Pose> poses(static_cast<std::size_t>(settings.count));
  std::vector<double> forces;
  for (Pose& pose : poses) {
    pose = settings.settled;
    pose[kX] += draw(-settings.x, settings.x);
    pose[kZ] += draw(-settings.z, settings.z);
    pose[kThetaX] = draw(-settings.theta_x, settings.theta_x);
    pose[kThetaY] = draw(-settings.theta_y, settings.theta_y);
    pose[kThetaZ] = -draw(0.0, settings.flexion);
    forces.push_back(
        std::exp(draw(std::log(settings.lowest_force), std::log(settings.highest_force))));
  }
  std::vector<unsigned char> carries(poses.size());  // one byte each, for many threads
  parallel_for(poses.size(), threads,
               [&](std::size_t i) { carries[i] = press(model, forces[i], poses[i]); });
  std::vector<Pose> found;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (carries[i] != 0) found.push_back(poses[i]);
  }
  return found;
}

AccuracyReport measure_accuracy(const ContactModel& fast, const ContactModel& exact,
                                const std::vector<Pose>& poses, int threads) {
  std::vector<PoseDeviation> all(poses.size());
  parallel_for(poses.size(), threads, [&](std::size_t i) {
    const ContactLoads a = fast.evaluate(poses[i], Derivatives::kNone);
    const ContactLoads b = exact.evaluate(poses[i], Derivatives::kNone);
    for (const Side side : {kMedial, kLateral}) {
      all[i].sides[side] = Deviation(a.wrench[side], b.wrench[side]);
    }
    all[i].total = Deviation(a.total_wrench(), b.total_wrench());
  });
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const LoadRange whole = range_of(all, poses, 0.0, kAny);
  AccuracyReport report{whole.sides, whole.total, {}};
  for (std::size_t i = 0; i + 1 < kLimits.size(); ++i) {
    const bool first = i == 0, last = i + 2 == kLimits.size();
    LoadRange range = range_of(all, poses, first ? 0.0 : kLimits[i], last ? kAny : kLimits[i + 1]);
    range.from = kLimits[i];
    range.to = kLimits[i + 1];
    report.by_load.push_back(range);
  }
  return report;
}

}  // namespace condyle::contact
