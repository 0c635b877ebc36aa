// SPDX-License-Identifier: Apache-2.0
// Lexicographic min–max recruitment: a sequence of levels t₁ ≥ t₂ ≥ …
//
//   t_k = min t   subject to   A x + B y = b,   l ≤ x ≤ u,   ŵ_i x_i ≤ t and ĉ_j |y_j| ≤ t for all that are still free
//
// t_k is the root of the least violation h(t) of these bounds, a falling piecewise linear function: from below, each proof λ of
// infeasibility (BoundedSimplex) gives the t at which it proves nothing more, and the last one names what must be at its
// bound at t_k in EVERY solution: (Aᵀλ)_i > 0 at its largest, < 0 at its least. These are held and the rest is free for
// the next level, until what is free is determined by the equations. Those are then solved for the levels and the free
// forces together, so that equations hold to rounding; what rounding leaves undetermined gets the least squares.
// Two or three levels are usual, one for each group of coordinates that shares muscles.
// A muscle whose passive minimum exceeds t is held at it.
#pragma once

#include <vector>

#include "condyle/recruitment/active_system.hpp"
#include "condyle/recruitment/bounded_simplex.hpp"
#include "condyle/recruitment/scaled_problem.hpp"

namespace condyle::recruitment {

class MinMax {
 public:
  MinMax(int n, int m);

  enum class Outcome { kConverged, kInfeasible, kMaxIterations };
  Outcome solve(const ScaledProblem& problem);

  Vector x, y;                 ///< (m), (n)
  Vector multipliers;          ///< (n) ∂t₁/∂b
  std::vector<double> levels;  ///< t₁, t₂, …
  /// (m + 2n) muscles, reserves forwards, reserves backwards: Held, or the index of a level.
  std::vector<int> held;
  ActiveSystem system;         ///< of the solution
  int iterations = 0;          ///< simplex steps

 private:
  enum class Level { kFound, kRest, kInfeasible, kMaxIterations };

  void begin();
  void set_bounds(double t);
  double weight(int i) const;
  double upper_at(int i, double t) const;
  double proof_at(double t) const;
  double root(double t) const;
  Level next_level(double& t);
  bool hold(double t, int level);
  bool free_left() const;
  Outcome solve_equations();

  const ScaledProblem* problem_ = nullptr;
  int n_, m_, k_;
  LinearProgram program_;
  BoundedSimplex simplex_;
  Vector own_lower_, own_upper_, value_;  // (k)
  Vector proof_, rows_;                   // (n)
  Vector z_;                              // (k) Gᵀ proof
};

}  // namespace condyle::recruitment
