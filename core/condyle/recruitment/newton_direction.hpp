// SPDX-License-Identifier: Apache-2.0
// The linear system of a Newton step, and of every sensitivity, of recruitment with p > 1.
//
//   (A D Aᵀ + B E B + shift·diag(h)) Δ = r,      dz = Aᵀ Δ
//
// with D ≥ 0 of the muscles, E ≥ 0 of the reserves, h a usual curvature. Two ways:
//   kNormal: Cholesky of the matrix itself. Fast; errors of 1e-16 of its largest entry.
//   kGraded: Householder QR with column pivoting of √D Aᵀ, rows sorted by size. For p > 3, D of muscles that do nearly
//     nothing is 1e10 and more times that of the others, and would drown them in the sum. Row-wise stable [Cox & Higham
//     1998, Numer Math 79:1], and dz is taken from the factors, so that it is right relative to itself for each muscle.
// No allocation after construction.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <vector>

#include "condyle/recruitment/scaled_problem.hpp"

namespace condyle::recruitment {

class NewtonDirection {
 public:
  enum class Method { kNormal, kGraded };

  NewtonDirection(int n, int m, Method method);

  /// Factorises. False where the matrix is not positive definite to rounding: a larger shift is needed.
  /// `slope` (m) D, `reserve_slope` (n) E, `usual` (n) h.
  bool factorise(const ScaledProblem& problem, const Vector& slope, const Vector& reserve_slope,
                 const Vector& usual, double shift);
  /// False where some direction of λ is held by the shift alone.
  bool regular(const Vector& usual, double shift) const;
  /// Δ (n) and dz (m) for a right-hand side r (n). @pre factorise returned true
  void solve(const Vector& r, Vector& step, Vector& dz);

 private:
  bool factorise_normal();
  bool factorise_graded(const Vector& usual, double shift);
  void solve_graded(const Vector& r, Vector& step, Vector& dz);

  const ScaledProblem* problem_ = nullptr;
  const Vector* slope_ = nullptr;
  const Vector* reserve_slope_ = nullptr;
  int n_, m_;
  Method method_;
  RowMatrix columns_;  // (n, m) the columns of A with D > 0, times √D
  std::vector<int> free_;  // the muscles with D > 0 …
  Vector roots_;           // … and their √D
  Eigen::MatrixXd hessian_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  std::vector<int> order_;  // rows of graded_: muscles by falling size of √D
  Eigen::MatrixXd graded_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  Vector permuted_, image_, room_;
};

}  // namespace condyle::recruitment
