// SPDX-License-Identifier: Apache-2.0
// Force-dependent kinematics for a simulator of one's own: given loads, moment arms and strengths over time, the secondary
// knee coordinates, muscle, ligament and contact forces in equilibrium. No body model is needed.
//
// At every time frame flexion is driven (θz = −flexion) and x, y, z, θx, θy solve the equations of
// given_loads_equilibrium.hpp. The first time frame starts from the seated pose (seating.hpp), the others from the one before;
// a hard one is approached by continuation, everything given interpolated in substeps from the last time frame in equilibrium
// (at first from the seated pose without loads). What does not converge, what muscles cannot balance and what is deeper than
// plausible is a status with a message: nothing is silently kept.
//
// The same input gives the same bytes; time frames depend on those before them through their starts alone.
//
// Pitfall: loads and arms must be about the implant's own coordinates, Fo and T's axes, with the body's segments where the
// pose puts them within what one accepts: an offset of the joint centre is a moment of the force times it.
//
// Source: FDK after Andersen, de Zee, Damsgaard, Nolte & Rasmussen 2017, J Biomech Eng 139:091001, and Marra et al. 2015, 2017.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/common/clinical_kinematics.hpp"
#include "condyle/fdk/given_loads_equilibrium.hpp"
#include "condyle/fdk/seating.hpp"

namespace condyle::fdk {

struct GivenLoadsSettings {
  numerics::NewtonSettings newton;
  recruitment::RecruitmentSettings recruitment;
  int max_substeps = 64;      ///< continuation: smallest substep is 1/max_substeps of a time frame
  double least_trust = 0.5;   ///< time frames where the contact model's trust is below this are counted `untrusted`
  SeatingSettings seating;    ///< first start
  std::optional<Pose> initial_pose;  ///< start of the first time frame instead of it (its θz is not used)
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const GivenLoadsSettings& settings);

enum class GivenLoadsStatus : int {
  kConverged = 0,
  kNotConverged = 1,
  kImplausibleDepth = 2,  ///< in equilibrium, but overlapping deeper than plausible
  kInfeasible = 3,        ///< muscles within their bounds cannot balance the loads at the pose reached
};
std::string_view name(GivenLoadsStatus status);
/// One sentence: what happened, and what the user can do next.
std::string_view advice(GivenLoadsStatus status);

struct GivenLoadsResult {
  GivenLoadsStatus status = GivenLoadsStatus::kNotConverged;
  Pose pose = Pose::Zero();              ///< the last iterate where not converged
  contact::ContactLoads loads;           ///< contact at `pose`, stiffness included
  recruitment::Vector muscle_forces;     ///< (m) [N]
  recruitment::Vector activities;        ///< (m) force by strength [-]
  recruitment::Vector reserves;          ///< (n) [Nm, N]
  recruitment::Vector unmet;             ///< (n) of the balanced coordinates: τ less all that acts [Nm, N]
  std::vector<double> ligament_tensions;  ///< in the setup's order [N]
  Secondary residual = Secondary::Zero();  ///< on α [N, N, N, Nm, Nm]
  int worst_coordinate = 0;              ///< PoseIndex of the largest residual, by its tolerance
  int iterations = 0;                    ///< Newton steps, substeps included
  int evaluations = 0;                   ///< contact evaluations, substeps included; seating not
  int substeps = 1;                      ///< 1: straight from the time frame before
  ClinicalKinematics clinical;
  std::string message;                   ///< what went wrong, with names; empty where converged
};

struct GivenLoadsSimulation {
  std::vector<GivenLoadsResult> frames;
  int not_converged = 0;  ///< number of time frames
  int infeasible = 0;     ///< number of time frames
  int implausible = 0;    ///< number of time frames in equilibrium with implausible depth
  int untrusted = 0;      ///< number of time frames where the contact model does not trust itself

  /// Every time frame is in equilibrium, with muscles that can.
  bool converged() const { return not_converged == 0 && infeasible == 0; }
};

/// One line: how many time frames converged; the first that did not, and why.
std::string summary(const GivenLoadsSimulation& simulation);

/// Solves time frames one after another.
/// @throws std::invalid_argument naming time frame and field for what cannot be meant; where there are no time frames; where
///   the contact model is of the other side of the body. Numerics are a status.
GivenLoadsSimulation solve_given_loads(const contact::ContactModel& contact,
                                       const GivenLoadsSetup& setup,
                                       std::span<const GivenLoadsFrame> frames,
                                       const GivenLoadsSettings& settings = {});

}  // namespace condyle::fdk
