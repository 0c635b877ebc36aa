// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/interior_point.hpp"

#include <algorithm>
#include <cmath>

namespace condyle::recruitment {
namespace {

// The part of the way to the nearest bound that a step may take.
constexpr double kInside = 0.995;
// Average complementarity product at which to stop: below, the slopes are rounding.
constexpr double kGap = 1e-17;
constexpr double kStationarity = 1e-13;
constexpr double kResidual = 1e-13;
// What counts as closed where no step gets further.
constexpr double kAccepted = 1e-10;
constexpr double kLeastCentring = 1e-6;
constexpr double kRecentring = 0.8;
constexpr double kShortest = 1e-9;
constexpr double kShift = 1e-18;

}  // namespace

InteriorPoint::InteriorPoint(int n, int m, double exponent)
    : x(Vector::Zero(m)),
      y(Vector::Zero(n)),
      multipliers(Vector::Zero(n)),
      price_gap(Vector::Zero(m)),
      slope(Vector::Zero(m)),
      reserve_slope(Vector::Zero(n)),
      n_(n),
      m_(m),
      p_(exponent),
      newton_(n, m, NewtonDirection::Method::kGraded),
      usual_(Vector::Ones(n)) {
  for (Vector* v : {&lower_, &upper_, &v_, &s_, &t_, &slope_, &rd_, &g_, &dv_, &ds_, &dt_, &ds_dv_,
                    &dt_dv_, &dz_}) {
    *v = Vector::Zero(m);
  }
  for (Vector* v : {&w_, &reserve_slope_, &reserve_rd_, &dw_, &rp_, &rows_, &dlambda_}) {
    *v = Vector::Zero(n);
  }
}

void InteriorPoint::begin(const Vector& start) {
  const ScaledProblem& s = *problem_;
  // Forces in the largest of the start's, so that p-th powers are of order one.
  size_ = start.maxCoeff() > 0.0 ? start.maxCoeff() : 1.0;
  largest_load_ = s.b.cwiseAbs().maxCoeff() / size_;
  lower_ = s.lower / size_;
  upper_ = s.upper / size_;
  v_ = lower_;
  s_.setZero();
  t_.setZero();
  w_.setZero();
  multipliers.setZero();
  for (Vector* v : {&dv_, &ds_, &dt_, &dw_}) v->setZero();
  bounds_ = 0;
  for (int i = 0; i < m_; ++i) {
    if (!moves(i)) continue;
    const bool bounded = !std::isinf(upper_[i]);
    const double margin = 0.05 * (bounded ? std::min(1.0, upper_[i] - lower_[i]) : 1.0);
    v_[i] = std::clamp(start[i] / size_ + 0.1, lower_[i] + margin, upper_[i] - margin);
    s_[i] = 0.1 / (v_[i] - lower_[i]);
    if (bounded) t_[i] = 0.1 / (upper_[i] - v_[i]);
    bounds_ += bounded ? 2 : 1;
  }
  bounds_ = std::max(bounds_, 1);
}

// Residual of the first equation; returns its largest.
double InteriorPoint::stationarity() {
  const ScaledProblem& s = *problem_;
  dz_.setZero();
  for (int j = 0; j < n_; ++j) dz_ += multipliers[j] * s.A.row(j).transpose();
  for (int i = 0; i < m_; ++i) {
    const double marginal = moves(i) ? p_ * s.weight[i] * std::pow(v_[i], p_ - 1.0) : 0.0;
    rd_[i] = moves(i) ? marginal - dz_[i] - s_[i] + t_[i] : 0.0;
  }
  for (int j = 0; j < n_; ++j) {
    const double marginal = p_ * s.price[j] * std::pow(std::abs(w_[j]), p_ - 1.0);
    reserve_rd_[j] =
        s.reserve[j] > 0.0 ? std::copysign(marginal, w_[j]) - s.reserve[j] * multipliers[j] : 0.0;
  }
  return std::max(rd_.cwiseAbs().maxCoeff(), reserve_rd_.cwiseAbs().maxCoeff());
}

// Residual of the second, and what muscles and reserves answer to a change of price.
void InteriorPoint::linearise(double gap) {
  const ScaledProblem& s = *problem_;
  for (int j = 0; j < n_; ++j) {
    rp_[j] = s.b[j] / size_ - s.A.row(j).dot(v_) - s.reserve[j] * w_[j];
  }
  for (int i = 0; i < m_; ++i) {
    slope_[i] = 0.0;
    if (!moves(i)) continue;
    double curvature = p_ * (p_ - 1.0) * s.weight[i] * std::pow(v_[i], p_ - 2.0);
    curvature += s_[i] / (v_[i] - lower_[i]);
    if (!std::isinf(upper_[i])) curvature += t_[i] / (upper_[i] - v_[i]);
    slope_[i] = 1.0 / curvature;
  }
  // A reserve at rest has no curvature, or an infinite one: that of one which costs as much as the gap.
  const double least = std::pow(gap, 1.0 / p_);
  for (int j = 0; j < n_; ++j) {
    if (s.reserve[j] == 0.0) continue;
    const double at = std::max(std::abs(w_[j]), least);
    reserve_slope_[j] = 1.0 / (p_ * (p_ - 1.0) * s.price[j] * std::pow(at, p_ - 2.0));
  }
}

// The step towards complementarity products of `target`, less those of the step before where `corrected`.
bool InteriorPoint::direction(double target, bool corrected) {
  const ScaledProblem& s = *problem_;
  for (int i = 0; i < m_; ++i) {
    g_[i] = 0.0;
    if (!moves(i)) continue;
    const double below = v_[i] - lower_[i], above = upper_[i] - v_[i];
    ds_[i] = target - below * s_[i] - (corrected ? ds_dv_[i] : 0.0);
    g_[i] = ds_[i] / below - rd_[i];
    if (std::isinf(above)) continue;
    dt_[i] = target - above * t_[i] + (corrected ? dt_dv_[i] : 0.0);
    g_[i] -= dt_[i] / above;
  }
  dv_ = slope_.cwiseProduct(g_);
  for (int j = 0; j < n_; ++j) {
    rows_[j] = rp_[j] - s.A.row(j).dot(dv_) + s.reserve[j] * reserve_slope_[j] * reserve_rd_[j];
  }
  newton_.solve(rows_, dlambda_, dz_);
  for (int j = 0; j < n_; ++j) {
    dw_[j] = reserve_slope_[j] * (s.reserve[j] * dlambda_[j] - reserve_rd_[j]);
  }
  for (int i = 0; i < m_; ++i) {
    if (!moves(i)) continue;
    dv_[i] = slope_[i] * (dz_[i] + g_[i]);
    ds_[i] = (ds_[i] - s_[i] * dv_[i]) / (v_[i] - lower_[i]);
    if (!std::isinf(upper_[i])) dt_[i] = (dt_[i] + t_[i] * dv_[i]) / (upper_[i] - v_[i]);
  }
  return dv_.allFinite() && dw_.allFinite() && dlambda_.allFinite();
}

double InteriorPoint::longest_step() const {
  double length = 1.0 / kInside;
  for (int i = 0; i < m_; ++i) {
    if (!moves(i)) continue;
    if (dv_[i] < 0.0) length = std::min(length, (lower_[i] - v_[i]) / dv_[i]);
    if (dv_[i] > 0.0) length = std::min(length, (upper_[i] - v_[i]) / dv_[i]);
    if (ds_[i] < 0.0) length = std::min(length, -s_[i] / ds_[i]);
    if (dt_[i] < 0.0) length = std::min(length, -t_[i] / dt_[i]);
  }
  return kInside * length;
}

// Mean complementarity product, now and after a step of that length.
double InteriorPoint::gap() const {
  double sum = 0.0;
  for (int i = 0; i < m_; ++i) {
    if (!moves(i)) continue;
    sum += (v_[i] - lower_[i]) * s_[i];
    if (!std::isinf(upper_[i])) sum += (upper_[i] - v_[i]) * t_[i];
  }
  return sum / bounds_;
}

double InteriorPoint::gap_after(double length) const {
  double sum = 0.0;
  for (int i = 0; i < m_; ++i) {
    if (!moves(i)) continue;
    const double v = v_[i] + length * dv_[i];
    sum += (v - lower_[i]) * (s_[i] + length * ds_[i]);
    if (!std::isinf(upper_[i])) sum += (upper_[i] - v) * (t_[i] + length * dt_[i]);
  }
  return sum / bounds_;
}

void InteriorPoint::take(double length) {
  v_ += length * dv_;
  s_ += length * ds_;
  t_ += length * dt_;
  w_ += length * dw_;
  multipliers += length * dlambda_;
}

// The step, halved until the residual that is not linear has at most doubled or is small beside the gap.
bool InteriorPoint::advance(double length, double gap) {
  const double before = std::max(rd_.cwiseAbs().maxCoeff(), reserve_rd_.cwiseAbs().maxCoeff());
  const double allowed = std::max(2.0 * before, std::sqrt(gap));
  take(length);
  while (!(stationarity() <= allowed)) {
    take(-0.5 * length);
    length *= 0.5;
    if (length < kShortest) {
      take(-length);
      stationarity();
      return false;
    }
  }
  return true;
}

void InteriorPoint::forces_out() {
  const double unit = std::pow(size_, p_ - 1.0);
  for (int i = 0; i < m_; ++i) {
    const double marginal = p_ * problem_->weight[i] * std::pow(v_[i], p_ - 1.0);
    price_gap[i] = unit * (marginal - s_[i] + t_[i]);
  }
  x = size_ * v_;
  y = size_ * w_;
  multipliers *= unit;
  slope = size_ / unit * slope_;
  reserve_slope = size_ / unit * reserve_slope_;
}

bool InteriorPoint::solve(const ScaledProblem& problem, const Vector& start, int max_iterations) {
  problem_ = &problem;
  begin(start);
  double mean = gap();
  double off = stationarity();
  for (iterations = 0; iterations < max_iterations; ++iterations) {
    linearise(mean);
    const double unbalanced = rp_.cwiseAbs().maxCoeff();
    if (mean < kGap && off < kStationarity && unbalanced <= kResidual * (1.0 + largest_load_)) break;
    if (!newton_.factorise(problem, slope_, reserve_slope_, usual_, kShift)) break;
    if (!direction(0.0, false)) break;
    const double ratio = gap_after(std::min(1.0, longest_step())) / mean;
    ds_dv_ = ds_.cwiseProduct(dv_);
    dt_dv_ = dt_.cwiseProduct(dv_);
    const double centring = std::clamp(ratio * ratio * ratio, kLeastCentring, 1.0);
    if (!direction(centring * mean, true)) break;
    if (!advance(std::min(1.0, longest_step()), mean)) {
      // Back towards the middle, from where the way on is free.
      if (!direction(kRecentring * mean, false)) break;
      if (!advance(std::min(1.0, longest_step()), mean)) break;
    }
    mean = gap();
    off = stationarity();
  }
  const bool balanced = rp_.cwiseAbs().maxCoeff() <= kAccepted * (1.0 + largest_load_);
  forces_out();
  return balanced && mean < kAccepted && off < kAccepted;
}

}  // namespace condyle::recruitment
