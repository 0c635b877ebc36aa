// SPDX-License-Identifier: Apache-2.0
#include "trial_summary.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "condyle/common/sha256.hpp"

namespace condyle::apps {
namespace {

using io::JsonObject;

/// JSON has no NaN.
std::string number(double value) { return std::isfinite(value) ? io::json_number(value) : "null"; }
std::string number(int value) { return std::to_string(value); }
std::string boolean(bool value) { return value ? "true" : "false"; }

std::string texts(const std::vector<std::string>& values) {
  std::vector<std::string> items;
  for (const std::string& value : values) items.push_back(io::json_string(value));
  return io::json_list(items);
}

std::string content_hash(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::invalid_argument(file.string() + ": cannot be opened for reading");
  return sha256(std::string{std::istreambuf_iterator<char>(stream), {}});
}

std::string inputs_text(const TrialRun& run) {
  JsonObject inputs;
  for (const auto& [what, file] : run.inputs) {
    JsonObject one;
    one.add_string("name", file.filename().string());
    one.add_string("sha256", content_hash(file));
    inputs.add(what, one.text());
  }
  return inputs.text();
}

std::string muscles_text(const fdk::MuscleSettings& muscles) {
  const recruitment::Criterion& criterion = muscles.recruitment.criterion;
  JsonObject object;
  object.add("criterion",
             criterion.min_max ? io::json_string("min_max") : number(criterion.exponent));
  object.add_string("strength",
                    muscles.strength == model::StrengthModel::kHill ? "hill" : "constant");
  object.add("upper_bounds", boolean(muscles.recruitment.upper_bounds));
  object.add_number("reserve_moment", muscles.reserve_moment);
  object.add_number("reserve_force", muscles.reserve_force);
  object.add_number("reserve_price", muscles.reserve_price);
  return object.text();
}

std::string newton_text(const numerics::NewtonSettings& newton) {
  JsonObject object;
  object.add_number("force_tolerance_N", newton.force_tolerance);
  object.add_number("moment_tolerance_Nm", newton.moment_tolerance);
  object.add("max_iterations", number(newton.max_iterations));
  object.add_number("max_newton_step_m", newton.max_newton_step_m);
  object.add_number("max_newton_step_rad", newton.max_newton_step_rad);
  object.add("max_line_search", number(newton.max_line_search));
  object.add_string("jacobian", newton.jacobian == numerics::JacobianMethod::kAnalytic
                                    ? "analytic"
                                    : "finite_differences");
  object.add_number("perturbation", newton.perturbation);
  return object.text();
}

/// The settings that results depend on: all but the number of threads.
std::string settings_text(const fdk::TrialSimulationSettings& settings) {
  JsonObject solver, object;
  solver.add("max_sharing_updates", number(settings.solver.max_sharing_updates));
  solver.add_number("sharing_tolerance", settings.solver.sharing_tolerance);
  solver.add("max_substeps", number(settings.solver.max_substeps));
  solver.add("softer_contact", io::json_numbers(settings.solver.softer_contact));
  solver.add("uncoupled", boolean(settings.solver.uncoupled));
  object.add("muscles", muscles_text(settings.muscles));
  object.add("newton", newton_text(settings.solver.newton));
  object.add("solver", solver.text());
  object.add("keep_rates", boolean(settings.keep_rates));
  object.add("extrapolation", number(settings.extrapolation));
  object.add("chunk", number(settings.chunk));
  object.add_number("least_trust", settings.least_trust);
  return object.text();
}

std::string placed_text(const std::string& surface, const std::string& body,
                        const RigidTransform& X) {
  std::vector<std::string> rows;
  for (int i = 0; i < 3; ++i) {
    rows.push_back(io::json_numbers(std::array{X.R(i, 0), X.R(i, 1), X.R(i, 2), X.p[i]}));
  }
  rows.push_back(io::json_numbers(std::array{0.0, 0.0, 0.0, 1.0}));
  JsonObject object;
  object.add_string("surface", surface);
  object.add_string("body", body);
  object.add("placement", io::json_list(rows));
  return object.text();
}

void add_meshes(const TrialContact& contact, JsonObject& object) {
  if (contact.mesh_hashes.empty()) return;
  JsonObject meshes, law, reference;
  for (const auto& [part, hash] : contact.mesh_hashes) meshes.add_string(part, hash);
  law.add_string("name", contact.law.name);
  for (const auto& [parameter, value] : contact.law.parameters) law.add_number(parameter, value);
  reference.add_string("evaluation", contact.evaluation);
  reference.add("law", law.text());
  reference.add_number("plausible_depth_m", contact.plausible_depth);
  object.add("meshes", meshes.text());
  object.add("reference", reference.text());
}

void add_surrogate(const TrialContact& contact, JsonObject& object) {
  if (!contact.made.surrogate) return;
  const auto& surrogate = *contact.made.surrogate;
  JsonObject found;
  found.add_string("name", surrogate.file().filename().string());
  found.add_string("sha256", content_hash(surrogate.file()));
  const auto architecture = surrogate.metadata().find("condyle.architecture");
  if (architecture != surrogate.metadata().end()) {
    found.add_string("architecture", architecture->second);
  }
  object.add("surrogate", found.text());
  if (contact.made.hybrid) {
    object.add("reference_calls", std::to_string(contact.made.hybrid->reference_calls()));
  }
}

std::string contacts_text(const TrialRun& run) {
  std::vector<std::string> items;
  for (const TrialContact& contact : run.contacts) {
    const fdk::BodyContactDescription& placed = contact.description;
    JsonObject object;
    object.add_string("name", placed.name);
    object.add_string("contact", contact.kind);
    object.add_string("side_of_body", name(placed.side_of_body));
    object.add("moving", placed_text(contact.moving, placed.moving_body, placed.X_BF));
    object.add("fixed", placed_text(contact.fixed, placed.fixed_body, placed.X_BT));
    add_meshes(contact, object);
    add_surrogate(contact, object);
    items.push_back(object.text());
  }
  return io::json_list(items);
}

std::string status_text(const TrialRun& run) {
  std::map<std::string, int> counts;
  for (const auto& record : run.simulation.records) ++counts[std::string(name(record.status))];
  JsonObject object;
  for (const auto& [status, count] : counts) object.add(status, number(count));
  return object.text();
}

std::string trouble_text(const TrialRun& run, std::size_t i, double scaled) {
  const fdk::ForceDependentRecord& record = run.simulation.records[i];
  const int c = run.model.coordinate(record.worst_name);
  const bool turns = run.model.description().coordinates[static_cast<std::size_t>(c)].rotational;
  JsonObject object;
  object.add_number("time", run.times[i]);
  object.add_string("status", name(record.status));
  object.add_string("worst_coordinate", record.worst_name);
  object.add(turns ? "residual_Nm" : "residual_N",
             number(record.residual[record.worst_coordinate]));
  object.add("scaled_residual", number(scaled));
  object.add_string("message", record.message);
  return object.text();
}

/// Times of the records of which something is true.
template <typename Chosen>
std::string times_text(const TrialRun& run, const Chosen& chosen) {
  std::vector<double> times;
  for (std::size_t i = 0; i < run.times.size(); ++i) {
    if (chosen(run.simulation.records[i])) times.push_back(run.times[i]);
  }
  return io::json_numbers(times);
}

std::string peak_text(const std::optional<Peak>& peak) {
  if (!peak) return "null";
  JsonObject object;
  object.add_string("name", peak->name);
  object.add_number("value", peak->value);
  object.add_number("time", peak->time);
  return object.text();
}

std::string peak_forces_text(const TrialRun& run) {
  JsonObject all;
  for (std::size_t c = 0; c < run.contacts.size(); ++c) {
    JsonObject object;
    object.add_string("load", peak_load(run.contacts[c]));
    for (const Peak& peak : contact_peaks(run, c)) {
      JsonObject one;
      one.add_number("value_N", peak.value);
      one.add_number("time", peak.time);
      object.add(peak.name, one.text());
    }
    all.add(run.contacts[c].description.name, object.text());
  }
  return all.text();
}

/// Peaks by part over the time frames in equilibrium, and overlap that did not count.
std::string pressures_text(const TrialRun& run, const ContactPressures& pressures) {
  JsonObject object;
  for (std::size_t p = 0; p < pressures.parts.size(); ++p) {
    std::optional<double> peak;
    double time = 0.0, depth = 0.0, border = 0.0;
    for (std::size_t i = 0; i < run.times.size(); ++i) {
      if (!run.simulation.records[i].converged()) continue;
      const PartPressure& part = pressures.frames[i][p];
      if (!peak || part.peak > *peak) peak = part.peak, time = run.times[i];
      depth = std::max(depth, part.max_depth);
      border = std::max(border, part.border_area);
    }
    if (!peak) continue;
    JsonObject one;
    one.add_number("peak_pressure_Pa", *peak);
    one.add_number("time", time);
    one.add_number("max_depth_m", depth);
    one.add_number("border_area_m2", border);
    object.add(pressures.parts[p], one.text());
  }
  return object.text();
}

std::string all_pressures_text(const TrialRun& run) {
  JsonObject all;
  for (std::size_t c = 0; c < run.contacts.size(); ++c) {
    if (!run.pressures[c]) continue;
    all.add(run.contacts[c].description.name, pressures_text(run, *run.pressures[c]));
  }
  return all.text();
}

void add_course(const TrialRun& run, JsonObject& summary) {
  const auto& records = run.simulation.records;
  const std::vector<double> scaled = scaled_residuals(run);
  std::vector<std::string> troubles;
  int iterations = 0, evaluations = 0;
  double least_trust = 1.0, largest_residual = 0.0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!records[i].converged()) troubles.push_back(trouble_text(run, i, scaled[i]));
    iterations += records[i].iterations;
    evaluations += records[i].evaluations;
    least_trust = std::min(least_trust, records[i].least_trust);
    if (!(scaled[i] <= largest_residual)) largest_residual = scaled[i];
  }
  using Record = fdk::ForceDependentRecord;
  summary.add("status", status_text(run));
  summary.add_string("summary", fdk::summary(run.simulation));
  summary.add("not_in_equilibrium", io::json_list(troubles));
  summary.add("implausible_depth_at", times_text(run, [](const Record& record) {
                return record.status == fdk::ForceDependentStatus::kImplausibleDepth;
              }));
  summary.add("untrusted_at", times_text(run, [&](const Record& record) {
                return record.least_trust < run.settings.least_trust;
              }));
  summary.add("sharing_not_settled_at",
              times_text(run, [](const Record& record) { return !record.sharing_settled; }));
  summary.add("least_trust", number(least_trust));
  summary.add("iterations", number(iterations));
  summary.add("evaluations", number(evaluations));
  summary.add("largest_scaled_residual", number(largest_residual));
}

}  // namespace

JsonObject trial_summary(const TrialRun& run) {
  const model::ModelDescription& model = run.model.description();
  std::vector<std::string> force_dependent;
  for (const int c : run.simulation.force_dependent) {
    force_dependent.push_back(model.coordinates[static_cast<std::size_t>(c)].name);
  }
  JsonObject summary;
  summary.add_string("format", kTrialFormat);
  summary.add("version", "1");
  summary.add_string("condyle", CONDYLE_VERSION);
  summary.add_string("model", model.name);
  summary.add("inputs", inputs_text(run));
  summary.add("settings", settings_text(run.settings));
  summary.add("contacts", contacts_text(run));
  summary.add("force_dependent", texts(force_dependent));
  summary.add("balanced_by_muscles", texts(run.balanced));
  summary.add("at_default", texts(run.at_default));
  summary.add("time_frames", std::to_string(run.times.size()));
  summary.add_number("first_time", run.times.front());
  summary.add_number("last_time", run.times.back());
  add_course(run, summary);
  const auto muscles = names_of(model.muscles);
  summary.add("largest_activity", peak_text(largest(run, run.simulation.activities, muscles)));
  summary.add("largest_reserve", peak_text(largest(run, run.simulation.reserves, run.balanced)));
  summary.add("peak_forces", peak_forces_text(run));
  summary.add("pressures", all_pressures_text(run));
  summary.add("wraps_passed_by", texts(run.wraps_passed_by));
  summary.add("not_supported", texts(model.not_supported));
  return summary;
}

}  // namespace condyle::apps
