// SPDX-License-Identifier: Apache-2.0
// What condyle-sim says of a simulated trial: result, peaks, residuals, time by phase.
#pragma once

#include <string>

#include "trial_run.hpp"

namespace condyle::apps {

/// Where the time went [s]; it differs from run to run and is in no file.
struct TrialSeconds {
  double contact_models = 0.0, solving = 0.0, pressures = 0.0;
};

/// Says it on standard output; the line on what is not in equilibrium goes to standard error.
/// @param paths_given whether there were path snapshots.
void say_trial(const TrialRun& run, const std::string& out, bool paths_given,
               const TrialSeconds& spent);

}  // namespace condyle::apps
