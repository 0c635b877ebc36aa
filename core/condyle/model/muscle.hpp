// SPDX-License-Identifier: Apache-2.0
// What a muscle can do at a length and a velocity: a Hill-type fibre behind a rigid tendon.
//
//   fibre      l cos α = L − l_t,  l sin α = l₀ sin α₀ (constant width)  ⇒  l = √((L − l_t)² + (l₀ sin α₀)²)
//   rate       l̇ = L̇ cos α
//   strength   N = F₀ · f_l(l/l₀) · f_v(l̇/(v₀ l₀)) · cos α      tension along the path at full activation, without the passive part
//   passive    P = F₀ · f_p(l/l₀) · cos α                       tension at no activation
//
// Recruitment shares load over strengths; passive tensions act whatever is recruited. A path no longer than the tendon leaves
// the fibre nothing to pull along: strength and passive tension are zero and `slack` is set.
//
// Sources: Hill-type muscle with a rigid tendon: Millard et al. 2013, J Biomech Eng 135(2):021005, doi:10.1115/1.4023390
// (eqs. 1–4); curves: muscle_curves.hpp.
// Pitfall: a rigid tendon suits stiff or short tendons; l_t/l₀ above about 3 (calf) with fast loading is off by more.
#pragma once

#include "condyle/model/model_description.hpp"

namespace condyle::model {

/// What strength depends on.
enum class StrengthModel {
  kConstant,  ///< N = F₀, P = 0: the simple muscle of the paper's recruitment
  kHill,      ///< N and P as above
};

struct MuscleStrength {
  double strength = 0.0;              ///< N [N] ≥ 0
  double strength_by_length = 0.0;    ///< ∂N/∂L at fixed L̇ [N/m]
  double strength_by_velocity = 0.0;  ///< ∂N/∂L̇ [N s/m]
  double passive = 0.0;               ///< P [N] ≥ 0
  double passive_by_length = 0.0;     ///< dP/dL [N/m]
  double fibre_length = 0.0;          ///< l/l₀
  double fibre_velocity = 0.0;        ///< l̇/(v₀ l₀), lengthening positive
  double cos_pennation = 1.0;         ///< cos α
  bool slack = false;                 ///< L ≤ l_t
};

/// Throws std::invalid_argument naming the muscle, the field, its value and the limit.
void require_valid(const MuscleDescription& muscle);

/// @param length L of the path [m]. @param velocity L̇, lengthening positive [m/s].
/// @pre require_valid(muscle).
MuscleStrength muscle_strength(const MuscleDescription& muscle, StrengthModel model, double length,
                               double velocity);

}  // namespace condyle::model
