// SPDX-License-Identifier: Apache-2.0
// The bracketed search behind a static equilibrium, for samples that Newton does not settle. Internal to fdk.
#pragma once

#include "condyle/fdk/static_equilibrium.hpp"

namespace condyle::fdk::detail {

/// One sample being solved: evaluates the contact and keeps count, residuals and tolerances.
class SampleState {
 public:
  SampleState(const contact::ContactModel& model, const StaticEquilibriumSettings& settings,
              const StaticLoad& load, StaticEquilibrium& result);

  /// Evaluates at `p`; result.pose and result.loads are then those of `p`.
  void evaluate(const SensitivePoint& p);

  double Fy_residual() const { return result.loads.total_wrench()[1] - load.Fy; }
  double Mx_residual() const { return result.loads.total_wrench()[3] - load.Mx; }
  bool Fy_met() const;
  bool Mx_met() const;  ///< true where θx is given
  bool spent() const { return result.evaluations >= settings.max_evaluations; }
  SensitivePoint at() const { return {result.pose[kY], result.pose[kThetaX]}; }

  /// dMx/dθx along the y(θx) that keeps Fy: ∂Mx/∂θx − ∂Mx/∂y ∂Fy/∂θx / ∂Fy/∂y [Nm/rad]; NaN where Fy has no stiffness.
  double reduced_rotational_stiffness() const;

  const contact::ContactModel& model;
  const StaticEquilibriumSettings& settings;
  const StaticLoad& load;
  StaticEquilibrium& result;
};

/// Brings y at fixed θx to Fy*, starting from y. Bracketed: terminates on any continuous Fy that rises as y falls.
/// @param slack accepts |ΔFy| ≤ slack · Fy*, too [-].
/// @returns kConverged (Fy met), kOffInsert, kOverclosure or kNotConverged; state holds the last evaluation.
EquilibriumStatus solve_y(SampleState& state, SensitivePoint start, double slack = 0.0);

/// Brings (y, θx) to (Fy*, Mx*) along y(θx), starting from `start`.
EquilibriumStatus search_theta_x(SampleState& state, SensitivePoint start);

}  // namespace condyle::fdk::detail
