// SPDX-License-Identifier: Apache-2.0
// How far forces and multipliers are from satisfying the optimality conditions, computed from the problem alone.
//
// With reduced costs d = p ŵ x^(p−1) − Aᵀλ, each number is relative to the largest of its kind:
//   primal           |b − A x − B y|, and bounds overstepped
//   stationarity     what no multiplier of a bound can explain: −d without an upper bound, a reserve's reduced cost
//   complementarity  min(d₊, x − l) and min(d₋, u − x)
// For min–max the conditions are those of the first level t = max ŵ x: multipliers of what is at it sum to 1, and whoever has one is
// there.
#pragma once

#include "condyle/recruitment/scaled_problem.hpp"

namespace condyle::recruitment {

struct KktResiduals {
  double primal = 0;
  double stationarity = 0;
  double complementarity = 0;

  double largest() const;
};

/// x (m), y (n), multipliers (n) of the scaled problem.
KktResiduals kkt_residuals(const ScaledProblem& problem, const Criterion& criterion,
                           const Eigen::Ref<const Vector>& x, const Eigen::Ref<const Vector>& y,
                           const Eigen::Ref<const Vector>& multipliers);

/// Largest ŵ_i x_i of a muscle above its passive minimum, or ĉ_j |y_j|.
double largest_level(const ScaledProblem& problem, const Eigen::Ref<const Vector>& x,
                     const Eigen::Ref<const Vector>& y);

}  // namespace condyle::recruitment
