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

#include "condyle/fdk/force_dependent.hpp"
#include "condyle/fdk/trial_analysis.hpp"
#include "condyle/fdk/trial_results.hpp"

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
