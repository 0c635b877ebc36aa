// SPDX-License-Identifier: Apache-2.0
// The subcommands of condyle-sim. Each adds itself to the program and, if it is the one asked for,
// runs while the command line is parsed, setting `exit_code` where it is not 0. A mistake of the
// user's is an exception with one line of text.
#pragma once

#include <CLI/CLI.hpp>

namespace condyle::apps {

/// 0: done. 1: done, but the numerics failed somewhere (the output says where). 2: the user's
/// mistake.
inline constexpr int kNumericsFailed = 1;
inline constexpr int kUserMistake = 2;

void add_contact(CLI::App& program);
void add_simulate(CLI::App& program, int& exit_code);
void add_surrogate(CLI::App& program);

}  // namespace condyle::apps
