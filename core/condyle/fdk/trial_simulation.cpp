// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/trial_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "condyle/common/parallel.hpp"

namespace condyle::fdk {
namespace {

using numerics::Unknowns;

struct Run {
  const model::Model& model;
  const TrialInput& input;
  std::span<const BodyContactDescription> contacts;
  const TimeFrames& starts;
  const TrialSimulationSettings& settings;
};

void require_fitting(const model::Model& model, const TrialInput& input) {
  const Eigen::Index frames = input.q.rows(), n = model.n_coordinates();
  const auto require = [&](const char* what, const TimeFrames& table) {
    if (table.rows() != frames || table.cols() != n) {
      throw std::invalid_argument(
          std::string("trial: ") + what + " has shape (" + std::to_string(table.rows()) + ", " +
          std::to_string(table.cols()) + "); it must be (" + std::to_string(frames) + ", " +
          std::to_string(n) + ") (time frames, coordinates)");
    }
  };
  if (frames < 1) throw std::invalid_argument("trial: no time frames");
  require("q", input.q);
  require("qd", input.qd);
  require("qdd", input.qdd);
  const auto rows = static_cast<std::size_t>(frames);
  if (!input.loads.empty() && input.loads.size() != rows) {
    throw std::invalid_argument("trial: external loads of " + std::to_string(input.loads.size()) +
                                " time frames; q has " + std::to_string(rows));
  }
  if (input.snapshots != nullptr && input.snapshot_rows.size() != rows) {
    throw std::invalid_argument("trial: snapshot_rows has " +
                                std::to_string(input.snapshot_rows.size()) + " entries; q has " +
                                std::to_string(rows) + " rows");
  }
}

void require_starts(const TimeFrames& starts, Eigen::Index frames, int unknowns) {
  if (starts.size() == 0) return;
  if ((starts.rows() != 1 && starts.rows() != frames) || starts.cols() != unknowns) {
    throw std::invalid_argument("trial: starts has shape (" + std::to_string(starts.rows()) + ", " +
                                std::to_string(starts.cols()) + "); it must be (1, " +
                                std::to_string(unknowns) + ") or (" + std::to_string(frames) +
                                ", " + std::to_string(unknowns) +
                                ") (time frames, force-dependent coordinates)");
  }
  if (!starts.allFinite())
    throw std::invalid_argument("trial: starts has a value that is not finite");
}

FrameInstant instant_of(const Run& run, std::span<const int> columns, Eigen::Index row) {
  const auto i = static_cast<std::size_t>(row);
  FrameInstant instant{run.input.q.row(row).transpose(),
                       run.input.qd.row(row).transpose(),
                       run.input.qdd.row(row).transpose(),
                       {},
                       run.input.snapshots,
                       run.input.snapshots == nullptr ? 0 : run.input.snapshot_rows[i]};
  if (!run.input.loads.empty()) instant.loads = run.input.loads[i];
  for (const int c : columns) {
    // What is solved for need not be known; a gap there is not the caller's mistake.
    if (!std::isfinite(instant.q[c])) {
      instant.q[c] = run.model.description().coordinates[static_cast<std::size_t>(c)].default_value;
    }
    if (!run.settings.keep_rates) instant.qd[c] = instant.qdd[c] = 0.0;
  }
  return instant;
}

// The last α in equilibrium, the newest first, of time frames that follow each other.
class Past {
 public:
  explicit Past(int degree) : most_(static_cast<std::size_t>(degree) + 1) {}

  void add(const Unknowns& alpha) {
    alphas_.insert(alphas_.begin(), alpha);
    if (alphas_.size() > most_) alphas_.pop_back();
  }
  // Of a polynomial through all of them, where there is more than one.
  void add_starts(std::vector<Unknowns>& starts) const {
    if (alphas_.size() == 2) starts.emplace_back(2.0 * alphas_[0] - alphas_[1]);
    if (alphas_.size() == 3) starts.emplace_back(3.0 * (alphas_[0] - alphas_[1]) + alphas_[2]);
    if (!alphas_.empty()) starts.push_back(alphas_[0]);
  }
  // After a time frame that did not converge the series is broken: its last remains.
  void interrupt() {
    if (alphas_.size() > 1) alphas_.resize(1);
  }
  bool empty() const { return alphas_.empty(); }

 private:
  std::size_t most_;
  std::vector<Unknowns> alphas_;
};

void add_own_starts(const Run& run, MuscleEquilibrium& problem, const FrameInstant& instant,
                    Eigen::Index row, bool first, std::vector<Unknowns>& starts) {
  if (run.starts.rows() > 1 || (run.starts.rows() == 1 && first)) {
    starts.emplace_back(run.starts.row(run.starts.rows() > 1 ? row : 0).transpose());
  } else if (first) {
    const Unknowns given = problem.unknowns(instant.q);
    if (!problem.contacts().empty()) {
      starts.push_back(seated_start(problem, instant, given, 0, run.settings.seating));
    }
    starts.push_back(given);
  }
}

// One run of time frames [first, end), on one thread.
class Chunk {
 public:
  Chunk(const Run& run, Eigen::Index first, Eigen::Index end, TrialSimulation& out)
      : run_(run),
        first_(first),
        end_(end),
        out_(out),
        problem_(run.model, run.settings.muscles, run.contacts) {}

  void simulate() {
    const Eigen::Index entry = enter();
    if (entry < 0) return;
    Way forward = way_from(entry, run_.settings.extrapolation);
    Way backward = forward;
    walk(entry + 1, end_, 1, forward);
    walk(entry - 1, first_ - 1, -1, backward);
    retry();
  }

 private:
  // What a time frame starts from: those solved before it, in the direction of the walk.
  struct Way {
    explicit Way(int degree) : past(degree) {}
    Past past;
    Anchor last;
  };

  ForceDependentRecord& record(Eigen::Index row) {
    return out_.records[static_cast<std::size_t>(row)];
  }
  FrameInstant instant(Eigen::Index row) const {
    return instant_of(run_, problem_.force_dependent(), row);
  }

  // A time frame in equilibrium found from nothing, or −1. A start from nothing may be out of reach at
  // one time frame and easy at another: a few are tried, the first, the middle one, quarters, eighths,
  // by Newton alone and then in every way; last of all the others by Newton.
  Eigen::Index enter() {
    std::vector<Eigen::Index> probes;
    for (const int eighth : {0, 4, 2, 6, 1, 3, 5, 7}) {
      const Eigen::Index row = first_ + (end_ - first_) * eighth / 8;
      if (std::find(probes.begin(), probes.end(), row) == probes.end()) probes.push_back(row);
    }
    ForceDependentSettings cheap = run_.settings.solver;
    cheap.softer_contact.clear();
    cheap.uncoupled = false;
    for (const ForceDependentSettings* settings : {&std::as_const(cheap), &run_.settings.solver}) {
      for (const Eigen::Index row : probes) {
        if (from_nothing(row, *settings)) return row;
      }
    }
    for (Eigen::Index row = first_; row < end_; ++row) {
      const bool tried = std::find(probes.begin(), probes.end(), row) != probes.end();
      if (!tried && from_nothing(row, cheap)) return row;
    }
    return -1;
  }

  bool from_nothing(Eigen::Index row, const ForceDependentSettings& settings) {
    Way way(0);
    return solve(row, way, settings);
  }

  Way way_from(Eigen::Index row, int degree) {
    Way way(degree);
    way.past.add(record(row).alpha);
    way.last = {instant(row), record(row).alpha, {}};
    return way;
  }

  void walk(Eigen::Index from, Eigen::Index to, Eigen::Index step, Way& way) {
    for (Eigen::Index row = from; row != to; row += step) solve(row, way, run_.settings.solver);
  }

  bool solve(Eigen::Index row, Way& way, const ForceDependentSettings& settings) {
    try {
      FrameInstant now = instant(row);
      std::vector<Unknowns> starts;
      way.past.add_starts(starts);
      add_own_starts(run_, problem_, now, row, way.past.empty(), starts);
      ForceDependentRecord found = solve_force_dependent(
          problem_, now, starts, way.past.empty() ? nullptr : &way.last, settings);
      add_cost(record(row), found);
      record(row) = std::move(found);
      keep_time_frame(problem_, row, out_);
      if (!record(row).converged()) {
        way.past.interrupt();
        return false;
      }
      way.past.add(record(row).alpha);
      way.last = {std::move(now), record(row).alpha, problem_.frame().used_coupling()};
      return true;
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("time frame " + std::to_string(row) + ": " + error.what());
    }
  }

  // What is still not in equilibrium, from the other side.
  void retry() {
    for (Eigen::Index row = end_ - 2; row >= first_; --row) try_from(row, row + 1);
    for (Eigen::Index row = first_ + 1; row < end_; ++row) try_from(row, row - 1);
  }

  void try_from(Eigen::Index row, Eigen::Index neighbour) {
    if (record(row).converged() || !record(neighbour).converged()) return;
    const Way way = way_from(neighbour, 0);
    const FrameInstant now = instant(row);
    ForceDependentRecord found = solve_force_dependent(problem_, now, {&way.last.alpha, 1},
                                                       &way.last, run_.settings.solver);
    if (!found.converged()) {
      add_cost(found, record(row));
      return;
    }
    add_cost(record(row), found);
    found.approach = Approach::kFromOtherSide;
    record(row) = std::move(found);
    keep_time_frame(problem_, row, out_);
  }

  static void add_cost(const ForceDependentRecord& from, ForceDependentRecord& to) {
    to.iterations += from.iterations;
    to.evaluations += from.evaluations;
    to.regularised_steps += from.regularised_steps;
    for (std::size_t p = 0; p < to.seconds.size(); ++p) to.seconds[p] += from.seconds[p];
  }

  const Run& run_;
  Eigen::Index first_, end_;
  TrialSimulation& out_;
  MuscleEquilibrium problem_;
};

}  // namespace

void require_valid(const TrialSimulationSettings& settings) {
  require_valid(settings.solver);
  const auto refuse = [](const char* setting, double value, const char* limit) {
    std::ostringstream text;
    text << "trial simulation settings: " << setting << " is " << value << ": must be " << limit;
    throw std::invalid_argument(text.str());
  };
  if (settings.extrapolation < 0 || settings.extrapolation > 2) {
    refuse("extrapolation", settings.extrapolation, "0, 1 or 2");
  }
  if (settings.chunk < 0) refuse("chunk", settings.chunk, "at least 0 time frames");
  if (settings.threads < 0) refuse("threads", settings.threads, "at least 0");
  if (!(settings.least_trust >= 0.0 && settings.least_trust <= 1.0)) {
    refuse("least_trust", settings.least_trust, "within 0 and 1");
  }
}

TrialSimulation simulate_trial(const model::Model& model, const TrialInput& input,
                               std::span<const BodyContactDescription> contacts,
                               const TimeFrames& starts, const TrialSimulationSettings& settings) {
  require_fitting(model, input);
  require_valid(settings);
  const Run run{model, input, contacts, starts, settings};
  const MuscleEquilibrium problem(model, settings.muscles, contacts);
  require_starts(starts, input.q.rows(), problem.size());
  TrialSimulation out = empty_results(model, problem, input.q.rows());
  const Eigen::Index frames = input.q.rows();
  const Eigen::Index chunk =
      settings.chunk == 0 ? frames : std::min<Eigen::Index>(settings.chunk, frames);
  parallel_for(static_cast<std::size_t>((frames + chunk - 1) / chunk), settings.threads,
               [&](std::size_t i) {
                 const Eigen::Index first = static_cast<Eigen::Index>(i) * chunk;
                 Chunk(run, first, std::min(frames, first + chunk), out).simulate();
               });
  for (const ForceDependentRecord& record : out.records) {
    out.not_converged += record.converged() ? 0 : 1;
    out.implausible += record.status == ForceDependentStatus::kImplausibleDepth ? 1 : 0;
    out.untrusted += record.least_trust < settings.least_trust ? 1 : 0;
  }
  return out;
}

}  // namespace condyle::fdk
