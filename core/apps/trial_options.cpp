// SPDX-License-Identifier: Apache-2.0
#include "trial_options.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>

namespace condyle::apps {
namespace {

constexpr const char* kTrial = "Body model and trial, instead of a load case (docs/simulation.md)";
constexpr const char* kSolver = "Solver of a trial";

constexpr std::array<std::string_view, 5> kMeshes{"--femur", "--insert", "--insert-medial",
                                                  "--insert-lateral", "--units"};
constexpr std::array<std::string_view, 3> kOfLoadCase{"--load-case", "--insert-width",
                                                      "--reference-calls"};
constexpr std::array kNeeded{"--motion", "--surfaces", "--femur-surface", "--insert-surface",
                             "--side-of-body"};

template <typename Names>
bool among(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void add_files(CLI::App& command, TrialOptions& options) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group(kTrial);
  };
  add("--model", options.model, "Model file (.json)");
  add("--motion", options.motion, "Coordinates over time (.sto, .mot)");
  add("--loads", options.loads, "OpenSim's external loads (.xml); the table is found beside it");
  add("--paths", options.paths, "Path snapshots of the motion (.json)");
  add("--surfaces", options.surfaces,
      "JSON file of contact_surfaces: meshes, and where F and T are on the bodies");
  add("--femur-surface", options.femur_surface, "Surface of the femoral component; its frame is F");
  add("--insert-surface", options.insert_surface, "Surface of the insert; its frame is T");
  add("--patella-surface", options.patella_surface,
      "Surface of the patellar button, which meets the femur's mesh (default: no such contact)");
  add("--from", options.reading.start, "First time [s]");
  add("--to", options.reading.end, "Last time [s]");
  add("--negligible-force", options.reading.negligible_force,
      "Loads up to this need no point of application [N]")
      ->check(CLI::NonNegativeNumber);
  command
      .add_flag("--any-range", options.any_range, "Take coordinates far beyond their range as such")
      ->group(kTrial);
}

void add_muscles(CLI::App& command, TrialOptions& options) {
  command
      .add_option("--criterion", options.criterion,
                  "P of min sum (f/N)^P, or min_max: the least largest activity")
      ->group(kTrial)
      ->capture_default_str();
  command
      .add_option("--strength", options.strength,
                  "hill: N by length and velocity of the fibres; constant: maximum isometric force")
      ->check(CLI::IsMember({"hill", "constant"}))
      ->group(kTrial)
      ->capture_default_str();
  command
      .add_option("--reserve", options.settings.muscles.reserve_moment,
                  "Reserve on every rotation that muscles balance [Nm]; 0: none")
      ->check(CLI::NonNegativeNumber)
      ->group(kTrial)
      ->capture_default_str();
  command
      .add_option("--plausible-depth-mm", options.plausible_depth_mm,
                  "Overlap beyond this is flagged")
      ->group(kTrial)
      ->capture_default_str();
  command
      .add_flag("--no-pressures", options.no_pressures,
                "Leave the meshes' pressures at the poses found out")
      ->group(kTrial);
}

void add_solver(CLI::App& command, TrialOptions& options) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group(kSolver)->capture_default_str();
  };
  numerics::NewtonSettings& newton = options.settings.solver.newton;
  add("--force-tolerance", newton.force_tolerance, "Largest net force left on a translation [N]");
  add("--moment-tolerance", newton.moment_tolerance, "Largest net moment left on a rotation [Nm]");
  add("--max-iterations", newton.max_iterations, "Newton steps of an attempt at most");
  add("--max-newton-step-mm", options.max_newton_step_mm,
      "Bound on a translation's step (default: 2)");
  add("--max-newton-step-deg", options.max_newton_step_deg,
      "Bound on a rotation's step (default: 2.9)");
  add("--local-search", newton.max_line_search,
      "Halvings of a step that does not improve, at most");
  add("--jacobian", options.jacobian, "analytic or finite_differences")
      ->check(CLI::IsMember({"analytic", "finite_differences"}));
  add("--perturbation", newton.perturbation, "Step of the finite differences [m, rad]");
  add("--max-substeps", options.settings.solver.max_substeps,
      "Parts that the way from the last time frame is cut into");
  add("--chunk", options.settings.chunk,
      "Time frames solved one after another, each chunk on a thread; 0: all");
  options.settings.threads = 0;
  add("--threads", options.settings.threads, "Threads; 0 for all cores. No result depends on it");
}

recruitment::Criterion criterion_from_text(const std::string& text) {
  if (text == "min_max") return {.min_max = true};
  char* end = nullptr;
  const double power = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') {
    throw std::invalid_argument("--criterion " + text +
                                ": must be a power, at least 1, or min_max");
  }
  return {.exponent = power};
}

}  // namespace

void add_trial_options(CLI::App& command, TrialOptions& options) {
  add_files(command, options);
  add_muscles(command, options);
  add_solver(command, options);
}

bool is_trial(const CLI::App& command) {
  const bool trial = command.get_option("--model")->count() > 0;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    const std::string name = option->get_name();
    const bool of_trial = option->get_group() == kTrial || option->get_group() == kSolver;
    if (of_trial && !trial) throw std::invalid_argument(name + " goes with --model M.json only");
    if (trial && among(kMeshes, name)) {
      throw std::invalid_argument(name +
                                  " does not go with --model: --surfaces names the meshes, in m");
    }
    if (trial && among(kOfLoadCase, name)) {
      throw std::invalid_argument(name + " does not go with --model: it is of a load case");
    }
  }
  if (!trial) return false;
  for (const char* name : kNeeded) {
    if (command.get_option(name)->count() == 0) {
      throw std::invalid_argument(std::string(name) + " is missing: --model needs it");
    }
  }
  return true;
}

io::TrialReading trial_reading(const TrialOptions& options) {
  io::TrialReading reading = options.reading;
  if (options.any_range) reading.range_factor = std::numeric_limits<double>::infinity();
  return reading;
}

fdk::TrialSimulationSettings simulation_settings(const TrialOptions& options) {
  fdk::TrialSimulationSettings settings = options.settings;
  numerics::NewtonSettings& newton = settings.solver.newton;
  if (options.max_newton_step_mm) newton.max_newton_step_m = 1e-3 * *options.max_newton_step_mm;
  if (options.max_newton_step_deg) {
    newton.max_newton_step_rad = *options.max_newton_step_deg * (std::numbers::pi / 180.0);
  }
  newton.jacobian = options.jacobian == "analytic" ? numerics::JacobianMethod::kAnalytic
                                                   : numerics::JacobianMethod::kFiniteDifferences;
  settings.muscles.strength =
      options.strength == "hill" ? model::StrengthModel::kHill : model::StrengthModel::kConstant;
  settings.muscles.recruitment.criterion = criterion_from_text(options.criterion);
  fdk::require_valid(settings);
  return settings;
}

}  // namespace condyle::apps
