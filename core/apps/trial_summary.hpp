// SPDX-License-Identifier: Apache-2.0
// What a simulation came from, how it went, and what went wrong, as JSON. No clock, host or folder
// is in it: the same inputs give the same bytes.
#pragma once

#include "condyle/io/json_text.hpp"
#include "trial_run.hpp"

namespace condyle::apps {

inline constexpr const char* kTrialFormat = "condyle-trial-simulation";

/// Content of summary.json but for its list of files; keys as in the Python command's.
/// @throws std::invalid_argument for an input that cannot be read any more, naming it.
io::JsonObject trial_summary(const TrialRun& run);

}  // namespace condyle::apps
