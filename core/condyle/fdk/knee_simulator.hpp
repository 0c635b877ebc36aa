// SPDX-License-Identifier: Apache-2.0
// Knee simulator: the quasi-static motion of a knee replacement under a load case.
//
// Flexion is driven (θz = −flexion); x, y, z, θx, θy are force-dependent: at every time frame they solve
//
//   Q_contact + Q_applied + Q_ligaments + Q_springs = 0   on x, y, z, θx, θy
//
// with the loads of knee_loads.hpp. Time frames are solved forward, each from the one before; a hard one is approached by
// continuation (flexion and loads in substeps from the last converged time frame). One that does not converge is
// reported with its residual and worst coordinate, and the simulation's status says so: nothing is silently kept.
//
// Pitfall: implants that are flat in the coronal plane have almost no medial–lateral stiffness. z is then hardly determined by
// equilibrium; the residual converges, but z depends on where it started. `restraint.ml_stiffness` can hold it.
//
// Source: FDK after Marra et al. 2015, 2017; set-up after force-controlled simulators ("ISO-like", no claim of compliance).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/common/clinical_kinematics.hpp"
#include "condyle/fdk/knee_equilibrium.hpp"
#include "condyle/fdk/load_case.hpp"
#include "condyle/fdk/settled_pose.hpp"

namespace condyle::fdk {

struct KneeSimulatorSettings {
  numerics::NewtonSettings newton;
  double insert_width = 0.074;      ///< ML width of the insert [m]
  double axial_offset_ratio = 0.07;  ///< axial line medial of To, as a share of insert_width [-]
  RestraintSprings restraint;       ///< set its stiffnesses to 0 to do without
  std::vector<model::Ligament> ligaments;  ///< none by default
  int max_substeps = 64;            ///< continuation: smallest substep is 1/max_substeps of a time frame
  double least_trust = 0.5;         ///< time frames where the model's trust is below this are counted `untrusted`
  SettleSettings settle;            ///< first start and reference of the springs
  std::optional<Pose> initial_pose;  ///< start of the first time frame instead of the settled pose (its θz is not used)
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const KneeSimulatorSettings& settings);

enum class FrameStatus : int {
  kConverged = 0,
  kNotConverged = 1,
  kImplausibleDepth = 2,  ///< in equilibrium, but overlapping deeper than plausible
};
std::string_view name(FrameStatus status);
/// One sentence: what happened, and what the user can do next.
std::string_view advice(FrameStatus status);

/// The forces on the five unknowns, in the order x, y, z, θx, θy.
using KneeResidual = Eigen::Matrix<double, 5, 1>;

struct KneeFrame {
  FrameStatus status = FrameStatus::kNotConverged;
  Pose pose = Pose::Zero();     ///< the last iterate where not converged
  contact::ContactLoads loads;  ///< contact at `pose`, stiffness included
  KneeResidual residual = KneeResidual::Zero();  ///< [N, N, N, Nm, Nm]
  int worst_coordinate = 0;     ///< PoseIndex of the largest residual, by its tolerance
  int iterations = 0;           ///< Newton steps, substeps included
  int evaluations = 0;          ///< contact evaluations, substeps included
  int substeps = 1;             ///< 1: straight from the time frame before
  ClinicalKinematics clinical;
};

struct KneeSimulation {
  std::vector<KneeFrame> frames;  ///< one per row of the load case
  RestraintSprings restraint;     ///< as used, with its references filled in
  double axial_offset = 0.0;      ///< as used [m]
  int not_converged = 0;          ///< number of time frames
  int implausible = 0;            ///< number of time frames in equilibrium with implausible depth
  int untrusted = 0;              ///< number of time frames where the contact model does not trust itself

  bool converged() const { return not_converged == 0; }
};

/// One line: how many time frames converged; the first that did not, with its worst coordinate and residual.
std::string summary(const KneeSimulation& simulation);

/// Simulates `load_case` on the contact model.
/// @throws std::invalid_argument for a load case or a setting that is out of range. Numerics are a status.
KneeSimulation simulate_knee(const contact::ContactModel& model, const LoadCase& load_case,
                             const KneeSimulatorSettings& settings = {});

}  // namespace condyle::fdk
