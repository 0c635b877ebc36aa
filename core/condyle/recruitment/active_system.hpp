// SPDX-License-Identifier: Apache-2.0
// The equations once it is known what each muscle and reserve does at the solution of a linear criterion.
//
//   Σ_k T_k t_k + Σ_free G_i v_i = b − Σ_held G_i v_i,      T_k = Σ_{i held at level k} G_i/ŵ_i,     G = [A, B, −B]
//
// For p = 1 there are no levels and the free ones are the basis; for min–max the t_k are unknowns beside the few that are
// free. Solved in the least-squares sense with the smallest unknowns, by a complete orthogonal decomposition: it serves
// solutions and, with another right-hand side, their derivatives.
#pragma once

#include <Eigen/QR>
#include <vector>

#include "condyle/recruitment/scaled_problem.hpp"

namespace condyle::recruitment {

/// What a variable does at the solution; 0, 1, … is held at level t_k/ŵ.
enum Held : int { kFree = -1, kAtLower = -2, kAtUpper = -3 };

class ActiveSystem {
 public:
  ActiveSystem(int n, int m);

  /// `held` (m + 2n): muscles, reserves forwards, reserves backwards. False where there are more unknowns than equations.
  bool build(const ScaledProblem& problem, const std::vector<int>& held, int levels);
  /// True where no unknown is left to choose.
  bool determined() const { return decomposition_.rank() == unknowns_; }
  int unknowns() const { return unknowns_; }
  /// What solves for `rows` (n): changes of free and levelled muscles dx (m) and reserves dy (n); 0 elsewhere.
  void solve(const Vector& rows, Vector& dx, Vector& dy);
  /// t_k of the last solve.
  double level(int k) const { return solution_[k]; }

 private:
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoordinates, kMaxCoordinates>;
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxCoordinates, 1>;

  const ScaledProblem* problem_ = nullptr;
  const std::vector<int>* held_ = nullptr;
  int n_, m_, levels_ = 0, unknowns_ = 0;
  Small matrix_;
  SmallVector rows_, solution_;
  Eigen::CompleteOrthogonalDecomposition<Small> decomposition_;
};

}  // namespace condyle::recruitment
