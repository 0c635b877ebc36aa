// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/external_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "condyle/io/json_text.hpp"
#include "condyle/io/near_miss.hpp"

namespace condyle::io {
namespace {

using Samples = numerics::NaturalSpline::Samples;
using Columns = std::optional<std::array<std::size_t, 3>>;

/// A step longer than this many usual ones is a gap.
constexpr double kGapRatio = 1.5;

double usual_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// The three columns that an identifier stands for: those that end in x, y, z, else the only three that begin with it.
Columns columns_of(const std::string& identifier, const std::string& who, const Motion& data) {
  if (identifier.empty()) return std::nullopt;
  const auto x = data.find(identifier + "x"), y = data.find(identifier + "y"),
             z = data.find(identifier + "z");
  if (x && y && z) return std::array{*x, *y, *z};
  std::vector<std::size_t> begun;
  std::vector<std::string> stems;
  for (std::size_t c = 0; c < data.names.size(); ++c) {
    const std::string& name = data.names[c];
    if (name.starts_with(identifier)) begun.push_back(c);
    stems.push_back(name.substr(0, name.size() - 1));
  }
  if (begun.size() == 3) return std::array{begun[0], begun[1], begun[2]};
  throw std::invalid_argument(data.source + ": " + who + ": " + std::to_string(begun.size()) +
                              " columns begin with '" + identifier + "': must be three" +
                              did_you_mean(identifier, stems) + " (columns: " +
                              listed(data.names) + ")");
}

/// Prepares the samples of one force.
class ForceSamples {
 public:
  ForceSamples(const ExternalForceSpec& spec, const Motion& data,
               const ExternalLoadsSettings& settings, const std::string& source)
      : spec_(spec), data_(data), settings_(settings) {
    const std::string who = "force '" + spec.name + "' of " + source;
    force_ = columns_of(spec.force_identifier, who, data);
    point_ = columns_of(spec.point_identifier, who, data);
    torque_ = columns_of(spec.torque_identifier, who, data);
  }

  /// Fills columns `first` to `first + 8`.
  void fill(Samples& samples, Eigen::Index first, double step) {
    const std::size_t n = data_.times.size();
    std::vector<bool> no_point(n, false);
    if (force_) require_numbers(*force_, 0, n);
    for (std::size_t row = 0; row < n; ++row) {
      const auto r = static_cast<Eigen::Index>(row);
      const Vector3 force = vector(force_, row);
      const Vector3 point = vector(point_, row), torque = vector(torque_, row);
      const bool complete = point.allFinite() && torque.allFinite();
      // Whoever applies a moment alone must say it everywhere.
      const bool nothing = force_ && force.norm() <= settings_.negligible_force;
      if (!complete && !nothing) refuse_gap(row);
      no_point[row] = !point.allFinite();
      samples.row(r).segment<3>(first) = complete ? force : Vector3(Vector3::Zero());
      samples.row(r).segment<3>(first + 3) = point;
      samples.row(r).segment<3>(first + 6) = torque.allFinite() ? torque : Vector3(Vector3::Zero());
    }
    fill_points(samples, first + 3, no_point);
    require_steps(samples, first, step);
  }

 private:
  Vector3 vector(const Columns& columns, std::size_t row) const {
    if (!columns) return Vector3::Zero();
    return {data_.columns[(*columns)[0]][row], data_.columns[(*columns)[1]][row],
            data_.columns[(*columns)[2]][row]};
  }

  /// The span of NaN that a row is in, in a column.
  std::string span(std::size_t column, std::size_t row) const {
    const auto& values = data_.columns[column];
    std::size_t first = row, last = row;
    while (first > 0 && std::isnan(values[first - 1])) --first;
    while (last + 1 < values.size() && std::isnan(values[last + 1])) ++last;
    return "column '" + data_.names[column] + "' is NaN from " + json_number(data_.times[first]) +
           " to " + json_number(data_.times[last]) + " s";
  }

  void require_numbers(const std::array<std::size_t, 3>& columns, std::size_t from, std::size_t to) const {
    for (const std::size_t column : columns) {
      for (std::size_t row = from; row < to; ++row) {
        if (std::isfinite(data_.columns[column][row])) continue;
        throw std::invalid_argument(data_.source + ": " + span(column, row) + ": the force '" +
                                    spec_.name + "' has a gap there: fill it, or leave these times out");
      }
    }
  }

  [[noreturn]] void refuse_gap(std::size_t row) const {
    std::string where;
    for (const Columns* columns : {&point_, &torque_}) {
      if (!*columns) continue;
      for (const std::size_t column : **columns) {
        if (where.empty() && std::isnan(data_.columns[column][row])) where = span(column, row);
      }
    }
    std::string why = "there is no force to be zero";
    if (force_) {
      why = "the force '" + spec_.name + "' is " + json_number(vector(force_, row).norm()) +
            " N at " + json_number(data_.times[row]) + " s (up to " +
            json_number(settings_.negligible_force) + " N it may be: negligible_force)";
    }
    throw std::invalid_argument(data_.source + ": " + where + ", while " + why);
  }

  /// Points where there is none: straight between the neighbours, constant beyond the first and last.
  void fill_points(Samples& samples, Eigen::Index column, const std::vector<bool>& missing) const {
    const auto n = static_cast<Eigen::Index>(missing.size());
    Eigen::Index before = -1;
    for (Eigen::Index row = 0; row < n; ++row) {
      if (!missing[static_cast<std::size_t>(row)]) {
        before = row;
        continue;
      }
      Eigen::Index after = row;
      while (after < n && missing[static_cast<std::size_t>(after)]) ++after;
      for (; row < after; ++row) {
        Vector3 point = Vector3::Zero();
        const auto at = [&](Eigen::Index i) -> Vector3 { return samples.row(i).segment<3>(column); };
        if (before >= 0 && after < n) {
          const double t0 = data_.times[static_cast<std::size_t>(before)];
          const double t1 = data_.times[static_cast<std::size_t>(after)];
          const double s = (data_.times[static_cast<std::size_t>(row)] - t0) / (t1 - t0);
          point = (1.0 - s) * at(before) + s * at(after);
        } else if (before >= 0 || after < n) {
          point = at(before >= 0 ? before : after);
        }
        samples.row(row).segment<3>(column) = point;
      }
      before = after < n ? after : before;
    }
  }

  /// No long step in time next to a load.
  void require_steps(const Samples& samples, Eigen::Index first, double step) const {
    for (std::size_t row = 1; row < data_.times.size(); ++row) {
      const double length = data_.times[row] - data_.times[row - 1];
      if (length <= kGapRatio * step) continue;
      const auto r = static_cast<Eigen::Index>(row);
      const auto loaded = [&](Eigen::Index i) {
        return samples.row(i).segment<3>(first).norm() > settings_.negligible_force ||
               !samples.row(i).segment<3>(first + 6).isZero(0.0);
      };
      if (!loaded(r - 1) && !loaded(r)) continue;
      throw std::invalid_argument(
          data_.source + ": no rows from " + json_number(data_.times[row - 1]) + " to " +
          json_number(data_.times[row]) + " s, where rows are " + json_number(step) +
          " s apart, while '" + spec_.name + "' acts: fill the gap, or leave these times out");
    }
  }

  const ExternalForceSpec& spec_;
  const Motion& data_;
  const ExternalLoadsSettings& settings_;
  Columns force_, point_, torque_;
};

numerics::NaturalSpline spline_of(const ExternalLoadsSpec& spec, const Motion& data,
                                  const ExternalLoadsSettings& settings) {
  if (!(settings.negligible_force >= 0.0)) {
    throw std::invalid_argument("external loads: negligible_force is " +
                                std::to_string(settings.negligible_force) + " N: must be at least 0");
  }
  Samples samples = Samples::Zero(static_cast<Eigen::Index>(data.times.size()),
                                  static_cast<Eigen::Index>(9 * spec.forces.size()));
  const double step = usual_step(data.times);
  for (std::size_t i = 0; i < spec.forces.size(); ++i) {
    ForceSamples(spec.forces[i], data, settings, spec.source)
        .fill(samples, static_cast<Eigen::Index>(9 * i), step);
  }
  try {
    return {numerics::SplineDegree::kCubic, data.times, samples};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(data.source + ": " + error.what());
  }
}

}  // namespace

ExternalLoads::ExternalLoads(ExternalLoadsSpec spec, const Motion& data,
                             const ExternalLoadsSettings& settings)
    : spec_(std::move(spec)),
      table_(data.source),
      step_(usual_step(data.times)),
      spline_(spline_of(spec_, data, settings)) {}

ExternalLoads ExternalLoads::read(const std::filesystem::path& file,
                                  const ExternalLoadsSettings& settings) {
  ExternalLoadsSpec spec = read_external_loads_file(file);
  const Motion data = read_motion(spec.data_file, {.allow_nan = true});
  return {std::move(spec), data, settings};
}

std::vector<BodyLoad> ExternalLoads::at(double time) const {
  if (!(time >= first_time() - step_ && time <= last_time() + step_)) {
    throw std::invalid_argument(table_ + ": no loads at " + json_number(time) + " s: the table is from " +
                                json_number(first_time()) + " to " + json_number(last_time()) + " s");
  }
  const Eigen::VectorXd values = spline_(std::clamp(time, first_time(), last_time()));
  std::vector<BodyLoad> loads;
  for (std::size_t i = 0; i < spec_.forces.size(); ++i) {
    const ExternalForceSpec& force = spec_.forces[i];
    const auto first = static_cast<Eigen::Index>(9 * i);
    BodyLoad load{force.applied_to_body,
                  force.force_expressed_in_body,
                  force.point_expressed_in_body,
                  values.segment<3>(first),
                  values.segment<3>(first + 3),
                  values.segment<3>(first + 6)};
    // Without a point the force acts at the body's origin.
    if (force.point_identifier.empty()) load.point_frame = force.applied_to_body;
    loads.push_back(std::move(load));
  }
  return loads;
}

void ExternalLoads::require_bodies(const model::ModelDescription& model) const {
  std::vector<std::string> names{model::kGround};
  for (const auto& body : model.bodies) names.push_back(body.name);
  for (const ExternalForceSpec& force : spec_.forces) {
    const std::pair<const char*, const std::string*> said[] = {
        {"applied_to_body", &force.applied_to_body},
        {"force_expressed_in_body", &force.force_expressed_in_body},
        {"point_expressed_in_body", &force.point_expressed_in_body}};
    for (const auto& [element, body] : said) {
      if (std::find(names.begin(), names.end(), *body) != names.end()) continue;
      throw std::invalid_argument(spec_.source + ": force '" + force.name + "': " + element + " is '" +
                                  *body + "': model '" + model.name + "' has no such body" +
                                  did_you_mean(*body, names) + " (bodies: " +
                                  listed(names, names.size()) + ")");
    }
  }
}

std::vector<model::ExternalLoad> ExternalLoads::in_ground(
    double time, const model::Kinematics& kinematics) const {
  const model::Model& model = kinematics.model();
  std::vector<model::ExternalLoad> loads;
  for (const BodyLoad& load : at(time)) {
    const Matrix3& R_GE = kinematics.X_GB(model.body(load.force_frame)).R;
    loads.push_back({model.body(load.body), R_GE * load.force,
                     kinematics.X_GB(model.body(load.point_frame)) * load.point,
                     R_GE * load.moment});
  }
  return loads;
}

}  // namespace condyle::io
