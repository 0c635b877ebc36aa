// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/dual_newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::recruitment {
namespace {

// Armijo's fraction; a full Newton step on a smooth function gains half of what the slope promises.
constexpr double kSufficientIncrease = 1e-4;
// In p = 2's curvatures.
constexpr double kStartShift = 1e-9;
constexpr double kLeastShift = 1e-14;
constexpr double kMostShift = 1e4;
// Slopes spread as x^(2 − p): over more than rounding allows in a sum for p = 4 and x = 1e-6.
constexpr double kGradedFrom = 3.0;
// A slope of p > 2 is infinite at x = 0.
constexpr double kSteepest = 1e40;
// z grows at most so much in a step: beyond, every muscle is at a bound and the model says nothing.
constexpr double kGrowth = 10.0;
constexpr int kHalvings = 40;
// Rounding of a sum of some hundred terms of order one.
constexpr double kRounding = 1e-14;

}  // namespace

DualNewton::DualNewton(int n, int m, double exponent)
    : multipliers(Vector::Zero(n)),
      x(Vector::Zero(m)),
      y(Vector::Zero(n)),
      slope(Vector::Zero(m)),
      reserve_slope(Vector::Zero(n)),
      n_(n),
      m_(m),
      p_(exponent),
      q_(1.0 / (exponent - 1.0)),
      gain_(m),
      z_low_(m),
      z_high_(m),
      cost_low_(m),
      cost_high_(m),
      z_(m),
      dz_(m),
      r_(n),
      step_(n),
      start_lambda_(n),
      start_z_(m),
      usual_(n),
      start_direction_(n, m, NewtonDirection::Method::kNormal),
      direction_(n, m, exponent > kGradedFrom ? NewtonDirection::Method::kGraded
                                              : NewtonDirection::Method::kNormal) {}

double DualNewton::power(double base) const {
  if (q_ == 1.0) return base;
  if (q_ == 0.5) return std::sqrt(base);
  if (q_ == 2.0) return base * base;
  if (q_ == 0.25) return std::sqrt(std::sqrt(base));
  return std::pow(base, q_);
}

void DualNewton::prepare() {
  const ScaledProblem& s = *problem_;
  double bound = -1.0, bound_power = 0.0;  // upper bounds are mostly one number
  for (int i = 0; i < m_; ++i) {
    gain_[i] = 1.0 / (p_ * s.weight[i]);
    if (s.upper[i] != bound) {
      bound = s.upper[i];
      bound_power = std::isinf(bound) ? bound : std::pow(bound, p_ - 1.0);
    }
    const double low = s.lower[i] > 0.0 ? std::pow(s.lower[i], p_ - 1.0) : 0.0;
    z_low_[i] = low / gain_[i];
    z_high_[i] = bound_power / gain_[i];
    cost_low_[i] = s.weight[i] * low * s.lower[i];
    cost_high_[i] = s.weight[i] * bound_power * bound;
  }
}

// Slopes of p = 2 without bounds, and the diagonal that they give.
void DualNewton::set_usual() {
  const ScaledProblem& s = *problem_;
  for (int i = 0; i < m_; ++i) slope[i] = s.upper[i] > 0.0 ? 0.5 / s.weight[i] : 0.0;
  for (int j = 0; j < n_; ++j) {
    reserve_slope[j] = 0.5 / s.price[j];
    const double sum = s.A.row(j).cwiseAbs2().dot(slope) +
                       s.reserve[j] * s.reserve[j] * reserve_slope[j];
    usual_[j] = sum > 0.0 ? sum : 1.0;
  }
}

// Forces for p = 2 without bounds, and the size of λ that is best along them.
void DualNewton::start() {
  start_direction_.factorise(*problem_, slope, reserve_slope, usual_, kStartShift);
  start_direction_.solve(problem_->b, multipliers, z_);
  const double size = best_size();
  multipliers *= size;
  z_ *= size;
}

double DualNewton::best_size() const {
  const ScaledProblem& s = *problem_;
  // Σ x z of x unbounded is homogeneous of degree p q in λ, bᵀλ of degree 1.
  double work = 0.0;
  for (int i = 0; i < m_; ++i) {
    if (z_[i] > 0.0 && s.upper[i] > 0.0) work += z_[i] * power(z_[i] * gain_[i]);
  }
  for (int j = 0; j < n_; ++j) {
    const double base = s.reserve[j] * std::abs(multipliers[j]);
    if (base > 0.0) work += base * power(base / (p_ * s.price[j]));
  }
  const double load = s.b.dot(multipliers);
  return work > 0.0 && load > 0.0 ? std::pow(load / work, p_ - 1.0) : 1.0;
}

double DualNewton::respond_muscles() {
  double conjugate = 0.0;
  const double kept = 1.0 - 1.0 / p_;
  for (int i = 0; i < m_; ++i) {
    const double z = z_[i];
    if (z <= z_low_[i]) {
      x[i] = problem_->lower[i];
      conjugate += z * x[i] - cost_low_[i];
    } else if (z >= z_high_[i]) {
      x[i] = problem_->upper[i];
      conjugate += z * x[i] - cost_high_[i];
    } else {
      x[i] = power(z * gain_[i]);
      conjugate += z * x[i] * kept;
    }
  }
  return conjugate;
}

double DualNewton::respond_reserves() {
  double conjugate = 0.0;
  for (int j = 0; j < n_; ++j) {
    const double z = problem_->reserve[j] * multipliers[j];
    y[j] = z == 0.0 ? 0.0 : std::copysign(power(std::abs(z) / (p_ * problem_->price[j])), z);
    conjugate += z * y[j] * (1.0 - 1.0 / p_);
  }
  return conjugate;
}

double DualNewton::respond() {
  const ScaledProblem& s = *problem_;
  double value = s.b.dot(multipliers) - respond_muscles();
  if (s.has_reserves) value -= respond_reserves();
  for (int j = 0; j < n_; ++j) r_[j] = s.b[j] - s.A.row(j).dot(x) - s.reserve[j] * y[j];
  return value;
}

void DualNewton::slopes() {
  const ScaledProblem& s = *problem_;
  for (int i = 0; i < m_; ++i) {
    const bool free = z_[i] > z_low_[i] && z_[i] < z_high_[i];
    slope[i] = free ? std::min(q_ * x[i] / z_[i], kSteepest) : 0.0;
  }
  const double at_rest = q_ > 1.0 ? 0.0 : kSteepest;
  for (int j = 0; j < n_; ++j) {
    if (s.reserve[j] == 0.0) continue;
    const double z = std::abs(s.reserve[j] * multipliers[j]);
    const double rest = q_ == 1.0 ? 0.5 / s.price[j] : at_rest;
    reserve_slope[j] = z > 0.0 ? std::min(q_ * std::abs(y[j]) / z, kSteepest) : rest;
  }
}

// False where no shift gives a direction of growth.
bool DualNewton::newton_direction() {
  for (double shift = kLeastShift; shift < kMostShift; shift *= 100.0) {
    if (!direction_.factorise(*problem_, slope, reserve_slope, usual_, shift)) continue;
    direction_.solve(r_, step_, dz_);
    if (step_.allFinite() && dz_.allFinite() && r_.dot(step_) > 0.0) return true;
  }
  return false;
}

bool DualNewton::line_search(double& value) {
  const double slope_at_start = r_.dot(step_);
  start_lambda_ = multipliers;
  start_z_ = z_;
  const double reach = kGrowth * std::max(z_.cwiseAbs().maxCoeff(), p_);
  double length = std::min(1.0, reach / std::max(dz_.cwiseAbs().maxCoeff(), 1e-300));
  const double before = value;
  const double noise = kRounding * std::max(1.0, std::abs(before));
  for (int k = 0; k < kHalvings; ++k) {
    multipliers = start_lambda_ + length * step_;
    z_ = start_z_ + length * dz_;
    value = respond();
    const double slope_here = r_.dot(step_);
    const double gained = value - before;
    const double promised = length * slope_at_start;
    if (gained >= kSufficientIncrease * promised && promised > noise) return true;
    if (promised <= noise && std::abs(slope_here) <= 0.5 * slope_at_start) return true;
    // Where the slope would be zero if it fell evenly.
    const double even = slope_at_start / std::max(slope_at_start - slope_here, 1e-300);
    length *= std::clamp(even, 0.1, 0.5);
  }
  multipliers = start_lambda_;
  z_ = start_z_;
  value = respond();
  return false;
}

// True where g grows without end along λ: bᵀλ exceeds what all muscles at their best bounds can do.
bool DualNewton::grows_for_ever() const {
  const ScaledProblem& s = *problem_;
  const double largest = z_.cwiseAbs().maxCoeff();
  double gain = s.b.dot(multipliers);
  double terms = s.b.cwiseAbs().dot(multipliers.cwiseAbs());
  for (int j = 0; j < n_; ++j) {
    if (s.reserve[j] * std::abs(multipliers[j]) > 1e-9 * largest) return false;
  }
  for (int i = 0; i < m_; ++i) {
    if (z_[i] > 0.0) {
      if (std::isinf(s.upper[i])) {
        if (z_[i] > 1e-9 * largest) return false;
        continue;
      }
      gain -= s.upper[i] * z_[i];
      terms += s.upper[i] * z_[i];
    } else {
      gain -= s.lower[i] * z_[i];
      terms -= s.lower[i] * z_[i];
    }
  }
  return gain > 1e-9 * terms;
}

double DualNewton::relative_residual() const {
  return r_.cwiseAbs().maxCoeff() / (1.0 + x.maxCoeff());
}

DualNewton::Outcome DualNewton::solve(const ScaledProblem& problem, bool warm, int max_iterations,
                                      double tolerance) {
  problem_ = &problem;
  prepare();
  set_usual();
  if (warm) {
    z_.setZero();
    for (int j = 0; j < n_; ++j) z_ += multipliers[j] * problem.A.row(j).transpose();
  } else {
    start();
  }
  return iterate(max_iterations, tolerance);
}

DualNewton::Outcome DualNewton::polish(const ScaledProblem& problem, const Vector& z, int max_iterations,
                                       double tolerance) {
  problem_ = &problem;
  prepare();
  set_usual();
  z_ = z;
  return iterate(max_iterations, tolerance);
}

DualNewton::Outcome DualNewton::iterate(int max_iterations, double tolerance) {
  double value = respond();
  residual = relative_residual();
  for (iterations = 0; residual > kRounding && iterations < max_iterations;) {
    if (iterations >= 3 && grows_for_ever()) return Outcome::kUnbounded;
    slopes();
    if (!newton_direction() || !line_search(value)) break;
    ++iterations;
    const double before = residual;
    residual = relative_residual();
    // Rounding: no step will do better.
    if (before <= tolerance && residual > 0.25 * before) break;
  }
  slopes();
  if (residual <= tolerance) return Outcome::kConverged;
  return grows_for_ever() ? Outcome::kUnbounded : Outcome::kMaxIterations;
}

}  // namespace condyle::recruitment
