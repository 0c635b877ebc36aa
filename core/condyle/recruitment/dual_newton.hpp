// SPDX-License-Identifier: Apache-2.0
// Recruitment with p > 1 by Newton's method on its dual, which has as many unknowns as equations.
//
// With multipliers λ, z = Aᵀλ and q = 1/(p − 1), the force that minimises the Lagrangian is known muscle by muscle,
//
//   x_i(λ) = clamp((z_i/(p ŵ_i))₊^q, l_i, u_i),      y_j(λ) = sign(λ_j) (B_j |λ_j|/(p ĉ_j))^q
//
// and λ maximises the concave, once differentiable, piecewise smooth
//
//   g(λ) = bᵀλ − Σ_i (z_i x_i − ŵ_i x_i^p) − Σ_j …,   ∇g = b − A x − B y,   −∇²g = A D Aᵀ + B E B,
//   D_i = ∂x_i/∂z_i = q x_i/z_i where l_i < x_i < u_i, else 0
//
// A step solves (−∇²g + shift) Δ = ∇g and is bounded, since g is linear where all muscles are at their bounds; Armijo's
// rule on g, and near the solution, where differences of g are rounding, on its slope. Convergence is quadratic once the set
// of muscles at their bounds is found, so what is returned satisfies the equations to rounding.
//
// No solution: g is unbounded, and a direction of growth is a certificate.
// Serial, and the same bytes for the same input. No allocation after construction.
#pragma once

#include "condyle/recruitment/newton_direction.hpp"
#include "condyle/recruitment/scaled_problem.hpp"

namespace condyle::recruitment {

class DualNewton {
 public:
  /// For n coordinates and m muscles. @pre exponent > 1
  DualNewton(int n, int m, double exponent);

  enum class Outcome { kConverged, kUnbounded, kMaxIterations };

  /// Maximises g from `multipliers` where `warm`, else from the solution for p = 2 without bounds.
  Outcome solve(const ScaledProblem& problem, bool warm, int max_iterations, double tolerance);

  /// As solve, from `multipliers` and a z (m) that is Aᵀλ more exactly than can be computed from λ.
  Outcome polish(const ScaledProblem& problem, const Vector& z, int max_iterations, double tolerance);

  Vector multipliers;    ///< (n) λ, of the scaled problem; in and out
  Vector x, y;           ///< (m), (n) forces there
  Vector slope;          ///< (m) D
  Vector reserve_slope;  ///< (n) E
  int iterations = 0;    ///< Newton steps of the last solve
  double residual = 0;   ///< largest |b − A x − B y|/(1 + the largest x)

 private:
  void prepare();
  void set_usual();
  void start();
  double best_size() const;
  Outcome iterate(int max_iterations, double tolerance);
  /// x, y, r and g at λ = multipliers with z = z_; returns g.
  double respond();
  void slopes();
  double respond_muscles();
  double respond_reserves();
  double power(double base) const;
  bool newton_direction();
  bool line_search(double& value);
  bool grows_for_ever() const;
  double relative_residual() const;

  const ScaledProblem* problem_ = nullptr;
  int n_, m_;
  double p_, q_;
  Vector gain_;                  // 1/(p w)
  Vector z_low_, z_high_;        // x leaves its bounds between them
  Vector cost_low_, cost_high_;  // w l^p, w u^p
  Vector z_, dz_, r_, step_, start_lambda_, start_z_;
  Vector usual_;    // diagonal of A W⁻¹ Aᵀ + B C⁻¹ B: what a curvature is for p = 2
  NewtonDirection start_direction_, direction_;
};

}  // namespace condyle::recruitment
