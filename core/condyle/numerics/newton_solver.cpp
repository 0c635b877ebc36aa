// SPDX-License-Identifier: Apache-2.0
#include "condyle/numerics/newton_solver.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace condyle::numerics {
namespace {

// Armijo's fraction: a full Newton step on a smooth problem reduces the merit by nearly all of it.
constexpr double kSufficientDecrease = 1e-4;
// Pivots below this share of the largest are noise: entries carry about 1e-10 relative error after a contact sum.
constexpr double kSingularPivot = 1e-11;
constexpr int kMaxShifts = 24;
constexpr std::size_t kPatience = 5;

class Iteration {
 public:
  Iteration(EquilibriumProblem& problem, const Unknowns& start, const NewtonSettings& settings)
      : problem_(problem), settings_(settings), n_(problem.size()) {
    tolerance_.resize(n_);
    max_step_.resize(n_);
    for (int i = 0; i < n_; ++i) {
      const bool force = problem.load_kind(i) == LoadKind::kForce;
      tolerance_[i] = force ? settings.force_tolerance : settings.moment_tolerance;
      max_step_[i] = force ? settings.max_newton_step_m : settings.max_newton_step_rad;
    }
    alpha_ = start;
    r_.resize(n_);
    trial_r_.resize(n_);
    J_.resize(n_, n_);
    trial_J_.resize(n_, n_);
    const auto steps = static_cast<std::size_t>(settings.max_iterations);
    statistics_.residual.reserve(steps + 1);
    statistics_.step.reserve(steps);
  }

  NewtonResult run() {
    evaluate(alpha_, r_, J_);
    renew();
    NewtonStatus status = NewtonStatus::kMaxIterations;
    for (;; ++statistics_.iterations) {
      statistics_.residual.push_back(largest(r_));
      if (!r_.allFinite()) {
        status = NewtonStatus::kNotFinite;
        break;
      }
      if (statistics_.residual.back() <= 1.0) {
        status = NewtonStatus::kConverged;
        break;
      }
      if (statistics_.iterations >= settings_.max_iterations) break;
      // The analytic Jacobian is one-sided where faces enter contact; differences see both sides of such a corner.
      const bool analytic = settings_.jacobian == JacobianMethod::kAnalytic;
      if (analytic && crawling()) difference(alpha_, J_);
      if (advance()) continue;
      if (analytic) {
        difference(alpha_, J_);
        if (advance()) continue;
      }
      status = NewtonStatus::kNoProgress;
      break;
    }
    NewtonResult result;
    result.status = status;
    result.alpha = alpha_;
    result.residual = r_;
    r_.cwiseQuotient(tolerance_).cwiseAbs().maxCoeff(&result.worst_coordinate);
    result.statistics = std::move(statistics_);
    return result;
  }

 private:
  double largest(const Unknowns& r) const {
    return r.cwiseQuotient(tolerance_).cwiseAbs().maxCoeff();
  }
  // True every kPatience steps in which the residual has not halved.
  bool crawling() const {
    const auto& past = statistics_.residual;
    return past.size() > kPatience && past.size() % kPatience == 0 &&
           past.back() > 0.5 * past[past.size() - 1 - kPatience];
  }
  double merit(const Unknowns& r) const {
    const double value = 0.5 * r.cwiseQuotient(tolerance_).squaredNorm();
    return std::isfinite(value) ? value : HUGE_VAL;
  }

  void evaluate(const Unknowns& alpha, Unknowns& r, Jacobian& J) {
    if (settings_.jacobian == JacobianMethod::kAnalytic) {
      problem_.residual_and_jacobian(alpha, r, J);
      statistics_.evaluations += 1;
      return;
    }
    problem_.residual(alpha, r);
    statistics_.evaluations += 1;
    difference(alpha, J);
  }

  void renew() {
    if (problem_.renew(alpha_, r_, J_) && settings_.jacobian != JacobianMethod::kAnalytic) {
      difference(alpha_, J_);
    }
  }

  // Central differences of the residual.
  void difference(const Unknowns& alpha, Jacobian& J) {
    Unknowns moved = alpha, ahead(n_), behind(n_);
    for (int j = 0; j < n_; ++j) {
      moved[j] = alpha[j] + settings_.perturbation;
      problem_.residual(moved, ahead);
      moved[j] = alpha[j] - settings_.perturbation;
      problem_.residual(moved, behind);
      moved[j] = alpha[j];
      J.col(j) = (ahead - behind) / (2.0 * settings_.perturbation);
    }
    statistics_.evaluations += 2 * n_;
  }

  // −J with rows in tolerances and columns in step bounds: entries without units.
  Jacobian scaled_stiffness() const {
    return -(tolerance_.cwiseInverse().asDiagonal() * J_ * max_step_.asDiagonal());
  }

  // The step of (μ D − J) Δ = r; false where the matrix is singular to working precision.
  bool step_of(const Jacobian& A, double mu, Unknowns& step) const {
    Jacobian shifted = A;
    shifted.diagonal().array() += mu;
    const Eigen::ColPivHouseholderQR<Jacobian> qr(shifted);
    const auto pivots = qr.matrixR().diagonal().cwiseAbs();
    if (!(pivots.minCoeff() > kSingularPivot * pivots.maxCoeff())) return false;
    step = max_step_.cwiseProduct(Unknowns(qr.solve(r_.cwiseQuotient(tolerance_))));
    return step.allFinite();
  }

  double length(const Unknowns& step) const {
    return step.cwiseQuotient(max_step_).cwiseAbs().maxCoeff();
  }

  bool advance() {
    const Jacobian A = scaled_stiffness();
    Unknowns step(n_);
    const bool solvable = step_of(A, 0.0, step);
    // Within its bounds and not against the net force: a plain Newton step.
    const bool plain = solvable && length(step) <= 1.0 && r_.dot(step) > 0.0;
    if (plain && line_search(step)) return true;
    if (regularised_search(A)) return true;
    // Nothing along the force helps: an equilibrium that is not stable may still be where Newton points.
    if (plain || !solvable) return false;
    step /= std::max(1.0, length(step));
    return line_search(step);
  }

  bool line_search(const Unknowns& step) {
    const double before = merit(r_);
    double s = 1.0;
    for (int halving = 0; halving <= settings_.max_line_search; ++halving) {
      const double after = try_step(s * step);
      if (after <= before * (1.0 - 2.0 * kSufficientDecrease * s)) return accept(s * step, false);
      // Minimiser of the parabola through f(0), f'(0) = −2 f(0) and f(s), kept within [0.1, 0.5] s.
      const double curvature = after - before + 2.0 * before * s;
      const double parabola = std::isfinite(after) ? before * s * s / curvature : 0.0;
      s = std::clamp(parabola, 0.1 * s, 0.5 * s);
    }
    return false;
  }

  bool regularised_search(const Jacobian& A) {
    const double before = merit(r_);
    const double scale = std::max(A.cwiseAbs().maxCoeff(), 1.0);
    Unknowns step(n_);
    int trials = 0;
    double mu = 1e-8 * scale;
    for (int shift = 0; shift < kMaxShifts; ++shift, mu *= 10.0) {
      if (!step_of(A, mu, step) || length(step) > 1.0) continue;
      const double work = r_.dot(step);
      if (!(work > 0.0)) continue;
      if (++trials > settings_.max_line_search + 2) return false;
      const double after = try_step(step);
      if (!std::isfinite(after)) continue;
      const bool pushed_on = trial_r_.dot(step) >= 0.0 && length(step) > 1e-6;
      if (after <= before * (1.0 - kSufficientDecrease) || pushed_on) return accept(step, true);
    }
    return false;
  }

  double try_step(const Unknowns& step) {
    trial_alpha_ = alpha_ + step;
    evaluate(trial_alpha_, trial_r_, trial_J_);
    return merit(trial_r_);
  }

  bool accept(const Unknowns& step, bool regularised) {
    alpha_ = trial_alpha_;
    r_ = trial_r_;
    J_ = trial_J_;
    statistics_.step.push_back(length(step));
    statistics_.regularised_steps += regularised ? 1 : 0;
    renew();
    return true;
  }

  EquilibriumProblem& problem_;
  const NewtonSettings& settings_;
  const int n_;
  Unknowns tolerance_, max_step_, alpha_, r_, trial_alpha_, trial_r_;
  Jacobian J_, trial_J_;
  NewtonStatistics statistics_;
};

void require_positive(double value, const char* setting) {
  if (!(std::isfinite(value) && value > 0.0)) {
    throw std::invalid_argument("Newton settings: " + std::string(setting) + " is " +
                                std::to_string(value) + ": must be finite and above 0");
  }
}

}  // namespace

std::string_view name(NewtonStatus status) {
  switch (status) {
    case NewtonStatus::kConverged: return "converged";
    case NewtonStatus::kMaxIterations: return "max_iterations";
    case NewtonStatus::kNoProgress: return "no_progress";
    case NewtonStatus::kNotFinite: return "not_finite";
  }
  return "unknown";
}

std::string_view advice(NewtonStatus status) {
  switch (status) {
    case NewtonStatus::kConverged:
      return "converged: every residual is within its tolerance";
    case NewtonStatus::kMaxIterations:
      return "the iterations ran out: raise max_iterations, or start nearer (a smaller load or "
             "flexion increment)";
    case NewtonStatus::kNoProgress:
      return "no step reduces the residual: check that the loads can be carried at all, try "
             "finite-difference Jacobians, or loosen force_tolerance and moment_tolerance";
    case NewtonStatus::kNotFinite:
      return "a residual is not finite: check the contact model and the loads at the start";
  }
  return "unknown status";
}

void require_valid(const NewtonSettings& settings) {
  require_positive(settings.force_tolerance, "force_tolerance");
  require_positive(settings.moment_tolerance, "moment_tolerance");
  require_positive(settings.max_newton_step_m, "max_newton_step_m");
  require_positive(settings.max_newton_step_rad, "max_newton_step_rad");
  require_positive(settings.perturbation, "perturbation");
  if (settings.max_iterations < 1) {
    throw std::invalid_argument("Newton settings: max_iterations is " +
                                std::to_string(settings.max_iterations) + ": must be at least 1");
  }
  if (settings.max_line_search < 0) {
    throw std::invalid_argument("Newton settings: max_line_search is " +
                                std::to_string(settings.max_line_search) +
                                ": must be at least 0");
  }
}

NewtonResult solve_newton(EquilibriumProblem& problem, const Unknowns& start,
                          const NewtonSettings& settings) {
  require_valid(settings);
  const int n = problem.size();
  if (n < 1 || n > kMaxUnknowns || start.size() != n) {
    throw std::invalid_argument("solve_newton: start has " + std::to_string(start.size()) +
                                " values for a problem of " + std::to_string(n) +
                                " unknowns (1 to " + std::to_string(kMaxUnknowns) + ")");
  }
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(start[i])) {
      throw std::invalid_argument("solve_newton: start value of " +
                                  std::string(problem.coordinate_name(i)) + " is " +
                                  std::to_string(start[i]) + ": must be finite");
    }
  }
  return Iteration(problem, start, settings).run();
}

}  // namespace condyle::numerics
