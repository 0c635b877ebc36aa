// SPDX-License-Identifier: Apache-2.0
#include "trial_command.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>
#include <vector>

#include "condyle/fdk/musculoskeletal_frame.hpp"
#include "condyle/io/external_loads_file.hpp"
#include "condyle/io/model_file.hpp"
#include "condyle/io/trial_file.hpp"
#include "condyle/io/trial_snapshots.hpp"
#include "result_folder.hpp"
#include "subcommands.hpp"
#include "trial_contacts.hpp"
#include "trial_pressures.hpp"
#include "trial_run.hpp"
#include "trial_summary.hpp"
#include "trial_tables.hpp"
#include "trial_words.hpp"

namespace condyle::apps {
namespace {

/// Seconds since the last call, or since it was made.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

model::Model read_model(const std::string& file) {
  model::Model model(io::read_model_file(file));
  const auto& coordinates = model.description().coordinates;
  const bool any = std::any_of(coordinates.begin(), coordinates.end(), [](const auto& c) {
    return c.role == model::CoordinateRole::kForceDependent;
  });
  if (any) return model;
  throw std::invalid_argument(file + ": model '" + model.description().name +
                              "' has no force-dependent coordinate: nothing to solve for; give the "
                              "knee's secondary coordinates the role force_dependent");
}

/// Files by what they are; those of the contacts come after.
std::vector<std::pair<std::string, std::filesystem::path>> inputs_of(const TrialOptions& options) {
  std::vector<std::pair<std::string, std::filesystem::path>> inputs{{"model", options.model},
                                                                    {"motion", options.motion}};
  if (!options.loads.empty()) {
    inputs.emplace_back("external_loads", options.loads);
    inputs.emplace_back("external_loads_table",
                        io::read_external_loads_file(options.loads).data_file);
  }
  if (!options.paths.empty()) inputs.emplace_back("paths", options.paths);
  return inputs;
}

/// Wrapping surfaces that no path is held around and none is computed around.
std::vector<std::string> passed_by(const fdk::MusculoskeletalFrame& frame,
                                   const model::PathSnapshots& snapshots) {
  std::vector<std::string> texts;
  for (const std::string& text : frame.wraps_ignored()) {
    const bool held = std::any_of(
        snapshots.paths.begin(), snapshots.paths.end(),
        [&](const auto& path) { return text.find("'" + path.first + "':") != std::string::npos; });
    if (!held) texts.push_back(text);
  }
  return texts;
}

}  // namespace

int run_trial(const TrialOptions& options, const ImplantOptions& implant, bool hybrid,
              const std::string& out) {
  const fdk::TrialSimulationSettings settings = simulation_settings(options);
  require_folder(out);
  const model::Model model = read_model(options.model);
  io::Trial trial = io::read_trial(model, options.motion, options.loads, trial_reading(options));
  io::TrialSnapshots paths;
  if (!options.paths.empty()) {
    paths = io::read_trial_snapshots(options.paths, model, trial.times, trial.q.row(0).transpose());
  }
  Stopwatch watch;
  TrialSeconds spent;
  TrialContacts made = make_trial_contacts(model, options, implant, hybrid);
  std::vector<fdk::BodyContactDescription> contacts;
  for (const TrialContact& contact : made.contacts) contacts.push_back(contact.description);
  spent.contact_models = watch.lap();
  const fdk::TrialInput input{std::move(trial.q),
                              std::move(trial.qd),
                              std::move(trial.qdd),
                              std::move(trial.loads),
                              options.paths.empty() ? nullptr : &paths.snapshots,
                              std::move(paths.rows)};
  const fdk::MusculoskeletalFrame frame(model, settings.muscles);
  TrialRun run{.model = model,
               .times = std::move(trial.times),
               .at_default = std::move(trial.at_default),
               .inputs = inputs_of(options),
               .contacts = std::move(made.contacts),
               .settings = settings,
               .simulation = {},
               .pressures = {},
               .balanced = {},
               .wraps_passed_by = passed_by(frame, paths.snapshots)};
  for (const int c : frame.balanced()) {
    run.balanced.push_back(model.description().coordinates[static_cast<std::size_t>(c)].name);
  }
  run.inputs.insert(run.inputs.end(), made.files.begin(), made.files.end());
  watch.lap();
  run.simulation = fdk::simulate_trial(model, input, contacts, {}, settings);
  spent.solving = watch.lap();
  for (std::size_t c = 0; c < run.contacts.size(); ++c) {
    run.pressures.push_back(
        options.no_pressures ? std::nullopt
                             : contact_pressures(run.contacts[c], run.simulation.contact_poses,
                                                 static_cast<Eigen::Index>(c), settings.threads));
  }
  spent.pressures = watch.lap();
  write_result_folder(out, kTrialFormat, trial_tables(run), trial_summary(run));
  say_trial(run, out, !options.paths.empty(), spent);
  return run.simulation.converged() ? 0 : kNumericsFailed;
}

}  // namespace condyle::apps
