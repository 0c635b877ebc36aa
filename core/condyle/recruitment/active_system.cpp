// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/active_system.hpp"

namespace condyle::recruitment {
namespace {

// Pivots of less are rounding: entries are of order one, sums of up to some hundred.
constexpr double kRank = 1e-11;

}  // namespace

ActiveSystem::ActiveSystem(int n, int m)
    : n_(n), m_(m), matrix_(Small::Zero(n, n)), rows_(n), solution_(SmallVector::Zero(n)) {
  decomposition_.setThreshold(kRank);
}

bool ActiveSystem::build(const ScaledProblem& problem, const std::vector<int>& held, int levels) {
  problem_ = &problem;
  held_ = &held;
  levels_ = levels;
  unknowns_ = levels;
  if (levels > n_) return false;
  matrix_.setZero();
  for (int i = 0; i < m_ + 2 * n_; ++i) {
    const int what = held[static_cast<std::size_t>(i)];
    if (what < kFree) continue;
    if (what == kFree && unknowns_ == n_) return false;
    const int column = what == kFree ? unknowns_++ : what;
    if (i < m_) {
      matrix_.col(column) += problem.A.col(i) * (what == kFree ? 1.0 : 1.0 / problem.weight[i]);
      continue;
    }
    const int j = (i - m_) % n_;
    const double B = (i < m_ + n_ ? 1.0 : -1.0) * problem.reserve[j];
    matrix_(j, column) += what == kFree ? B : B / problem.price[j];
  }
  decomposition_.compute(matrix_);
  return true;
}

void ActiveSystem::solve(const Vector& rows, Vector& dx, Vector& dy) {
  rows_ = rows;
  solution_ = decomposition_.solve(rows_);
  dx.setZero();
  dy.setZero();
  int next = levels_;
  for (int i = 0; i < m_ + 2 * n_; ++i) {
    const int what = (*held_)[static_cast<std::size_t>(i)];
    if (what < kFree) continue;
    double v = solution_[what == kFree ? next++ : what];
    if (i < m_) {
      dx[i] = what == kFree ? v : v / problem_->weight[i];
      continue;
    }
    const int j = (i - m_) % n_;
    if (what != kFree) v /= problem_->price[j];
    dy[j] += i < m_ + n_ ? v : -v;
  }
}

}  // namespace condyle::recruitment
