// SPDX-License-Identifier: Apache-2.0
// A recruitment problem in numbers of order one.
//
//   x = f/(N β),  y = e/(S β),   A x + B y = b,   l ≤ x ≤ u,   objective Σ ŵ x^p + Σ ĉ |y|^p
//   A_ji = s_j R_ji N_i,   B_j = s_j S_j,   b_j = s_j τ_j/β,   s_j = 1/max_i |R_ji N_i|,   β = the largest |s_j τ_j|
//
// Each row then has a largest entry of 1, and the largest load is 1: forces, moments, big and small muscles and loads of
// any size look alike, and what is solved does not depend on units. Weights are divided by their largest.
#pragma once

#include "condyle/recruitment/problem.hpp"

namespace condyle::recruitment {

struct ScaledProblem {
  int n = 0, m = 0;
  RowMatrix A;           ///< (n, m)
  Vector b;              ///< (n)
  Vector lower, upper;   ///< (m); upper is infinite where there are no bounds; both 0 for a muscle of zero strength
  Vector weight;         ///< (m)
  Vector reserve;        ///< (n) B; 0: no reserve
  Vector price;          ///< (n)
  bool has_reserves = false;

  Vector strengths;       ///< (m) N [N]
  Vector row_scale;       ///< (n) s
  double load_scale = 1;  ///< β
  double weight_scale = 1;  ///< weights and prices were divided by it

  /// Sizes everything and sets what does not change. @pre require_valid(setup, settings)
  ScaledProblem(const RecruitmentSetup& setup, const RecruitmentSettings& settings);
  /// Takes one time frame; allocates nothing. @pre require_valid(frame, …)
  void set_frame(const RecruitmentFrame& frame, bool upper_bounds);

  /// Multipliers ∂objective/∂τ_j from those of the scaled problem, ∂(Σ ŵ x^p)/∂b_j.
  double multiplier_scale(int j, double exponent) const;

 private:
  Vector reserve_strengths_;
};

}  // namespace condyle::recruitment
