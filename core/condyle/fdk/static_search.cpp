// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/static_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::fdk::detail {
namespace {

constexpr int kFy = 1, kMx = 3;
constexpr double kTrusted = 0.5;
// Below this y-bracket the load cannot be resolved: 1e-11 m × 1e7 N/m = 1e-4 N.
constexpr double kLeastBracket = 1e-12;

// Where the laws of the loaded sides carry `force` at this θx; NaN if no side is loaded.
double y_by_law(const SampleState& state, double force) {
  KneeResponse sides;
  double high = -HUGE_VAL;
  for (int s = 0; s < kSides; ++s) {
    sides[s] = fit_side_response(state.result.pose, state.result.loads.wrench[s],
                                 state.result.loads.stiffness[s]);
    if (sides[s].known) high = std::max(high, sides[s].y_touch - sides[s].lever * state.at().theta_x);
  }
  if (!std::isfinite(high)) return std::numeric_limits<double>::quiet_NaN();
  // The sum of the two laws rises as y falls: bisect it, which costs no contact evaluation.
  double low = high;
  const auto carried = [&](double y) {
    double sum = 0.0;
    for (const SideResponse& side : sides) {
      if (side.known) sum += side.force({y, state.at().theta_x});
    }
    return sum;
  };
  for (double reach = 1e-4; carried(low) < force && reach < 0.1; reach *= 2.0) low = high - reach;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (carried(middle) < force ? high : low) = middle;
  }
  return low;
}

}  // namespace

SampleState::SampleState(const contact::ContactModel& model_, const StaticEquilibriumSettings& s,
                         const StaticLoad& load_, StaticEquilibrium& result_)
    : model(model_), settings(s), load(load_), result(result_) {
  result.pose = Pose::Zero();
  result.pose[kX] = load.x;
  result.pose[kZ] = load.z;
  result.pose[kThetaY] = load.theta_y;
  result.pose[kThetaZ] = load.theta_z;
}

void SampleState::evaluate(const SensitivePoint& p) {
  result.pose[kY] = p.y;
  result.pose[kThetaX] = p.theta_x;
  result.loads = model.evaluate(result.pose, contact::Derivatives::kStiffness);
  ++result.evaluations;
}

bool SampleState::Fy_met() const {
  return std::abs(Fy_residual()) <=
         settings.force_relative_tolerance * std::abs(load.Fy) + settings.force_tolerance;
}

bool SampleState::Mx_met() const {
  return load.theta_x.has_value() ||
         std::abs(Mx_residual()) <=
             settings.moment_relative_tolerance * std::abs(load.Mx) + settings.moment_tolerance;
}

double SampleState::reduced_rotational_stiffness() const {
  const Matrix6 S = result.loads.total_stiffness();
  if (!(S(kFy, kY) < 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return S(kMx, kThetaX) - S(kMx, kY) * S(kFy, kThetaX) / S(kFy, kY);
}

EquilibriumStatus solve_y(SampleState& state, SensitivePoint p, double slack) {
  const StaticEquilibriumSettings& settings = state.settings;
  double too_low = -HUGE_VAL, too_high = HUGE_VAL;  // y that carries more, less than Fy*
  double reach = settings.touch.step;
  while (!state.spent()) {
    state.evaluate(p);
    if (state.Fy_met() || std::abs(state.Fy_residual()) <= slack * state.load.Fy) {
      return EquilibriumStatus::kConverged;
    }
    const bool short_of_load = state.Fy_residual() < 0.0;
    if (short_of_load && state.result.loads.implausible_depth) return EquilibriumStatus::kOverclosure;
    (short_of_load ? too_high : too_low) = p.y;
    if (too_high - too_low < kLeastBracket) return EquilibriumStatus::kNotConverged;

    const bool bracketed = std::isfinite(too_high) && std::isfinite(too_low);
    double y = y_by_law(state, state.load.Fy);
    if (!std::isfinite(y)) y = p.y - reach;  // out of contact: down
    if (bracketed) {
      // A law that keeps pointing at one end is of no use; stay off the ends by a tenth.
      const double margin = 0.1 * (too_high - too_low);
      const bool beside = !(y > too_low && y < too_high);
      if (beside) y = 0.5 * (too_low + too_high);
      if (state.result.evaluations % 4 == 3) y = std::clamp(y, too_low + margin, too_high - margin);
    } else {
      y = std::clamp(y, p.y - settings.max_newton_step_m, p.y + settings.max_newton_step_m);
    }
    if (y < settings.touch.y_low) return EquilibriumStatus::kOffInsert;
    if (y > settings.touch.y_high) y = settings.touch.y_high;
    p.y = y;
  }
  return EquilibriumStatus::kNotConverged;
}

namespace {

// While marching, Fy need only be near: Mx/Fy is what counts, and it hardly depends on the depth.
constexpr double kMarchSlack = 0.05;

struct Along {  // a point of Mx(θx) at Fy*
  SensitivePoint p;
  double gap = 0.0;    // signed Mx still missing in the direction of the march, scaled to Fy* [Nm]
  double slope = 0.0;  // of Mx along the march [Nm/rad]
};

class March {
 public:
  explicit March(SampleState& state) : state_(state) {}

  EquilibriumStatus run(SensitivePoint start) {
    Along here;
    EquilibriumStatus status = point(start, here, kMarchSlack);
    if (status != EquilibriumStatus::kConverged || met()) return status;
    direction_ = here.gap > 0.0 ? 1.0 : -1.0;
    here = described(here.p);
    double step = 0.003;
    for (;;) {
      // Newton's length where the slope gives one, stretched a little to bracket; never more than three times the last.
      double length = here.slope > 0.0 ? 1.3 * here.gap / here.slope : step;
      length = std::clamp(length, 1e-5, 3.0 * step);
      step = std::clamp(length, 1e-3, state_.settings.max_newton_step_rad);
      Along next;
      status = point(ahead(here, std::min(length, step)), next, kMarchSlack);
      if (status == EquilibriumStatus::kOverclosure) return status;
      // Off the insert or past the limit of the search: tilting further carries nothing more.
      const double left = state_.settings.max_theta_x - direction_ * next.p.theta_x;
      if (status == EquilibriumStatus::kOffInsert || left < 0.0) {
        return EquilibriumStatus::kNoEquilibrium;
      }
      if (status != EquilibriumStatus::kConverged || met()) return status;
      if (next.gap <= 0.0) return close_in(here, next);
      if (here.slope > 0.0 && next.slope <= 0.0) return over_the_top(here, next);
      if (next.slope <= 0.0 && next.gap > here.gap) return EquilibriumStatus::kNoEquilibrium;
      // Past lift-off Mx flattens: three times the slope over all the tilt left is a generous bound.
      if (lifted_off() && next.gap > 3.0 * std::max(next.slope, 0.0) * left) {
        return EquilibriumStatus::kNoEquilibrium;
      }
      here = next;
    }
  }

 private:
  bool met() const { return state_.Fy_met() && state_.Mx_met(); }
  bool lifted_off() const {
    const auto& wrench = state_.result.loads.wrench;
    return !(wrench[kMedial][kFy] > 0.0) || !(wrench[kLateral][kFy] > 0.0);
  }

  // y at the new θx that keeps Fy, to first order: −∂Fy/∂θx / ∂Fy/∂y.
  SensitivePoint ahead(const Along& from, double length) const {
    const Matrix6 S = state_.result.loads.total_stiffness();
    SensitivePoint p = from.p;
    const double change = direction_ * length;
    if (S(kFy, kY) < 0.0) p.y -= change * S(kFy, kThetaX) / S(kFy, kY);
    p.theta_x += change;
    return p;
  }

  EquilibriumStatus point(const SensitivePoint& p, Along& along, double slack) {
    const EquilibriumStatus status = solve_y(state_, p, slack);
    along = described(state_.at());
    return status;
  }

  Along described(const SensitivePoint& p) const {
    const Wrench w = state_.result.loads.total_wrench();
    const double Mx = w[kFy] > 0.0 ? w[kMx] / w[kFy] * state_.load.Fy : 0.0;
    return {p, direction_ * (state_.load.Mx - Mx), state_.reduced_rotational_stiffness()};
  }

  // Mx* lies between two points: regula falsi, halving whenever an end stays.
  EquilibriumStatus close_in(Along before, Along after) {
    for (int k = 0; !state_.spent(); ++k) {
      const double width = after.p.theta_x - before.p.theta_x;
      if (std::abs(width) < 1e-11) break;
      const double falsi = before.gap / (before.gap - after.gap);
      const double share = k % 3 == 2 ? 0.5 : std::clamp(falsi, 0.02, 0.98);
      const SensitivePoint p{before.p.y + share * (after.p.y - before.p.y),
                             before.p.theta_x + share * width};
      Along middle;
      const EquilibriumStatus status = point(p, middle, 0.0);
      if (status != EquilibriumStatus::kConverged || met()) return status;
      (middle.gap > 0.0 ? before : after) = middle;
    }
    return EquilibriumStatus::kNotConverged;
  }

  // Mx has its largest value between two points and reaches Mx* at neither: look for it by the slope's sign.
  EquilibriumStatus over_the_top(Along before, Along after) {
    for (int k = 0; k < 8 && !state_.spent(); ++k) {
      const double rise = before.slope, fall = -after.slope;
      const double share = std::clamp(rise / (rise + fall), 0.1, 0.9);
      Along middle;
      const EquilibriumStatus status =
          point({before.p.y + share * (after.p.y - before.p.y),
                 before.p.theta_x + share * (after.p.theta_x - before.p.theta_x)},
                middle, kMarchSlack);
      if (status != EquilibriumStatus::kConverged || met()) return status;
      if (middle.gap <= 0.0) return close_in(before, middle);
      // What the slopes still allow between the ends is not enough: beyond the limit of statics.
      const double width = std::abs(after.p.theta_x - before.p.theta_x);
      if (middle.gap > std::max(rise, fall) * width) break;
      (middle.slope > 0.0 ? before : after) = middle;
    }
    return EquilibriumStatus::kNoEquilibrium;
  }

  SampleState& state_;
  double direction_ = 1.0;
};

}  // namespace

EquilibriumStatus search_theta_x(SampleState& state, SensitivePoint start) {
  return March(state).run(start);
}

}  // namespace condyle::fdk::detail
