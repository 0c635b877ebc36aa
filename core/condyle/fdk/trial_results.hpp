// SPDX-License-Identifier: Apache-2.0
// What a simulated trial gives, one row a time frame, and how a time frame that has been solved gets
// into it.
#pragma once

#include <string>
#include <vector>

#include "condyle/fdk/force_dependent.hpp"
#include "condyle/fdk/trial_analysis.hpp"

namespace condyle::fdk {

/// Shapes: T time frames, a force-dependent coordinates, n coordinates, C contacts, m muscles, s
/// ligaments, k coordinates that muscles balance.
struct TrialSimulation {
  std::vector<int> force_dependent;        ///< (a) indices of coordinates
  std::vector<std::string> contact_names;  ///< (C)
  TimeFrames q;                ///< (T, n) with α as solved, coupled coordinates filled in
  TimeFrames alpha;            ///< (T, a) [rad, m]
  TimeFrames alpha_residuals;  ///< (T, a) net generalised force on α [Nm, N]
  TimeFrames segment_poses;    ///< (T, 12 b) as TrialAnalysis
  TimeFrames contact_poses;    ///< (T, 6 C) of F in T [m, rad]
  TimeFrames
      contact_wrenches;       ///< (T, 12 C) per contact medial, lateral: on F, at Fo, in T [N, Nm]
  TimeFrames contact_errors;  ///< (T, 12 C) likewise: the model's 95 % bounds
  TimeFrames contact_trust;   ///< (T, C)
  TimeFrames contact_loads;   ///< (T, n) generalised forces of all contacts [Nm, N]
  TimeFrames generalised_forces;  ///< (T, n) τ [Nm, N]
  TimeFrames ligament_loads;      ///< (T, n)
  TimeFrames spring_loads;        ///< (T, n)
  TimeFrames residuals;           ///< (T, n) τ − Q − R f on every coordinate [Nm, N]
  TimeFrames muscle_lengths;      ///< (T, m) [m]
  TimeFrames muscle_strengths;    ///< (T, m) [N]
  TimeFrames passive_forces;      ///< (T, m) [N]
  TimeFrames muscle_forces;       ///< (T, m) active and passive [N]
  TimeFrames activities;          ///< (T, m) active force over strength [-]
  TimeFrames reserves;            ///< (T, k) [Nm, N]
  TimeFrames ligament_lengths;    ///< (T, s) [m]
  TimeFrames ligament_strains;    ///< (T, s) [-]
  TimeFrames ligament_forces;     ///< (T, s) [N]
  std::vector<ForceDependentRecord> records;  ///< (T)
  int not_converged = 0;  ///< time frames that did not, those whose recruitment failed included
  int implausible = 0, untrusted = 0;

  bool converged() const { return not_converged == 0; }
};

/// One line: how many time frames converged; the first that did not, with its worst coordinate and
/// residual.
std::string summary(const TrialSimulation& simulation);

/// Tables of the right sizes, all zero, with names filled in.
/// @param problem of the simulation. @param frames T.
TrialSimulation empty_results(const model::Model& model, const MuscleEquilibrium& problem,
                              Eigen::Index frames);

/// Writes a time frame as `problem` was last evaluated; its record is there already.
/// @pre 0 ≤ row < T. Different rows may be written by different threads.
void keep_time_frame(const MuscleEquilibrium& problem, Eigen::Index row, TrialSimulation& results);

}  // namespace condyle::fdk
