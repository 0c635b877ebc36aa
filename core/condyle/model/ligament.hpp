// SPDX-License-Identifier: Apache-2.0
// A ligament bundle between the femur and the tibia, after Blankevoort et al. 1991.
//
//   ε = L/L₀ − 1,    F = 0              (ε ≤ 0)
//                    F = k ε²/(4 ε₀)    (0 ≤ ε ≤ 2 ε₀)
//                    F = k (ε − ε₀)     (ε ≥ 2 ε₀)          L₀ = L_r/(1 + ε_r)
//
//   parameter   meaning                                  unit   literature range for one knee bundle
//   k           force per unit strain, linear region     N      1000–9000
//   ε₀          half of the strain where it turns linear  -     0.03 (elsewhere written as transition strain 2 ε₀ = 0.06)
//   ε_r         strain in the reference (extension) pose  -     −0.24 … +0.10
//   L₀          slack length                              m
//
// The stiffness is dF/dL = (dF/dε)/L₀: k is per STRAIN and is divided by the slack length. F is continuously
// differentiable; its second derivative jumps at ε = 0 and 2 ε₀.
// The law itself is in ligament_law.hpp, shared with the strands of a musculoskeletal model.
// The line is straight: no wrapping over bone or implant. Damping is left out: the model is quasi-static.
// Pitfall: k and ε_r of one bundle differ between sources by factors of 2 to 10; treat them as uncertain inputs.
//
// Source: Blankevoort, Kuiper, Huiskes & Grootenboer 1991, J Biomech 24(11):1019–1031, doi:10.1016/0021-9290(91)90019-J.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"

namespace condyle::model {

struct Ligament {
  std::string name;
  Vector3 p_FoA_F = Vector3::Zero();  ///< femoral attachment A, from Fo, in F [m]
  Vector3 p_ToB_T = Vector3::Zero();  ///< tibial attachment B, from To, in T [m]
  double stiffness = 0.0;             ///< k [N per unit strain]
  double slack_length = 0.0;          ///< L₀ [m]
  double transition = 0.03;           ///< ε₀ [-]
};

/// Throws std::invalid_argument naming the ligament, the field, its value and the limit.
void require_valid(const Ligament& ligament);

/// Length of the bundle at a pose [m].
double length(const Ligament& ligament, const Pose& pose);

/// The slack length that gives `reference_strain` at `reference_pose` [m].
double slack_length(const Ligament& ligament, const Pose& reference_pose, double reference_strain);

/// Tension at a length [N], ≥ 0.
double tension(const Ligament& ligament, double length);
/// Its derivative dF/dL [N/m], ≥ 0.
double tension_by_length(const Ligament& ligament, double length);
/// Elastic energy ∫F dL [J].
double energy(const Ligament& ligament, double length);

/// Wrench on the femur, at Fo, expressed in T: the tension pulls A towards B [N, Nm].
Wrench ligament_wrench(const Ligament& ligament, const Pose& pose);
/// ∂wrench_i/∂pose_j of it, as a contact model's stiffness [N/m, N/rad, Nm/m, Nm/rad].
Matrix6 ligament_stiffness(const Ligament& ligament, const Pose& pose);

/// Tibiofemoral bundles of a cruciate-retaining knee replacement: MCL (superficial, deep), posteromedial capsule, LCL,
/// popliteofibular, PCL (anterolateral, posteromedial) and posterior capsule, with the reference strains applied at
/// `reference_pose` (a settled pose near extension of the implant at hand).
///
/// Attachments are strand means of one subject's right knee (OpenSim model "DM" of the opensim-jam project) seen from its
/// implant frames, mirrored in z for a left knee; stiffnesses are that model's sums over strands, reference strains those of its
/// build script. A starting point to be replaced by the user's own, not a subject's anatomy.
std::vector<Ligament> default_ligaments(SideOfBody side_of_body, const Pose& reference_pose);

}  // namespace condyle::model
