// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/trial_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "condyle/io/external_loads.hpp"
#include "condyle/io/motion_file.hpp"
#include "condyle/io/near_miss.hpp"
#include "condyle/io/short_number.hpp"
#include "condyle/model/kinematics.hpp"

namespace condyle::io {
namespace {

using model::CoordinateDescription;
using model::CoordinateRole;
using model::Model;

/// A narrow range says little: no value within this many half-widths of these is refused [rad, m].
constexpr double kLeastHalfWidthRad = 0.5;
constexpr double kLeastHalfWidthM = 0.05;

/// Column of the motion of each coordinate; nothing where it has none.
using Columns = std::vector<std::optional<std::size_t>>;

/// "/jointset/knee_r/knee_flex_r/value" is OpenSim's long form of "knee_flex_r".
std::string_view coordinate_of(std::string_view label) {
  constexpr std::string_view kEnd = "/value";
  if (!label.ends_with(kEnd)) return label;
  const std::string_view path = label.substr(0, label.size() - kEnd.size());
  const auto slash = path.rfind('/');
  return slash == std::string_view::npos ? label : path.substr(slash + 1);
}

/// Reads one motion for one model, naming both in what it throws.
class Reader {
 public:
  Reader(const Model& model, const std::filesystem::path& file, const TrialReading& reading)
      : model_(model),
        coordinates_(model.description().coordinates),
        reading_(reading),
        motion_(read_motion(file)) {
    for (const CoordinateDescription& c : coordinates_) names_.push_back(c.name);
    match_columns();
    convert_to_radians(motion_, [&](std::string_view label) {
      const auto c = index_of(coordinate_of(label));
      return c && coordinates_[*c].rotational;
    });
    choose_rows();
    require_plausible();
  }

  Trial read() const {
    const numerics::NaturalSpline spline = motion_spline(motion_);
    Trial trial;
    trial.times.assign(motion_.times.begin() + first_, motion_.times.begin() + end_);
    Trial::Rows* tables[] = {&trial.q, &trial.qd, &trial.qdd};
    for (int k = 0; k < 3; ++k) *tables[k] = derivative(spline, trial.times, k);
    for (std::size_t c = 0; c < names_.size(); ++c) {
      if (force_dependent(c) && !columns_[c]) trial.at_default.push_back(names_[c]);
    }
    return trial;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(motion_.source + ": " + what);
  }
  std::string model_name() const { return "model '" + model_.description().name + "'"; }
  bool force_dependent(std::size_t c) const {
    return coordinates_[c].role == CoordinateRole::kForceDependent;
  }

  std::optional<std::size_t> index_of(std::string_view coordinate) const {
    const auto found = std::find(names_.begin(), names_.end(), coordinate);
    if (found == names_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names_.begin());
  }

  void match_columns() {
    columns_.resize(names_.size());
    std::vector<std::string> unknown;
    for (std::size_t i = 0; i < motion_.names.size(); ++i) {
      const std::string coordinate(coordinate_of(motion_.names[i]));
      const auto c = index_of(coordinate);
      if (!c) {
        unknown.push_back(coordinate);
      } else if (columns_[*c]) {
        fail("columns '" + motion_.names[*columns_[*c]] + "' and '" + motion_.names[i] +
             "' are both of coordinate '" + coordinate + "'");
      } else {
        columns_[*c] = i;
      }
    }
    if (!unknown.empty()) refuse_unknown(unknown);
    require_complete();
  }

  [[noreturn]] void refuse_unknown(const std::vector<std::string>& unknown) const {
    const std::string near = near_miss(unknown.front(), names_);
    fail("column '" + unknown.front() + "' is no coordinate of " + model_name() +
         (near.empty() ? "" : "; did you mean '" + near + "'?") +
         (unknown.size() > 1 ? " (" + std::to_string(unknown.size()) + " such columns)" : ""));
  }

  void require_complete() const {
    std::vector<std::string> missing;
    for (std::size_t c = 0; c < names_.size(); ++c) {
      const bool needed = !coordinates_[c].locked && !model_.dependent(static_cast<int>(c));
      if (needed && !columns_[c] && !force_dependent(c)) missing.push_back(names_[c]);
    }
    if (missing.empty()) return;
    constexpr std::size_t kMost = 5;
    const std::size_t named = std::min(kMost, missing.size());
    const std::span<const std::string> first(missing.data(), named);
    const std::string more =
        missing.size() > kMost ? " and " + std::to_string(missing.size() - kMost) + " more" : "";
    fail("no column for " + listed(first) + more + "; " + model_name() +
         " neither locks nor couples them");
  }

  void choose_rows() {
    const auto& times = motion_.times;
    const auto first = std::lower_bound(times.begin(), times.end(), reading_.start - kSameTime);
    const auto end = std::upper_bound(times.begin(), times.end(), reading_.end + kSameTime);
    first_ = first - times.begin();
    end_ = end - times.begin();
    if (first_ < end_ && !std::isnan(reading_.start) && !std::isnan(reading_.end)) return;
    const TrialReading all;
    std::string asked;
    if (reading_.start != all.start) asked += " from " + short_number(reading_.start) + " s";
    if (reading_.end != all.end) asked += " to " + short_number(reading_.end) + " s";
    fail("no time frame" + asked + "; it has " + short_number(times.front()) + " to " +
         short_number(times.back()) + " s");
  }

  /// Degrees that are said to be radians, and millimetres, are far out of any joint's range.
  void require_plausible() const {
    for (std::size_t c = 0; c < names_.size(); ++c) {
      const double low = coordinates_[c].range_min, high = coordinates_[c].range_max;
      if (!columns_[c] || !(low < high)) continue;
      const double least = coordinates_[c].rotational ? kLeastHalfWidthRad : kLeastHalfWidthM;
      const double allowed = reading_.range_factor * std::max(0.5 * (high - low), least);
      const auto& values = motion_.columns[*columns_[c]];
      const auto away = [&](double value) { return std::abs(value - 0.5 * (low + high)); };
      const auto worst = std::max_element(values.begin() + first_, values.begin() + end_,
                                          [&](double a, double b) { return away(a) < away(b); });
      if (away(*worst) > allowed) refuse_value(c, worst - values.begin());
    }
  }

  [[noreturn]] void refuse_value(std::size_t c, std::ptrdiff_t row) const {
    const CoordinateDescription& coordinate = coordinates_[c];
    const std::string unit = coordinate.rotational ? "rad" : "m";
    const auto at = static_cast<std::size_t>(row);
    fail("column '" + coordinate.name + "' is " +
         short_number(motion_.columns[*columns_[c]][at], 4) + " " + unit + " at " +
         short_number(motion_.times[at]) + " s; its range in " + model_name() + " is " +
         short_number(coordinate.range_min, 4) + " to " + short_number(coordinate.range_max, 4) +
         " " + unit + ": are these " +
         (coordinate.rotational ? "degrees, with inDegrees=no in the header?" : "millimetres?"));
  }

  Trial::Rows derivative(const numerics::NaturalSpline& spline, const std::vector<double>& times,
                         int order) const {
    const auto rows = static_cast<Eigen::Index>(times.size());
    Trial::Rows out = Trial::Rows::Zero(rows, static_cast<Eigen::Index>(names_.size()));
    Eigen::VectorXd now(spline.columns());
    for (Eigen::Index row = 0; row < rows; ++row) {
      spline.evaluate(times[static_cast<std::size_t>(row)], order, now);
      for (std::size_t c = 0; c < names_.size(); ++c) {
        double& value = out(row, static_cast<Eigen::Index>(c));
        if (columns_[c]) {
          value = now[static_cast<Eigen::Index>(*columns_[c])];
        } else if (order == 0) {
          value = coordinates_[c].default_value;
        }
      }
    }
    return out;
  }

  const Model& model_;
  const std::vector<CoordinateDescription>& coordinates_;
  const TrialReading& reading_;
  Motion motion_;
  std::vector<std::string> names_;  ///< of the coordinates
  Columns columns_;
  std::ptrdiff_t first_ = 0, end_ = 0;  ///< rows taken
};

void add_loads(const Model& model, const ExternalLoads& loads, Trial& trial) {
  model::Kinematics kinematics(model);
  for (std::size_t i = 0; i < trial.times.size(); ++i) {
    kinematics.set(trial.q.row(static_cast<Eigen::Index>(i)).transpose());
    trial.loads.push_back(loads.in_ground(trial.times[i], kinematics));
  }
}

}  // namespace

Trial read_trial(const Model& model, const std::filesystem::path& motion,
                 const std::filesystem::path& external_loads, const TrialReading& reading) {
  Trial trial = Reader(model, motion, reading).read();
  if (!external_loads.empty()) {
    const auto loads = ExternalLoads::read(external_loads, {reading.negligible_force});
    loads.require_bodies(model.description());
    add_loads(model, loads, trial);
  }
  return trial;
}

}  // namespace condyle::io
