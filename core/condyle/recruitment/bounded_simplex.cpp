// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/bounded_simplex.hpp"

#include <algorithm>
#include <cmath>

namespace condyle::recruitment {
namespace {

// In numbers of order one; rounding after some ten pivots is 1e-14.
constexpr double kFeasible = 1e-11;
constexpr double kOptimal = 1e-11;
constexpr double kPivot = 1e-9;
// A step so short changes nothing.
constexpr double kDegenerate = 1e-13;
constexpr int kPatience = 20;
constexpr int kRefresh = 40;

}  // namespace

LinearProgram::LinearProgram(int n, int k)
    : G(RowMatrix::Zero(n, k)),
      b(Vector::Zero(n)),
      cost(Vector::Zero(k)),
      lower(Vector::Zero(k)),
      upper(Vector::Zero(k)) {}

BoundedSimplex::BoundedSimplex(int n, int k)
    : values(Vector::Zero(k)),
      multipliers(Vector::Zero(n)),
      basis(static_cast<std::size_t>(n)),
      at_upper(static_cast<std::size_t>(k)),
      n_(n),
      k_(k),
      is_basic_(static_cast<std::size_t>(k + n)),
      matrix_(n, n),
      inverse_(n, n),
      basic_(n),
      cost_(n),
      column_(n),
      rows_(n),
      reduced_(k) {
  forget();
}

void BoundedSimplex::forget() {
  for (int j = 0; j < n_; ++j) basis[static_cast<std::size_t>(j)] = k_ + j;
  std::fill(at_upper.begin(), at_upper.end(), std::uint8_t{0});
}

// The inverse of the basis by Gauss and Jordan with row pivots; false where there is none.
bool BoundedSimplex::invert() {
  for (int r = 0; r < n_; ++r) {
    const int j = basis[static_cast<std::size_t>(r)];
    if (j < k_) {
      matrix_.col(r) = program_->G.col(j);
    } else {
      matrix_.col(r).setZero();
      matrix_(j - k_, r) = 1.0;
    }
  }
  inverse_.setIdentity();
  for (int c = 0; c < n_; ++c) {
    int at = c;
    for (int r = c + 1; r < n_; ++r) {
      if (std::abs(matrix_(r, c)) > std::abs(matrix_(at, c))) at = r;
    }
    if (!(std::abs(matrix_(at, c)) > kPivot)) return false;
    if (at != c) {
      matrix_.row(at).swap(matrix_.row(c));
      inverse_.row(at).swap(inverse_.row(c));
    }
    const double scale = 1.0 / matrix_(c, c);
    matrix_.row(c) *= scale;
    inverse_.row(c) *= scale;
    for (int r = 0; r < n_; ++r) {
      const double factor = matrix_(r, c);
      if (r == c || factor == 0.0) continue;
      matrix_.row(r) -= factor * matrix_.row(c);
      inverse_.row(r) -= factor * inverse_.row(c);
    }
  }
  return true;
}

// Values of all variables at their bounds, then of the basic ones from the equations.
void BoundedSimplex::basic_values() {
  const LinearProgram& p = *program_;
  for (int j = 0; j < k_; ++j) {
    const auto index = static_cast<std::size_t>(j);
    if (at_upper[index] && std::isinf(p.upper[j])) at_upper[index] = 0;
    values[j] = is_basic_[index] ? 0.0 : (at_upper[index] ? p.upper[j] : p.lower[j]);
  }
  for (int r = 0; r < n_; ++r) rows_[r] = p.b[r] - p.G.row(r).dot(values);
  basic_.noalias() = inverse_ * rows_;
}

// Costs of the basic variables: of violations while there are any. False where `with_cost` does not matter and nothing
// is violated: done.
bool BoundedSimplex::set_costs(bool with_cost) {
  violated_ = false;
  infeasibility = 0.0;
  for (int r = 0; r < n_; ++r) {
    const int j = basis[static_cast<std::size_t>(r)];
    const double below = lower(j) - basic_[r], above = basic_[r] - upper(j);
    cost_[r] = below > kFeasible ? -1.0 : (above > kFeasible ? 1.0 : 0.0);
    if (cost_[r] == 0.0) continue;
    violated_ = true;
    infeasibility += std::max(below, above);
  }
  if (!violated_ && !with_cost) return false;
  if (!violated_) {
    for (int r = 0; r < n_; ++r) {
      const int j = basis[static_cast<std::size_t>(r)];
      cost_[r] = j < k_ ? program_->cost[j] : 0.0;
    }
  }
  multipliers.noalias() = inverse_.transpose() * cost_;
  reduced_.setZero();
  for (int r = 0; r < n_; ++r) reduced_ -= multipliers[r] * program_->G.row(r).transpose();
  if (!violated_) reduced_ += program_->cost;
  return true;
}

// The variable whose move lowers the cost most, or the first that lowers it; −1: none.
int BoundedSimplex::entering(bool with_cost, bool bland, double& direction) const {
  int best = -1;
  double most = 0.0;
  for (int j = 0; j < k_; ++j) {
    const auto index = static_cast<std::size_t>(j);
    if (is_basic_[index] || !(program_->upper[j] > program_->lower[j])) continue;
    const double gain = at_upper[index] ? reduced_[j] : -reduced_[j];
    const double scale = with_cost && !violated_ ? 1.0 + std::abs(program_->cost[j]) : 1.0;
    if (gain <= kOptimal * scale || gain <= most) continue;
    best = j;
    direction = at_upper[index] ? -1.0 : 1.0;
    if (bland) break;
    most = gain;
  }
  return best;
}

void BoundedSimplex::column(int j) { column_.noalias() = inverse_ * program_->G.col(j); }

// The basic variable that first meets a bound, and how far the entering one goes; −1: none within `length`.
int BoundedSimplex::leaving(double direction, bool bland, double& length, bool& to_upper) const {
  int best = -1;
  for (int r = 0; r < n_; ++r) {
    const double rate = -direction * column_[r];
    if (std::abs(rate) <= kPivot) continue;
    const int j = basis[static_cast<std::size_t>(r)];
    const double v = basic_[r], low = lower(j), high = upper(j);
    // One that is beyond a bound stops where it comes back to it; moving further off, nothing stops it.
    bool up = rate > 0.0;
    if (v > high + kFeasible) {
      if (up) continue;
      up = true;
    } else if (v < low - kFeasible) {
      if (!up) continue;
      up = false;
    }
    const double bound = up ? high : low;
    if (std::isinf(bound)) continue;
    const double way = std::max(0.0, (bound - v) / rate);
    const bool tie = best >= 0 && std::abs(way - length) <= kDegenerate;
    const bool better = bland ? tie && j < basis[static_cast<std::size_t>(best)]
                              : tie && std::abs(column_[r]) > std::abs(column_[best]);
    if ((!tie && way < length) || better) {
      best = r;
      length = way;
      to_upper = up;
    }
  }
  return best;
}

void BoundedSimplex::pivot(int row, int entering_column, bool to_upper) {
  const auto index = static_cast<std::size_t>(row);
  const int out = basis[index];
  is_basic_[static_cast<std::size_t>(out)] = 0;
  if (out < k_) at_upper[static_cast<std::size_t>(out)] = to_upper ? 1 : 0;
  is_basic_[static_cast<std::size_t>(entering_column)] = 1;
  basis[index] = entering_column;
  inverse_.row(row) /= column_[row];
  for (int r = 0; r < n_; ++r) {
    if (r != row) inverse_.row(r) -= column_[r] * inverse_.row(row);
  }
}

void BoundedSimplex::finish() {
  for (int r = 0; r < n_; ++r) {
    const int j = basis[static_cast<std::size_t>(r)];
    if (j < k_) values[j] = basic_[r];
  }
}

BoundedSimplex::Outcome BoundedSimplex::run(const LinearProgram& program, bool with_cost) {
  program_ = &program;
  iterations = 0;
  std::fill(is_basic_.begin(), is_basic_.end(), std::uint8_t{0});
  if (!invert()) {
    forget();
    invert();
  }
  for (int j : basis) is_basic_[static_cast<std::size_t>(j)] = 1;
  basic_values();
  const int most = 50 * (n_ + k_);
  int degenerate = 0, fresh = 0;
  for (; iterations < most; ++iterations) {
    Outcome outcome = Outcome::kOptimal;
    double direction = 1.0;
    int j = -1;
    const bool bland = degenerate > kPatience;
    if (set_costs(with_cost)) {
      j = entering(with_cost, bland, direction);
      outcome = violated_ ? Outcome::kInfeasible : Outcome::kOptimal;
    }
    if (j < 0 || fresh >= kRefresh) {
      // What the updates have added up in rounding is taken away before the last word.
      if (fresh == 0) {
        finish();
        return outcome;
      }
      if (!invert()) break;
      basic_values();
      fresh = 0;
      continue;
    }
    column(j);
    double length = program.upper[j] - program.lower[j];
    bool to_upper = false;
    const int row = leaving(direction, bland, length, to_upper);
    if (row < 0 && std::isinf(length)) return Outcome::kUnbounded;
    degenerate = length <= kDegenerate ? degenerate + 1 : 0;
    const auto index = static_cast<std::size_t>(j);
    basic_ -= direction * length * column_;
    ++fresh;
    if (row < 0) {
      at_upper[index] ^= 1;
      continue;
    }
    basic_[row] = (at_upper[index] ? program.upper[j] : program.lower[j]) + direction * length;
    pivot(row, j, to_upper);
  }
  finish();
  return Outcome::kMaxIterations;
}

BoundedSimplex::Outcome BoundedSimplex::solve(const LinearProgram& program) {
  return run(program, true);
}

BoundedSimplex::Outcome BoundedSimplex::find_feasible(const LinearProgram& program) {
  return run(program, false);
}

}  // namespace condyle::recruitment
