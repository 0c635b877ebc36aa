// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/min_max.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::recruitment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A reduced cost of less is zero: multipliers are of order one.
constexpr double kZero = 1e-10;
// A level needs as many proofs as h has pieces on the way: a handful.
constexpr int kMostProofs = 200;

}  // namespace

MinMax::MinMax(int n, int m)
    : x(Vector::Zero(m)),
      y(Vector::Zero(n)),
      multipliers(Vector::Zero(n)),
      held(static_cast<std::size_t>(m + 2 * n)),
      system(n, m),
      n_(n),
      m_(m),
      k_(m + 2 * n),
      program_(n, k_),
      simplex_(n, k_),
      own_lower_(k_),
      own_upper_(k_),
      value_(k_),
      proof_(n),
      rows_(n),
      z_(k_) {
  levels.reserve(static_cast<std::size_t>(k_) + 1);
}

double MinMax::weight(int i) const {
  return i < m_ ? problem_->weight[i] : problem_->price[(i - m_) % n_];
}

void MinMax::begin() {
  const ScaledProblem& s = *problem_;
  program_.G.leftCols(m_) = s.A;
  program_.G.rightCols(2 * n_).setZero();
  program_.b = s.b;
  own_lower_.setZero();
  own_lower_.head(m_) = s.lower;
  own_upper_.head(m_) = s.upper;
  for (int j = 0; j < n_; ++j) {
    program_.G(j, m_ + j) = s.reserve[j];
    program_.G(j, m_ + n_ + j) = -s.reserve[j];
    own_upper_[m_ + j] = own_upper_[m_ + n_ + j] = s.reserve[j] > 0.0 ? kInfinity : 0.0;
  }
  for (int i = 0; i < k_; ++i) {
    const bool moves = own_upper_[i] > own_lower_[i];
    held[static_cast<std::size_t>(i)] = moves ? kFree : kAtLower;
    value_[i] = own_lower_[i];
  }
  levels.clear();
  multipliers.setZero();
  iterations = 0;
  simplex_.forget();
}

double MinMax::upper_at(int i, double t) const {
  return std::max(own_lower_[i], std::min(own_upper_[i], t / weight(i)));
}

void MinMax::set_bounds(double t) {
  for (int i = 0; i < k_; ++i) {
    const bool is_free = held[static_cast<std::size_t>(i)] == kFree;
    program_.lower[i] = is_free ? own_lower_[i] : value_[i];
    program_.upper[i] = is_free ? upper_at(i, t) : value_[i];
  }
}

// What the proof says must be violated at least at t; it falls as t grows.
double MinMax::proof_at(double t) const {
  double sum = problem_->b.dot(proof_);
  for (int i = 0; i < k_; ++i) {
    const bool is_free = held[static_cast<std::size_t>(i)] == kFree;
    const double low = is_free ? own_lower_[i] : value_[i];
    const double high = is_free ? upper_at(i, t) : value_[i];
    sum -= z_[i] * (z_[i] > 0.0 ? high : low);
  }
  return sum;
}

// The t at which the proof proves nothing more, walked to from one piece to the next; infinite where there is none.
double MinMax::root(double t) const {
  for (int pieces = 0; pieces <= 2 * k_; ++pieces) {
    double fall = 0.0, next = kInfinity;
    for (int i = 0; i < k_; ++i) {
      if (held[static_cast<std::size_t>(i)] != kFree || z_[i] <= 0.0) continue;
      const double from = own_lower_[i] * weight(i), to = own_upper_[i] * weight(i);
      if (t < from) next = std::min(next, from);
      if (t >= from && t < to) {
        fall += z_[i] / weight(i);
        next = std::min(next, to);
      }
    }
    const double left = proof_at(t);
    if (left <= 0.0) return t;
    const double reach = fall > 0.0 ? t + left / fall : kInfinity;
    if (reach <= next) return reach;
    t = next;
  }
  return kInfinity;
}

// The least t of this level. kRest: what is free may rest.
MinMax::Level MinMax::next_level(double& t) {
  t = 0.0;
  for (int proofs = 0; proofs < kMostProofs; ++proofs) {
    set_bounds(t);
    const auto outcome = simplex_.find_feasible(program_);
    iterations += simplex_.iterations;
    if (outcome == BoundedSimplex::Outcome::kOptimal) return proofs > 0 ? Level::kFound : Level::kRest;
    if (outcome != BoundedSimplex::Outcome::kInfeasible) return Level::kMaxIterations;
    const double before = t;
    proof_ = simplex_.multipliers;
    z_.noalias() = program_.G.transpose() * proof_;
    for (int i = 0; i < k_; ++i) z_[i] = std::abs(z_[i]) > kZero ? z_[i] : 0.0;
    t = root(t);
    if (std::isinf(t)) return Level::kInfeasible;
    // Violations of rounding: the proof's own root is as near as can be.
    if (!(t > before)) return Level::kFound;
  }
  return Level::kMaxIterations;
}

// What the last proof says of every solution at t; false where it holds nobody at the level.
bool MinMax::hold(double t, int level) {
  bool any = false;
  for (int i = 0; i < k_; ++i) {
    int& what = held[static_cast<std::size_t>(i)];
    if (what != kFree || z_[i] == 0.0) continue;
    if (z_[i] < 0.0) {
      what = kAtLower;
      value_[i] = own_lower_[i];
      continue;
    }
    value_[i] = upper_at(i, t);
    const double at_level = t / weight(i);
    what = at_level <= own_lower_[i] ? kAtLower : (at_level < own_upper_[i] ? level : kAtUpper);
    any = any || what == level;
  }
  return any;
}

bool MinMax::free_left() const {
  return std::find(held.begin(), held.end(), static_cast<int>(kFree)) != held.end();
}

// Levels and free forces from the equations, so that these hold to rounding.
MinMax::Outcome MinMax::solve_equations() {
  const ScaledProblem& s = *problem_;
  if (!system.build(s, held, static_cast<int>(levels.size()))) return Outcome::kMaxIterations;
  rows_ = s.b;
  for (int i = 0; i < k_; ++i) {
    const int what = held[static_cast<std::size_t>(i)];
    if (what < kFree && value_[i] != 0.0) rows_ -= value_[i] * program_.G.col(i);
  }
  system.solve(rows_, x, y);
  for (int i = 0; i < k_; ++i) {
    if (held[static_cast<std::size_t>(i)] >= kFree || value_[i] == 0.0) continue;
    if (i < m_) x[i] = value_[i];
  }
  for (std::size_t k = 0; k < levels.size(); ++k) levels[k] = system.level(static_cast<int>(k));
  return Outcome::kConverged;
}

MinMax::Outcome MinMax::solve(const ScaledProblem& problem) {
  problem_ = &problem;
  begin();
  while (free_left()) {
    double t = 0.0;
    const Level found = next_level(t);
    if (found == Level::kInfeasible) return Outcome::kInfeasible;
    if (found == Level::kMaxIterations) return Outcome::kMaxIterations;
    if (found == Level::kRest) {
      for (int i = 0; i < k_; ++i) {
        int& what = held[static_cast<std::size_t>(i)];
        if (what == kFree) what = kAtLower;
      }
      break;
    }
    const int level = static_cast<int>(levels.size());
    if (!hold(t, level)) return Outcome::kMaxIterations;
    levels.push_back(t);
    if (level == 0) {
      double fall = 0.0;
      for (int i = 0; i < k_; ++i) {
        if (held[static_cast<std::size_t>(i)] == 0) fall += z_[i] / weight(i);
      }
      multipliers = proof_ / fall;
    }
    if (system.build(problem, held, level + 1) && system.determined()) break;
  }
  if (!free_left() && levels.empty()) {
    x = own_lower_.head(m_);
    y.setZero();
    return system.build(problem, held, 0) ? Outcome::kConverged : Outcome::kMaxIterations;
  }
  return solve_equations();
}

}  // namespace condyle::recruitment
