// SPDX-License-Identifier: Apache-2.0
// condyle-sim simulate --model: force-dependent kinematics of a recorded trial.
#pragma once

#include <string>

#include "implant_options.hpp"
#include "trial_options.hpp"

namespace condyle::apps {

/// Simulates the trial of the options, writes its results into the folder `out` (trial_tables.hpp,
/// trial_summary.hpp) and says how it went.
/// @returns kNumericsFailed where a time frame is not in equilibrium: results are written, and the
/// summary names it; else 0.
/// @throws std::invalid_argument for a mistake of the user's; nothing is written then.
int run_trial(const TrialOptions& options, const ImplantOptions& implant, bool hybrid,
              const std::string& out);

}  // namespace condyle::apps
