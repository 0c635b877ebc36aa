// SPDX-License-Identifier: Apache-2.0
// condyle-sim simulate: a knee simulator's load case on meshes or on a surrogate; with --model a
// recorded trial of a body model instead (trial_command.hpp).
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "clinical_columns.hpp"
#include "condyle/fdk/knee_simulator.hpp"
#include "condyle/io/load_case_table.hpp"
#include "condyle/io/pose_table.hpp"
#include "condyle/io/table.hpp"
#include "condyle/surrogate/module_folder.hpp"
#include "implant_options.hpp"
#include "load_columns.hpp"
#include "simulated_contact.hpp"
#include "subcommands.hpp"
#include "trial_command.hpp"

namespace condyle::apps {
namespace {

struct SimulateOptions {
  ImplantOptions implant;
  TrialOptions trial;
  std::string load_case;
  std::string out;
  double insert_width = 0.0;  // 0: from the meshes, or the simulator's default
  bool hybrid = false;
  std::string reference_calls;  // file for the hybrid's log; none if empty
};

/// The load case delivered with the program.
std::filesystem::path default_load_case() {
  const std::filesystem::path file = surrogate::module_folder() / "iso_like_gait.csv";
  if (!std::filesystem::exists(file)) {
    throw std::invalid_argument("--load-case is missing, and there is no " + file.string() +
                                " to take instead");
  }
  return file;
}

/// The contact model of the options; sets the insert's width where meshes tell it.
SimulatedContact read_contact(const SimulateOptions& options,
                              fdk::KneeSimulatorSettings& settings) {
  if (!options.reference_calls.empty() && !options.hybrid) {
    throw std::invalid_argument("--reference-calls goes with --hybrid only");
  }
  SimulatedContact made = read_simulated_contact(options.implant, options.hybrid);
  if (made.meshes) settings.insert_width = made.meshes->insert_width();
  return made;
}

/// How often the reference was called, for people; empty unless `model` is a hybrid.
std::string reference_calls_text(const SimulatedContact& model,
                                 const fdk::KneeSimulation& simulation) {
  if (!model.hybrid) return {};
  long evaluations = 0;
  for (const fdk::KneeFrame& frame : simulation.frames) evaluations += frame.evaluations;
  // The springs' references may have been settled on the model before the first time frame.
  return "; the reference was called " + std::to_string(model.hybrid->reference_calls()) +
         " times (contact evaluations over the time frames: " + std::to_string(evaluations) + ")";
}

/// Where the reference was called, and the surrogate's trust there.
io::Table reference_calls_table(const surrogate::HybridContactModel& hybrid) {
  std::vector<Pose> poses;
  std::vector<double> trust;
  for (const auto& call : hybrid.log()) {
    poses.push_back(call.pose);
    trust.push_back(call.trust);
  }
  io::Table table;
  io::add_poses(table, poses);
  table.add_column("trust", std::move(trust));
  return table;
}

void add_clinical(io::Table& table, const std::vector<fdk::KneeFrame>& frames) {
  for (const auto& [column, member] : kClinicalColumns) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const auto& frame : frames) values.push_back(frame.clinical.*member);
    table.add_column(column, std::move(values));
  }
}

/// Largest residual of a time frame in units of its tolerance: 1 is the limit of "converged".
double scaled_residual(const fdk::KneeFrame& frame, const numerics::NewtonSettings& newton) {
  const double force = frame.residual.head<3>().cwiseAbs().maxCoeff() / newton.force_tolerance;
  const double moment = frame.residual.tail<2>().cwiseAbs().maxCoeff() / newton.moment_tolerance;
  return std::max(force, moment);
}

io::Table simulation_table(const fdk::LoadCase& load_case, const fdk::KneeSimulation& simulation,
                           const numerics::NewtonSettings& newton) {
  std::vector<Pose> poses;
  std::vector<contact::ContactLoads> loads;
  std::vector<double> residual;
  io::TextColumn status{"status", {}};
  for (const auto& frame : simulation.frames) {
    poses.push_back(frame.pose);
    loads.push_back(frame.loads);
    residual.push_back(scaled_residual(frame, newton));
    status.values.emplace_back(name(frame.status));
  }
  io::Table table;
  table.add_column("time_s", load_case.time);
  io::add_poses(table, poses);
  add_clinical(table, simulation.frames);
  for (const Side side : {kMedial, kLateral}) add_wrench(table, side, loads);
  table.add_column("residual", std::move(residual));
  add_trust(table, loads);
  table.text_columns.push_back(std::move(status));
  return table;
}

int run_load_case(const SimulateOptions& options) {
  const fdk::LoadCase load_case = io::read_load_case(
      options.load_case.empty() ? default_load_case() : std::filesystem::path(options.load_case));
  fdk::KneeSimulatorSettings settings;
  const SimulatedContact model = read_contact(options, settings);
  if (options.insert_width != 0.0) settings.insert_width = options.insert_width;

  const fdk::KneeSimulation simulation = fdk::simulate_knee(*model.contact, load_case, settings);
  io::write_whole(options.out,
                  io::to_csv(simulation_table(load_case, simulation, settings.newton)));
  if (!options.reference_calls.empty()) {
    io::write_whole(options.reference_calls, io::to_csv(reference_calls_table(*model.hybrid)));
  }
  const std::string said =
      options.out + ": " + fdk::summary(simulation) + reference_calls_text(model, simulation);
  if (!simulation.converged()) {
    std::cerr << "condyle-sim: " << said << '\n';
    return kNumericsFailed;
  }
  std::cout << said << '\n';
  return 0;
}

}  // namespace

void add_simulate(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = program.add_subcommand(
      "simulate", "Kinematics and loads of a knee over a load case, or of a body over a trial");
  add_implant_options(*command, options->implant, "exact");
  command->get_option("--evaluation")
      ->description("exact (triangles) or fast (smooth field); with --model fast, if not said");
  command->add_option("--load-case", options->load_case,
                      "CSV: time_s,flexion_deg,axial_force_N,ap_force_N,ie_torque_Nm "
                      "(default: iso_like_gait.csv beside the program)");
  command
      ->add_option("--out", options->out,
                   "CSV to write: kinematics, loads per side, status; of a trial the folder")
      ->required();
  command
      ->add_option("--insert-width", options->insert_width,
                   "Width of the insert along z [m] (default: the meshes'; 0.074 with a surrogate)")
      ->check(CLI::PositiveNumber);
  command
      ->add_flag("--hybrid", options->hybrid,
                 "The surrogate where it trusts itself, else the meshes, blended between; give both")
      ->group("Implant as surrogate");
  command
      ->add_option("--reference-calls", options->reference_calls,
                   "CSV to write: poses that --hybrid called the reference for (the first 1000), "
                   "and the surrogate's trust there")
      ->group("Implant as surrogate");
  add_trial_options(*command, options->trial);
  command->callback([options, command, &exit_code] {
    if (!is_trial(*command)) {
      exit_code = run_load_case(*options);
      return;
    }
    // Exact contact over a trial takes minutes: whoever wants it says so.
    if (command->get_option("--evaluation")->count() == 0) options->implant.evaluation = "fast";
    exit_code = run_trial(options->trial, options->implant, options->hybrid, options->out);
  });
}

}  // namespace condyle::apps
