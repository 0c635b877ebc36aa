// SPDX-License-Identifier: Apache-2.0
// Force-dependent kinematics of a whole trial: secondary kinematics, muscle, ligament and contact
// forces at once, time frame by time frame (force_dependent.hpp says how one is solved).
//
// Time frames are solved forward, each from the ones before: their α extrapolated, then as it was.
// Where equilibrium is not found from nothing in the first one, a trial is entered at another, and
// solved from there in both directions. A time frame that does not converge is kept with its status, its residual and its worst
// coordinate, and the next one starts from the last in equilibrium. At the end those that did not are
// tried once more from the other side. What then is left is said in the summary: nothing is silently
// kept.
//
// With `chunk`, a trial is cut into runs of that many time frames, each with a start of its own,
// and these are spread over threads: results are the same bytes for any number of threads (not for
// any chunk: a Newton iteration stops within its tolerance at a place that depends on where it
// began).
#pragma once

#include <string>
#include <vector>

#include "condyle/fdk/force_dependent.hpp"
#include "condyle/fdk/trial_analysis.hpp"

namespace condyle::fdk {

struct TrialSimulationSettings {
  MuscleSettings muscles;
  ForceDependentSettings solver;
  /// Rates and accelerations of α as the trial gives them, instead of 0 (quasi-static).
  bool keep_rates = false;
  int extrapolation = 1;  ///< degree of the extrapolation of α over time frames: 0, 1 or 2
  int chunk = 0;          ///< time frames solved one after another; 0: all
  int threads = 1;        ///< 0: all; more than one helps where there are chunks
  double least_trust =
      0.5;  ///< time frames where a contact's trust is below are counted `untrusted`
  SeatingSettings seating;  ///< of the start that is used where none is given
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const TrialSimulationSettings& settings);

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

/// @param input as for analyse_trial; the α of `q` are starts where `starts` says nothing.
/// @param starts (0 rows, 1 or T; a): α to begin with. One row: of the first time frame (of every
/// chunk). T rows: also where the way from the time frame before fails. None: a chunk begins with
/// the first contact seated, then with `input.q`.
/// @throws std::invalid_argument for an input, a contact or a setting that is not valid, by name.
/// Numerics are a status.
TrialSimulation simulate_trial(const model::Model& model, const TrialInput& input,
                               std::span<const BodyContactDescription> contacts,
                               const TimeFrames& starts = {},
                               const TrialSimulationSettings& settings = {});

}  // namespace condyle::fdk
