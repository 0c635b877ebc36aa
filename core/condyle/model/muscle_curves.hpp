// SPDX-License-Identifier: Apache-2.0
// The three dimensionless curves of a Hill-type muscle: smooth, defined everywhere, with their slopes.
//
//   curve                      argument                                              value
//   active force–length        fibre length / optimal                                1 near 1, nearly 0 below 0.4 and above 1.8
//   active force–velocity      fibre velocity / maximal shortening velocity,         1 at 0, 0 near −1, 1.79 at 1
//                              lengthening positive
//   passive force–length       fibre length / optimal                                0 at 0.2, 0.018 at 1, 1 at 1.6
//
// Source: De Groote, Kinney, Rao & Fregly 2016, Ann Biomed Eng 44(10):2922–2936, doi:10.1007/s10439-016-1591-9, with the
// digits that make force–velocity exactly 1 at rest, and the passive curve raised to vanish at 0.2 instead of 1, as in OpenSim's
// DeGrooteFregly2016Muscle, so that it is never negative.
#pragma once

namespace condyle::model {

/// A curve's value and slope at its argument.
struct CurvePoint {
  double value = 0.0;
  double slope = 0.0;
};

/// Σ of three Gauss-like bells.
CurvePoint active_force_length(double normalised_length);
/// d₁·asinh(d₂·v + d₃) + d₄, held at 0 where it would be negative.
CurvePoint force_velocity(double normalised_velocity);
/// (exp(k(l − 1)/e₀) − c)/(exp(k) − c), c = exp(k(0.2 − 1)/e₀), k = 4, e₀ = 0.6; held at 0 below 0.2.
CurvePoint passive_force_length(double normalised_length);

}  // namespace condyle::model
