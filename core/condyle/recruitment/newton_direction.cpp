// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/newton_direction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace condyle::recruitment {
namespace {

// Of the diagonal: less than rounding costs the factorisation, more than rounding can turn negative.
constexpr double kOwnShift = 1e-13;

// The least share of a row that the rows before it may leave of it.
constexpr double kIndependent = 1e-10;

}  // namespace

NewtonDirection::NewtonDirection(int n, int m, Method method)
    : n_(n), m_(m), method_(method), columns_(n, m), free_(static_cast<std::size_t>(m)), roots_(m), hessian_(RowMatrix::Zero(n, n)), cholesky_(n) {
  if (method == Method::kNormal) return;
  // Muscles, reserves, shifts.
  const int rows = m + 2 * n;
  order_.resize(static_cast<std::size_t>(m));
  graded_.resize(rows, n);
  qr_ = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(rows, n);
  permuted_.resize(n);
  image_.resize(rows);
  room_.resize(1);
}

bool NewtonDirection::factorise(const ScaledProblem& problem, const Vector& slope,
                                const Vector& reserve_slope, const Vector& usual, double shift) {
  problem_ = &problem;
  slope_ = &slope;
  reserve_slope_ = &reserve_slope;
  if (method_ == Method::kGraded) return factorise_graded(usual, shift);
  hessian_.diagonal() = shift * usual;
  return factorise_normal();
}

bool NewtonDirection::factorise_normal() {
  int count = 0;
  for (int i = 0; i < m_; ++i) {
    if ((*slope_)[i] == 0.0) continue;
    free_[static_cast<std::size_t>(count)] = i;
    roots_[count++] = std::sqrt((*slope_)[i]);
  }
  for (int j = 0; j < n_; ++j) {
    const double* from = problem_->A.row(j).data();
    double* to = columns_.row(j).data();
    for (int k = 0; k < count; ++k) to[k] = from[free_[static_cast<std::size_t>(k)]] * roots_[k];
    const auto row = columns_.row(j).head(count);
    for (int k = 0; k < j; ++k) hessian_(j, k) = row.dot(columns_.row(k).head(count));
    const double reserve = problem_->reserve[j] * problem_->reserve[j] * (*reserve_slope_)[j];
    hessian_(j, j) += (1.0 + kOwnShift) * (row.squaredNorm() + reserve);
  }
  cholesky_.compute(hessian_);
  return cholesky_.info() == Eigen::Success;
}

bool NewtonDirection::factorise_graded(const Vector& usual, double shift) {
  std::iota(order_.begin(), order_.end(), 0);
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    return (*slope_)[a] != (*slope_)[b] ? (*slope_)[a] > (*slope_)[b] : a < b;
  });
  for (int k = 0; k < m_; ++k) {
    const int i = order_[static_cast<std::size_t>(k)];
    graded_.row(k) = std::sqrt((*slope_)[i]) * problem_->A.col(i).transpose();
  }
  graded_.bottomRows(2 * n_).setZero();
  for (int j = 0; j < n_; ++j) {
    graded_(m_ + j, j) = problem_->reserve[j] * std::sqrt((*reserve_slope_)[j]);
    graded_(m_ + n_ + j, j) = std::sqrt(shift * usual[j]);
  }
  qr_.compute(graded_);
  return qr_.matrixR().diagonal().head(n_).cwiseAbs().minCoeff() > 0.0;
}

bool NewtonDirection::regular(const Vector& usual, double shift) const {
  for (int j = 0; j < n_; ++j) {
    if (method_ == Method::kNormal) {
      const double pivot = cholesky_.matrixLLT()(j, j);
      if (pivot * pivot < std::max(kIndependent * hessian_(j, j), 1e3 * shift * usual[j])) return false;
    } else {
      const double pivot = qr_.matrixR()(j, j);
      const auto column = qr_.colsPermutation().indices()[j];
      if (pivot * pivot < std::max(kIndependent, 1e3 * shift) * usual[column]) return false;
    }
  }
  return true;
}

void NewtonDirection::solve(const Vector& r, Vector& step, Vector& dz) {
  if (method_ == Method::kGraded) return solve_graded(r, step, dz);
  step = r;
  cholesky_.solveInPlace(step);
  dz.setZero();
  for (int j = 0; j < n_; ++j) dz += step[j] * problem_->A.row(j).transpose();
}

// With W P = Q U: Δ = P U⁻¹ U⁻ᵀ Pᵀ r and W Δ = Q U⁻ᵀ Pᵀ r, whose rows are √D dz.
void NewtonDirection::solve_graded(const Vector& r, Vector& step, Vector& dz) {
  const auto& pivots = qr_.colsPermutation().indices();
  for (int j = 0; j < n_; ++j) permuted_[j] = r[pivots[j]];
  const auto U = qr_.matrixR().topLeftCorner(n_, n_).triangularView<Eigen::Upper>();
  U.transpose().solveInPlace(permuted_);
  image_.setZero();
  image_.head(n_) = permuted_;
  for (int k = n_ - 1; k >= 0; --k) {
    const auto essential = qr_.matrixQR().col(k).tail(image_.size() - k - 1);
    image_.tail(image_.size() - k)
        .applyHouseholderOnTheLeft(essential, qr_.hCoeffs()[k], room_.data());
  }
  U.solveInPlace(permuted_);
  for (int j = 0; j < n_; ++j) step[pivots[j]] = permuted_[j];
  for (int k = 0; k < m_; ++k) {
    const int i = order_[static_cast<std::size_t>(k)];
    const double D = (*slope_)[i];
    dz[i] = D > 0.0 ? image_[k] / std::sqrt(D) : problem_->A.col(i).dot(step);
  }
}

}  // namespace condyle::recruitment
