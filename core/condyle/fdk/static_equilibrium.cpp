// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/static_equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/common/parallel.hpp"
#include "condyle/fdk/static_search.hpp"

namespace condyle::fdk {
namespace {

using detail::SampleState;

// Newton's steps before secants correct its slopes: where the stiffness is right, it has converged by then.
constexpr int kFirstCorrection = 3;

// Solves y + lever_s θx = touch_s − depth_s for both sides; false where the levers are alike.
bool intersect(const SideResponse& a, double depth_a, const SideResponse& b, double depth_b,
               SensitivePoint& p) {
  const double determinant = b.lever - a.lever;
  if (std::abs(determinant) < 1e-4) return false;
  const double rhs_a = a.y_touch - depth_a, rhs_b = b.y_touch - depth_b;
  p.theta_x = (rhs_b - rhs_a) / determinant;
  p.y = rhs_a - a.lever * p.theta_x;
  return std::isfinite(p.y) && std::isfinite(p.theta_x);
}

// One side alone carries the load: its depth gives Fy*, its arm Mx*.
bool single_sided(const SideResponse& side, double Fy, double Mx, SensitivePoint& p) {
  const double depth = side.depth_for(Fy);
  // y + lever θx = touch − depth;  arm_by_y (y − y0) + arm_by_θx (θx − θx0) = Mx/Fy − arm.
  const double missing = Mx / Fy - side.arm;
  const double by_theta_x = side.arm_by_theta_x - side.arm_by_y * side.lever;
  if (std::abs(by_theta_x) < 1e-6) return false;
  const double y_at_old_tilt = side.y_touch - depth - side.lever * side.at.theta_x;
  const double change = (missing - side.arm_by_y * (y_at_old_tilt - side.at.y)) / by_theta_x;
  p.theta_x = side.at.theta_x + change;
  p.y = y_at_old_tilt - side.lever * change;
  return std::isfinite(p.y) && std::isfinite(p.theta_x);
}

// Where both laws together carry (Fy*, Mx*). Fixed point over the arms, which depend weakly on (y, θx).
bool predict(const KneeResponse& sides, double Fy, double Mx, SensitivePoint& p) {
  const SideResponse& medial = sides[kMedial];
  const SideResponse& lateral = sides[kLateral];
  if (!medial.known || !lateral.known) {
    const SideResponse& only = medial.known ? medial : lateral;
    return only.known && single_sided(only, Fy, Mx, p);
  }
  double arm_m = medial.arm, arm_l = lateral.arm;
  for (int k = 0; k < 8; ++k) {
    const double spread = arm_m - arm_l;
    if (std::abs(spread) < 1e-4) return false;
    const double F_m = (Mx - arm_l * Fy) / spread;
    const double F_l = Fy - F_m;
    if (F_m < 0.0) return single_sided(lateral, Fy, Mx, p);
    if (F_l < 0.0) return single_sided(medial, Fy, Mx, p);
    if (!intersect(medial, medial.depth_for(F_m), lateral, lateral.depth_for(F_l), p)) return false;
    const double next_m = medial.arm_at(p), next_l = lateral.arm_at(p);
    const double change = std::abs(next_m - arm_m) + std::abs(next_l - arm_l);
    arm_m = next_m;
    arm_l = next_l;
    if (change < 1e-7) break;
  }
  return true;
}

// What was seen of a side at the evaluation before.
struct Seen {
  SensitivePoint p;
  double force = 0.0, arm = 0.0;
};

void observe(const SampleState& state, bool correct, KneeResponse& sides,
             std::array<Seen, kSides>& before) {
  for (int s = 0; s < kSides; ++s) {
    const Wrench& w = state.result.loads.wrench[s];
    SideResponse fitted = fit_side_response(state.result.pose, w, state.result.loads.stiffness[s]);
    if (fitted.known) {
      if (correct) fitted.match(before[s].p, before[s].force, before[s].arm);
      sides[s] = fitted;
      before[s] = {state.at(), w[1], w[3] / w[1]};
    } else {
      if (sides[s].known) sides[s].seen_unloaded(state.at());
      before[s] = {};
    }
  }
}

bool stable(const SampleState& state) { return state.reduced_rotational_stiffness() > 0.0; }

// Newton's steps on the local laws. True where the load is met on a stable branch.
bool iterate(SampleState& state, KneeResponse& sides, SensitivePoint p) {
  const StaticEquilibriumSettings& settings = state.settings;
  std::array<Seen, kSides> before;
  for (int k = 0; k <= settings.max_iterations; ++k) {
    state.evaluate(p);
    if (state.Fy_met() && state.Mx_met()) return stable(state);
    state.result.iterations = k + 1;
    observe(state, k >= kFirstCorrection, sides, before);
    SensitivePoint next;
    if (!predict(sides, state.load.Fy, state.load.Mx, next)) return false;
    // One factor on both: the direction is what the laws are right about.
    const double stretch =
        std::max(std::abs(next.y - p.y) / settings.max_newton_step_m,
                 std::abs(next.theta_x - p.theta_x) / settings.max_newton_step_rad);
    const double s = 1.0 / std::max(1.0, stretch);
    p = {p.y + s * (next.y - p.y), p.theta_x + s * (next.theta_x - p.theta_x)};
    if (std::abs(p.theta_x) > settings.max_theta_x || p.y < settings.touch.y_low ||
        p.y > settings.touch.y_high) {
      return false;
    }
  }
  return false;
}

void require_finite(const StaticLoad& load) {
  const auto check = [](double value, const char* field) {
    if (!std::isfinite(value)) {
      throw std::invalid_argument("static load: " + std::string(field) + " is " +
                                  std::to_string(value) + ": must be finite");
    }
  };
  check(load.x, "x");
  check(load.z, "z");
  check(load.theta_y, "theta_y");
  check(load.theta_z, "theta_z");
  check(load.Fy, "Fy");
  if (load.theta_x) {
    check(*load.theta_x, "theta_x");
  } else {
    check(load.Mx, "Mx");
  }
  if (load.start) {
    check(load.start->y, "start y");
    check(load.start->theta_x, "start theta_x");
  }
}

// First guess for a given θx: the higher of the two sides' y at the load, since that one touches first.
double y_at_tilt(const KneeResponse& sides, double theta_x, double Fy, double otherwise) {
  double y = -HUGE_VAL;
  for (const SideResponse& side : sides) {
    if (side.known) y = std::max(y, side.y_touch - side.lever * theta_x - side.depth_for(Fy));
  }
  return std::isfinite(y) ? y : otherwise;
}

}  // namespace

std::string_view name(EquilibriumStatus status) {
  switch (status) {
    case EquilibriumStatus::kConverged: return "converged";
    case EquilibriumStatus::kNoEquilibrium: return "no_equilibrium";
    case EquilibriumStatus::kOverclosure: return "overclosure";
    case EquilibriumStatus::kOffInsert: return "off_insert";
    case EquilibriumStatus::kNotConverged: return "not_converged";
  }
  return "unknown";
}

std::string_view advice(EquilibriumStatus status) {
  switch (status) {
    case EquilibriumStatus::kConverged:
      return "converged: Fy and Mx are within their tolerances";
    case EquilibriumStatus::kNoEquilibrium:
      return "statics: contact cannot carry this Mx with this Fy; reduce |Mx| or raise Fy";
    case EquilibriumStatus::kOverclosure:
      return "the load needs more than the plausible depth: reduce Fy, or check the pressure modulus";
    case EquilibriumStatus::kOffInsert:
      return "no touch found along y: check x, z and the angles, or widen y_low and y_high";
    case EquilibriumStatus::kNotConverged:
      return "not converged: raise max_evaluations, or give a start nearer the equilibrium";
  }
  return "unknown status";
}

void require_valid(const StaticEquilibriumSettings& settings) {
  const auto positive = [](double value, const char* setting) {
    if (!(std::isfinite(value) && value > 0.0)) {
      throw std::invalid_argument("static equilibrium settings: " + std::string(setting) + " is " +
                                  std::to_string(value) + ": must be finite and above 0");
    }
  };
  positive(settings.force_tolerance, "force_tolerance");
  positive(settings.force_relative_tolerance, "force_relative_tolerance");
  positive(settings.moment_tolerance, "moment_tolerance");
  positive(settings.moment_relative_tolerance, "moment_relative_tolerance");
  positive(settings.max_newton_step_m, "max_newton_step_m");
  positive(settings.max_newton_step_rad, "max_newton_step_rad");
  positive(settings.max_theta_x, "max_theta_x");
  positive(settings.greatest_moment_arm, "greatest_moment_arm");
  positive(settings.max_iterations, "max_iterations");
  positive(settings.max_evaluations, "max_evaluations");
  require_valid(settings.touch);
}

StaticEquilibriumSolver::StaticEquilibriumSolver(const contact::ContactModel& model,
                                                 const StaticEquilibriumSettings& settings)
    : model_(model), settings_((require_valid(settings), settings)), map_(model, settings.touch) {}

StaticEquilibrium StaticEquilibriumSolver::solve(const StaticLoad& load) const {
  require_finite(load);
  StaticEquilibrium result;
  SampleState state(model_, settings_, load, result);
  const bool tilt_given = load.theta_x.has_value();
  result.pose[kThetaX] = load.theta_x.value_or(0.0);
  // Statics before any contact evaluation: contact only pushes, and only within the insert.
  const double allowance = settings_.moment_tolerance * (1.0 + std::abs(load.Mx));
  if (!(load.Fy > 0.0) ||
      (!tilt_given &&
       std::abs(load.Mx) > settings_.greatest_moment_arm * load.Fy + allowance)) {
    result.status = EquilibriumStatus::kNoEquilibrium;
    return result;
  }

  KneeResponse sides = map_.at(load.x, load.theta_z);
  SensitivePoint start{0.0, load.theta_x.value_or(0.0)};
  bool started = false;
  if (load.start) {
    start = {load.start->y, load.theta_x.value_or(load.start->theta_x)};
    started = true;
  } else if (tilt_given) {
    start.y = y_at_tilt(sides, start.theta_x, load.Fy, 0.0);
    started = start.y != 0.0;
  } else {
    started = predict(sides, load.Fy, load.Mx, start) &&
              std::abs(start.theta_x) < settings_.max_theta_x &&
              start.y > settings_.touch.y_low && start.y < settings_.touch.y_high;
  }
  if (!started) {  // outside the map, or a side that never touches there
    start.theta_x = load.theta_x.value_or(0.0);
    result.pose[kThetaX] = start.theta_x;
    result.evaluations += descend_to_contact(model_, settings_.touch, result.pose, result.loads);
    start.y = result.pose[kY];
    if (!(result.loads.total_wrench()[1] > 0.0)) {
      result.status = EquilibriumStatus::kOffInsert;
      return result;
    }
  }

  if (tilt_given) {
    result.status = detail::solve_y(state, start);
  } else if (iterate(state, sides, start)) {
    result.status = EquilibriumStatus::kConverged;
  } else {
    result.searched = true;
    // Go on from Newton's last point if that is on the stable branch, else from the middle.
    const bool usable = state.Fy_residual() > -load.Fy && stable(state);
    result.status =
        detail::search_theta_x(state, usable ? state.at() : SensitivePoint{start.y, 0.0});
  }
  if (result.status == EquilibriumStatus::kConverged && result.loads.implausible_depth) {
    result.status = EquilibriumStatus::kOverclosure;
  }
  return result;
}

std::vector<StaticEquilibrium> StaticEquilibriumSolver::solve_batch(
    std::span<const StaticLoad> loads, int threads) const {
  std::vector<StaticEquilibrium> results(loads.size());
  parallel_for(loads.size(), threads, [&](std::size_t i) {
    try {
      results[i] = solve(loads[i]);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("row " + std::to_string(i) + ": " + error.what());
    }
  });
  return results;
}

}  // namespace condyle::fdk
