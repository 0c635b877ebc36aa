// SPDX-License-Identifier: Apache-2.0
// Recruitment with any p > 1 by a primal–dual interior point method: slower than the dual Newton method, and not led
// astray by its kinks.
//
//   p ŵ x^(p−1) − Aᵀλ − s + t = 0,   A x = b,   (x − l) s = μ,   (u − x) t = μ,   μ → 0
//
// For large p, x(λ) of the dual is a root of high order: a muscle that begins to act does so at infinite slope, and
// Newton's method on the dual jumps to and fro between a muscle acting and not. Here forces are unknowns of their own.
// Reserves are free variables. Predictor and corrector after [Mehrotra 1992, SIAM J Optim 2:575]; steps are shortened where
// they would raise the first equation's residual, which is not linear.
//
// Muscles that do nearly nothing are known only to about (1e-15)^(1/(p−1)) of the largest activity; DualNewton::polish
// goes on from here. No allocation after construction.
#pragma once

#include "condyle/recruitment/newton_direction.hpp"
#include "condyle/recruitment/scaled_problem.hpp"

namespace condyle::recruitment {

class InteriorPoint {
 public:
  /// @pre exponent > 1
  InteriorPoint(int n, int m, double exponent);

  /// Starts from positive forces (m) of any problem like it, such as the solution for another p. True where the gap closes.
  bool solve(const ScaledProblem& problem, const Vector& start, int max_iterations);

  Vector x, y;          ///< (m), (n)
  Vector multipliers;   ///< (n) λ, of the scaled problem
  Vector price_gap;     ///< (m) z = p ŵ x^(p−1) − s + t, and so Aᵀλ
  Vector slope, reserve_slope;  ///< (m), (n) D and E of NewtonDirection at the solution
  int iterations = 0;

 private:
  void begin(const Vector& start);
  void linearise(double gap);
  double stationarity();
  bool direction(double target, bool corrected);
  double longest_step() const;
  double gap() const;
  double gap_after(double length) const;
  bool advance(double length, double gap);
  void take(double length);
  void forces_out();
  bool moves(int i) const { return problem_->upper[i] > problem_->lower[i]; }

  const ScaledProblem* problem_ = nullptr;
  int n_, m_;
  double p_, size_ = 1.0, largest_load_ = 1.0;
  NewtonDirection newton_;
  Vector lower_, upper_, v_, s_, t_, slope_, rd_, g_, dv_, ds_, dt_, ds_dv_, dt_dv_, dz_;  // (m)
  Vector w_, reserve_slope_, reserve_rd_, dw_, usual_, rp_, rows_, dlambda_;               // (n)
  int bounds_ = 1;  // pairs of a slack and its multiplier
};

}  // namespace condyle::recruitment
