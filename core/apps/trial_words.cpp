// SPDX-License-Identifier: Apache-2.0
#include "trial_words.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <set>
#include <vector>

#include "condyle/io/near_miss.hpp"
#include "condyle/io/short_number.hpp"

namespace condyle::apps {
namespace {

using io::short_number;

void say_peaks(const TrialRun& run) {
  for (std::size_t c = 0; c < run.contacts.size(); ++c) {
    std::string shown;
    for (const Peak& peak : contact_peaks(run, c)) {
      shown += (shown.empty() ? "" : ", ") + peak.name + " " +
               short_number(std::round(10 * peak.value) / 10) + " N at " + short_number(peak.time) +
               " s";
    }
    if (shown.empty()) continue;
    std::cout << run.contacts[c].description.name << ' ' << peak_load(run.contacts[c]) << ": peak "
              << shown << '\n';
  }
  const auto muscles = names_of(run.model.description().muscles);
  if (const auto peak = largest(run, run.simulation.activities, muscles)) {
    std::cout << "largest activity " << short_number(peak->value, 3) << ", " << peak->name << " at "
              << short_number(peak->time) << " s\n";
  }
  const double reserve = run.settings.muscles.reserve_moment;
  if (const auto peak = largest(run, run.simulation.reserves, run.balanced); peak && reserve > 0) {
    std::cout << "largest reserve " << short_number(peak->value, 3) << " Nm on " << peak->name
              << " at " << short_number(peak->time) << " s (of " << short_number(reserve)
              << " Nm)\n";
  }
}

void say_quality(const TrialRun& run) {
  const std::vector<double> scaled = scaled_residuals(run);
  const auto& records = run.simulation.records;
  double residual = 0.0;
  int steps = 0, evaluations = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].converged()) residual = std::max(residual, scaled[i]);
    steps += records[i].iterations;
    evaluations += records[i].evaluations;
  }
  const numerics::NewtonSettings& newton = run.settings.solver.newton;
  std::cout << "largest residual in equilibrium " << short_number(residual, 2)
            << " of its tolerance (" << short_number(newton.force_tolerance) << " N, "
            << short_number(newton.moment_tolerance) << " Nm); " << steps << " Newton steps, "
            << evaluations << " evaluations\n";
  for (const TrialContact& contact : run.contacts) {
    if (!contact.made.hybrid) continue;
    std::cout << contact.description.name << ": " << contact.made.hybrid->reference_calls()
              << " evaluations were the reference's\n";
  }
}

void say_time(const TrialRun& run, const TrialSeconds& spent) {
  fdk::PhaseSeconds phases{};
  for (const auto& record : run.simulation.records) {
    for (std::size_t p = 0; p < phases.size(); ++p) phases[p] += record.seconds[p];
  }
  const double total = std::accumulate(phases.begin(), phases.end(), 0.0);
  std::vector<std::size_t> order(phases.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return phases[a] > phases[b]; });
  std::string shares;
  for (const std::size_t p : order) {
    const double share = total > 0.0 ? std::round(100.0 * phases[p] / total) : 0.0;
    shares += (shares.empty() ? "" : ", ") + std::string(name(static_cast<fdk::Phase>(p))) + " " +
              short_number(share) + " %";
  }
  std::replace(shares.begin(), shares.end(), '_', ' ');
  const auto frames = static_cast<double>(run.times.size());
  std::cout << "solved in " << short_number(spent.solving, 3) << " s, "
            << short_number(1e3 * spent.solving / frames, 3) << " ms a time frame";
  if (run.times.size() > 1) {
    std::cout << ", " << short_number((run.times.back() - run.times.front()) / spent.solving, 2)
              << " times real time";
  }
  std::cout << " (" << shares << "); contact models " << short_number(spent.contact_models, 2)
            << " s, pressures " << short_number(spent.pressures, 2) << " s\n";
}

void say_passed_by(const TrialRun& run, bool paths_given) {
  std::set<std::string> owners;
  for (const std::string& text : run.wraps_passed_by) {
    const auto first = text.find('\'') + 1;
    owners.insert(text.substr(first, text.find('\'', first) - first));
  }
  if (owners.empty()) return;
  std::cout << owners.size() << " paths go straight past wrapping surfaces that are not computed"
            << (paths_given ? " and not in --paths: " : " (--paths): ")
            << io::listed(std::vector<std::string>(owners.begin(), owners.end()), 5) << '\n';
}

/// The first line: where, how many time frames, what with.
void say_run(const TrialRun& run, const std::string& out) {
  std::string models;
  for (const TrialContact& contact : run.contacts) {
    models += (models.empty() ? "" : ", ") + contact.description.name + " " + contact.kind;
  }
  std::cout << out << ": " << run.times.size() << " time frames from "
            << short_number(run.times.front()) << " to " << short_number(run.times.back()) << " s; "
            << run.simulation.force_dependent.size()
            << " force-dependent coordinates; contact: " << models << '\n';
}

}  // namespace

void say_trial(const TrialRun& run, const std::string& out, bool paths_given,
               const TrialSeconds& spent) {
  say_run(run, out);
  const std::string said = fdk::summary(run.simulation);
  if (run.simulation.converged()) std::cout << said << '\n';
  say_peaks(run);
  say_quality(run);
  say_time(run, spent);
  say_passed_by(run, paths_given);
  if (!run.simulation.converged()) std::cerr << "condyle-sim: " << out << ": " << said << '\n';
}

}  // namespace condyle::apps
