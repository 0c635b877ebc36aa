// SPDX-License-Identifier: Apache-2.0
// The force of a ligament's line at a length: Blankevoort et al. 1991, or a linear spring.
//
//   ε = L/L₀ − 1
//   Blankevoort   F = 0              (ε ≤ 0)         linear   F = 0            (L ≤ L₀)
//                 F = k ε²/(2 ε_t)   (0 ≤ ε ≤ ε_t)            F = k (L − L₀)   (L ≥ L₀)
//                 F = k (ε − ε_t/2)  (ε ≥ ε_t)
//   damping       F_d = c ε̇ s(ε/0.01)   while ε > 0 and ε̇ > 0
//                 s(x) = x³(10 − 15x + 6x²) up to x = 1, then 1
//
//   parameter   meaning                                   unit   range for one strand or bundle
//   k           Blankevoort: force per unit strain        N      250–9000
//               linear: force per length                  N/m    ~1e6 (patellar ligament)
//   L₀          slack length                              m
//   ε_t         strain where the toe ends (2 ε₀)          -      0.06
//   c           damping, OpenSim's `damping_coefficient`  N s    0.003
//
// The stiffness of Blankevoort's law is dF/dL = (dF/dε)/L₀: k is per STRAIN and is divided by the
// slack length. F is continuously differentiable; its second derivative jumps at ε = 0 and ε_t.
// The linear law's stiffness jumps at L₀.
// Pitfall: OpenSim 4.6's damping force is c ε̇, without k (others of the name multiply by k).
//
// Source: Blankevoort, Kuiper, Huiskes & Grootenboer 1991, J Biomech 24(11):1019–1031,
// doi:10.1016/0021-9290(91)90019-J.
#pragma once

#include <string>

#include "condyle/model/model_description.hpp"

namespace condyle::model {

struct LigamentForceLaw {
  LigamentLaw kind = LigamentLaw::kBlankevoort;
  double stiffness = 0.0;           ///< k [N per unit strain, or N/m]
  double slack_length = 0.0;        ///< L₀ [m]
  double transition_strain = 0.06;  ///< ε_t [-]
  double damping = 0.0;             ///< c [N s]
};

/// The law of a model's ligament.
LigamentForceLaw force_law(const LigamentDescription& ligament);

/// Throws std::invalid_argument naming the owner ("ligament 'pCAP1'"), the field, its value and the
/// limit.
void require_valid(const LigamentForceLaw& law, const std::string& owner);

struct LigamentTension {
  double strain = 0.0;     ///< ε [-]
  double force = 0.0;      ///< F [N] ≥ 0
  double by_length = 0.0;  ///< dF/dL [N/m] ≥ 0
};

/// @param length L [m]. @pre require_valid(law).
LigamentTension tension(const LigamentForceLaw& law, double length);

/// Elastic energy ∫F dL [J].
double energy(const LigamentForceLaw& law, double length);

struct LigamentDamping {
  double force = 0.0;        ///< F_d [N] ≥ 0
  double by_length = 0.0;    ///< ∂F_d/∂L at fixed L̇ [N/m]
  double by_velocity = 0.0;  ///< ∂F_d/∂L̇ [N s/m]
};

/// @param velocity L̇, lengthening positive [m/s]. The linear law has none.
LigamentDamping damping(const LigamentForceLaw& law, double length, double velocity);

}  // namespace condyle::model
