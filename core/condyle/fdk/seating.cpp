// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/seating.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace condyle::fdk {
namespace {

using contact::ContactLoads;
using contact::Derivatives;

constexpr double kTrusted = 0.5;
constexpr std::array<double, 4> kLighter{0.3, 0.1, 0.03, 0.01};  // shares of the settled pose's force
constexpr double kLongestUnloading = 1e-3;  // [m] along x and z, from one share to the next
constexpr int kPolls = 12;            // directions of a ring: 30° apart
constexpr double kShrink = 0.6;       // of the ring that found nothing lower
constexpr int kMostRounds = 400;      // never reached: a ring moves on a few times, then shrinks
constexpr int kDisc = 500;            // points: 0.04 mm apart in a disc of 0.5 mm radius
constexpr double kRim = 0.8;          // of the disc's radius: beyond it, its lowest point may not be the dish's
constexpr double kRing = 0.08;        // of the disc's radius: the spacing of its points
const double kGolden = std::numbers::pi * (3.0 - std::sqrt(5.0));  // turns each ring to new directions

void require_positive(const char* setting, double value) {
  if (std::isfinite(value) && value > 0.0) return;
  throw std::invalid_argument("seating: " + std::string(setting) + " is " + std::to_string(value) +
                              ": must be finite and above 0");
}

void require_valid(const SeatingSettings& settings) {
  require_valid(settings.settle.touch);
  require_positive("farthest", settings.farthest);
  require_positive("tolerance", settings.tolerance);
  require_positive("disc_radius", settings.disc_radius);
  require_positive("last_radius", settings.last_radius);
  require_positive("least_slope", settings.least_slope);
  require_positive("longest_way", settings.longest_way);
}

// A model whose evaluations are counted, asked only whether it carries load.
class Probe {
 public:
  explicit Probe(const contact::ContactModel& model) : model_(model) {}

  bool loaded(Pose pose, double y) {
    pose[kY] = y;
    const ContactLoads loads = model_.evaluate(pose, Derivatives::kNone);
    ++evaluations;
    trusted = loads.trust >= kTrusted;
    return trusted && loads.total_wrench().squaredNorm() > 0.0;
  }

  int evaluations = 0;
  bool trusted = true;  ///< the last answer

 private:
  const contact::ContactModel& model_;
};

// Halves [loaded, free] to the tolerance; returns the loaded end.
double bisect(Probe& probe, const Pose& pose, double loaded, double free, double tolerance) {
  while (free - loaded > tolerance) {
    const double middle = 0.5 * (loaded + free);
    if (middle == loaded || middle == free) break;
    (probe.loaded(pose, middle) ? loaded : free) = middle;
  }
  return loaded;
}

// First touch at (x, z) of `pose`, known to lie below its y by less than `reach`; −∞ if it does not.
double touch_below(Probe& probe, const Pose& pose, double reach, const SeatingSettings& settings) {
  double free = pose[kY];
  for (double step = 16 * settings.tolerance; pose[kY] - free < reach; step *= 2.0) {
    const double next = free - std::min(step, settings.settle.touch.step);
    if (probe.loaded(pose, next)) return bisect(probe, pose, next, free, settings.tolerance);
    free = next;
  }
  return -HUGE_VAL;
}

// Moves `lowest` to a point at (dx, dz) from `centre` if contact begins lower there, by more than level ground would have
// it; false if there is no contact at all.
bool poll(Probe& probe, const SeatingSettings& settings, const Pose& centre, double dx, double dz,
          Pose& lowest) {
  Pose at = centre;
  at[kX] += dx;
  at[kZ] += dz;
  const double way = std::hypot(at[kX] - lowest[kX], at[kZ] - lowest[kZ]);
  at[kY] = lowest[kY] - std::max(settings.least_slope * way, 2.0 * settings.tolerance);
  if (probe.loaded(at, at[kY])) return true;
  at[kY] = touch_below(probe, at, settings.longest_way, settings);
  if (!std::isfinite(at[kY])) return false;
  lowest = at;
  return true;
}

// Sinks from `pose`, a first touch, to the lowest one within reach: a disc of points evenly spread, moved as long as its
// lowest is near its rim, finds the facet; rings that shrink find the lowest point on it.
SeatingStatus sink(Probe& probe, const SeatingSettings& settings, Pose& pose) {
  const Pose start = pose;
  for (bool at_rim = true; at_rim;) {
    const Pose centre = pose;
    for (int k = 0; k < kDisc; ++k) {
      const double r = settings.disc_radius * std::sqrt((k + 0.5) / kDisc);  // Vogel's sunflower
      if (!poll(probe, settings, centre, r * std::cos(k * kGolden), r * std::sin(k * kGolden), pose)) {
        return SeatingStatus::kSlidesOff;
      }
    }
    const double way = std::hypot(pose[kX] - centre[kX], pose[kZ] - centre[kZ]);
    at_rim = way > kRim * settings.disc_radius;
    if (std::hypot(pose[kX] - start[kX], pose[kZ] - start[kZ]) > settings.longest_way) {
      return SeatingStatus::kSlidesOff;
    }
  }
  double radius = settings.disc_radius * kRing, turn = 0.0;
  for (int round = 0; radius > settings.last_radius && round < kMostRounds; ++round) {
    const Pose centre = pose;
    for (int k = 0; k < kPolls; ++k) {
      const double angle = turn + k * (2.0 * std::numbers::pi / kPolls);
      if (!poll(probe, settings, centre, radius * std::cos(angle), radius * std::sin(angle), pose)) {
        return SeatingStatus::kSlidesOff;
      }
    }
    turn += kGolden;
    if (pose[kY] == centre[kY]) radius *= kShrink;
  }
  return SeatingStatus::kConverged;
}

void require_finite_flexion(double flexion) {
  if (std::isfinite(flexion)) return;
  throw std::invalid_argument("seating: flexion is " + std::to_string(flexion) +
                              ": must be finite [rad]");
}

// The settings of the way to the dish, their range of y moved to an insert that lies outside it.
SettleSettings within_reach(const contact::ContactModel& model, const Pose& middle,
                            const SeatingSettings& settings, int& evaluations) {
  SettleSettings settle = settings.settle;
  FirstTouch touch;
  for (const double x : {0.0, 0.015, -0.015, 0.03, -0.03}) {
    Pose pose = middle;
    pose[kX] = x;
    touch = first_touch(model, pose, settings);
    evaluations += touch.evaluations;
    if (touch.status != SeatingStatus::kNoContact) break;
  }
  const double y = touch.pose[kY];
  if (touch.converged() && (y > settle.touch.y_high || y < settle.touch.y_low)) {
    const double half = 0.5 * (settle.touch.y_high - settle.touch.y_low);
    settle.touch.y_high = y + half;
    settle.touch.y_low = y - half;
  }
  return settle;
}

// The settled pose under ever less force: near the end of the way to none. On facets an equilibrium of a few newtons has
// no smooth surface left to rest on, so the way ends where the next one is not found near the last.
Pose unload(const contact::ContactModel& model, const SettledPose& settled,
            const SettleSettings& settings, int& evaluations) {
  Pose pose = settled.pose;
  if (!settled.converged()) return pose;
  SettleSettings lighter = settings;
  for (const double share : kLighter) {
    lighter.axial_force = share * settings.axial_force;
    lighter.newton.force_tolerance = std::min(settings.newton.force_tolerance, 1e-3 * lighter.axial_force);
    const SettledPose next = settle_from(model, pose, lighter);
    evaluations += next.evaluations;
    const double way = std::hypot(next.pose[kX] - pose[kX], next.pose[kZ] - pose[kZ]);
    if (!next.converged() || way > kLongestUnloading) break;
    pose = next.pose;
  }
  return pose;
}

}  // namespace

std::string_view name(SeatingStatus status) {
  switch (status) {
    case SeatingStatus::kConverged: return "converged";
    case SeatingStatus::kNoContact: return "no_contact";
    case SeatingStatus::kNoClearance: return "no_clearance";
    case SeatingStatus::kUntrusted: return "untrusted";
    case SeatingStatus::kSlidesOff: return "slides_off";
  }
  return "unknown";
}

std::string_view advice(SeatingStatus status) {
  switch (status) {
    case SeatingStatus::kConverged: return "Contact begins here.";
    case SeatingStatus::kNoContact:
      return "The femur passes the insert without touching it: check the two frames' origins, and which way is up.";
    case SeatingStatus::kNoClearance:
      return "The femur is in contact however high: check the two frames' origins, and which way is up.";
    case SeatingStatus::kUntrusted:
      return "The model does not know the poses above contact: seat on the reference contact instead.";
    case SeatingStatus::kSlidesOff:
      return "The femur finds no lowest place on the insert: check that the insert is dished, and the flexion.";
  }
  return "";
}

FirstTouch first_touch(const contact::ContactModel& model, const Pose& pose,
                       const SeatingSettings& settings) {
  require_valid(settings);
  const TouchSearch& touch = settings.settle.touch;
  FirstTouch found;
  found.pose = pose;
  Pose held = pose;
  held[kY] = 0.0;
  contact::require_finite(held);
  Probe probe(model);

  // Up until clear, should the insert reach above the usual range.
  double free = touch.y_high;
  while (probe.loaded(held, free)) {
    free += 4 * touch.step;
    if (free < settings.farthest) continue;
    found.status = SeatingStatus::kNoClearance;
    found.evaluations = probe.evaluations;
    return found;
  }
  bool trusted = probe.trusted;
  for (double y = free - touch.step; y > -settings.farthest; y -= touch.step) {
    if (probe.loaded(held, y)) {
      found.pose[kY] = bisect(probe, held, y, free, settings.tolerance);
      found.status = trusted ? SeatingStatus::kConverged : SeatingStatus::kUntrusted;
      break;
    }
    trusted = probe.trusted;
    free = y;
  }
  found.evaluations = probe.evaluations;
  return found;
}

SeatedPose seated_pose(const contact::ContactModel& model, double flexion,
                       const SeatingSettings& settings) {
  require_valid(settings);
  require_finite_flexion(flexion);
  SeatedPose seat;
  seat.pose[kThetaZ] = -flexion;
  const SettleSettings settle = within_reach(model, seat.pose, settings, seat.evaluations);
  const SettledPose settled = settled_pose(model, flexion, settle);
  const Pose resting = unload(model, settled, settle, seat.evaluations);
  const FirstTouch touch = first_touch(model, resting, settings);
  seat.pose = touch.pose;
  seat.status = touch.status;
  seat.evaluations += settled.evaluations + touch.evaluations;
  if (!touch.converged()) return seat;
  Probe probe(model);
  seat.status = sink(probe, settings, seat.pose);
  seat.evaluations += probe.evaluations;
  return seat;
}

}  // namespace condyle::fdk
