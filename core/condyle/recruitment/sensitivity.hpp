// SPDX-License-Identifier: Apache-2.0
// How forces change with loads τ, moment arms R and strengths N: the implicit function theorem on the optimality conditions
// of the muscles between their bounds.
//
// p > 1, scaled as in ScaledProblem, with dâ the change of a column of A (from dR and dN) and D, E of NewtonDirection:
//   dx = D (dâᵀλ + Aᵀ dλ),    (A D Aᵀ + B E B) dλ = db − dA x − A D dAᵀλ,    df = β (N dx + x dN)
// p = 1 and min–max: the equations of ActiveSystem with the right-hand side db − dA x. A muscle at its strength follows it
// (df = dN); one at 0 or at its passive minimum stays there (minima are held fixed).
//
// Where the set of muscles at bounds changes, forces have a kink and no derivative. What is returned there is the derivative
// on one side, with the set as it was found. For p > 2 the slope of a muscle that begins to act is infinite, for p < 2
// zero. For p = 1 and min–max forces may also jump where two bases are equally good.
// `regular` false: the muscles between their bounds cannot answer some change of the loads (all at their bounds, say); the
// result answers as much of it as they can.
#pragma once

#include "condyle/recruitment/active_system.hpp"
#include "condyle/recruitment/newton_direction.hpp"

namespace condyle::recruitment {

class Sensitivity {
 public:
  /// `graded`: see NewtonDirection; for p > 3.
  Sensitivity(int n, int m, bool graded);

  /// At a solution of the scaled problem; keeps references.
  void at_power(const ScaledProblem& problem, const Vector& x, const Vector& multipliers,
                const Vector& slope, const Vector& reserve_slope);
  void at_linear(const ScaledProblem& problem, const Vector& x, ActiveSystem& system);

  /// One direction: dτ (n) [Nm, N], dR (n, m) or of no rows [m], dN (m) or of size 0 [N] → df (m) [N], de (n) [Nm, N].
  void along(const Eigen::Ref<const Vector>& loads, const Eigen::Ref<const RowMatrix>& moment_arms,
             const Eigen::Ref<const Vector>& strengths, Eigen::Ref<Vector> forces, Eigen::Ref<Vector> reserves);
  bool regular() const { return regular_; }

 private:
  void changed_columns(const Eigen::Ref<const RowMatrix>& moment_arms,
                       const Eigen::Ref<const Vector>& strengths);
  void answer_power();

  const ScaledProblem* problem_ = nullptr;
  const Vector *x_ = nullptr, *multipliers_ = nullptr, *slope_ = nullptr, *reserve_slope_ = nullptr;
  ActiveSystem* system_ = nullptr;
  int n_, m_;
  bool regular_ = true;
  NewtonDirection direction_;
  Vector usual_, rows_, dlambda_, dy_;  // (n)
  Vector fixed_, dz_, dx_, own_;        // (m)
  RowMatrix dA_;
};

}  // namespace condyle::recruitment
