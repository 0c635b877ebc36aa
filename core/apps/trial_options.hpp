// SPDX-License-Identifier: Apache-2.0
// What a user asks of a simulation of a recorded trial: model, motion, loads, surfaces, muscles and
// solver. The options have the names of the Python command's, `condyle simulate MODEL MOTION`.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "condyle/fdk/trial_simulation.hpp"
#include "condyle/io/trial_file.hpp"

namespace condyle::apps {

/// What the options were set to; texts as typed.
struct TrialOptions {
  std::string model, motion;
  std::string loads, paths;  ///< empty: none
  std::string surfaces;
  std::string femur_surface, insert_surface;
  std::string patella_surface;  ///< empty: no patellofemoral contact
  io::TrialReading reading;
  bool any_range = false;
  bool no_pressures = false;
  std::string criterion = "3";
  std::string strength = "hill";
  double plausible_depth_mm = 2.0;
  fdk::TrialSimulationSettings settings;
  std::optional<double> max_newton_step_mm, max_newton_step_deg;  ///< none: as in `settings`
  std::string jacobian = "analytic";
};

/// Adds the options of a trial, in groups of their own.
void add_trial_options(CLI::App& command, TrialOptions& options);

/// Whether the command line asks for a trial (--model) rather than a load case.
/// @throws std::invalid_argument naming an option that goes with the other of the two, or one that
/// a trial needs.
bool is_trial(const CLI::App& command);

/// The reading and the settings that all of the options amount to.
/// @throws std::invalid_argument naming the option or the setting, its value and the limit.
io::TrialReading trial_reading(const TrialOptions& options);
fdk::TrialSimulationSettings simulation_settings(const TrialOptions& options);

}  // namespace condyle::apps
