// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/trial_snapshots.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/io/path_snapshot_file.hpp"
#include "condyle/io/short_number.hpp"
#include "condyle/io/trial_file.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/path.hpp"
#include "condyle/model/path_route.hpp"

namespace condyle::io {
namespace {

using model::HeldPoint;
using model::PathSnapshot;
using model::PathSnapshots;

/// Ends of held and computed paths that differ by less are the same [m]: files carry 8 digits, and
/// a point that moves with a coordinate may be evaluated a rounding of that coordinate away.
constexpr double kSamePoint = 1e-4;

/// The first snapshot that is not before `time`; the last where all are.
std::size_t row_at(const std::vector<double>& known, double time) {
  const auto found = std::lower_bound(known.begin(), known.end(), time - kSameTime);
  return static_cast<std::size_t>(std::min(found, known.end() - 1) - known.begin());
}

std::vector<std::size_t> rows_at(const PathSnapshots& snapshots, std::span<const double> times) {
  const std::vector<double>& known = snapshots.times;
  std::vector<std::size_t> rows;
  for (const double time : times) {
    rows.push_back(row_at(known, time));
    if (std::abs(known[rows.back()] - time) <= kSameTime) continue;
    throw std::invalid_argument(snapshots.source + ": no snapshot at " + short_number(time) +
                                " s; it has " + std::to_string(known.size()) + " from " +
                                short_number(known.front()) + " to " + short_number(known.back()) +
                                " s: snapshots are made of the motion that they go with");
  }
  return rows;
}

/// Refuses a held path that begins or ends elsewhere than the model's own.
void require_same_ends(const model::Kinematics& kinematics, const std::string& owner,
                       const model::PathDescription& description, const PathSnapshot& held,
                       const std::string& source) {
  const model::Path path(kinematics.model(), description, owner);
  model::PathWorkspace workspace;
  const PathSnapshot own = path.snapshot(kinematics, workspace);
  const auto away = [&](const HeldPoint& a, const HeldPoint& b) {
    return (kinematics.X_GB(a.body) * a.location - kinematics.X_GB(b.body) * b.location).norm();
  };
  const double begin = away(held.points.front(), own.points.front());
  const double end = away(held.points.back(), own.points.back());
  const double most = std::max(begin, end);
  if (most <= kSamePoint) return;
  throw std::invalid_argument(source + ": " + owner + (begin >= end ? " begins " : " ends ") +
                              short_number(1e3 * most, 3) + " mm from where model '" +
                              kinematics.model().description().name +
                              "' has it: snapshots of another model");
}

template <typename Item>
void require_same_ends(const model::Kinematics& kinematics, const char* kind,
                       const std::vector<Item>& items, const PathSnapshots& snapshots,
                       std::size_t row) {
  for (const Item& item : items) {
    const PathSnapshot* held = snapshots.find(item.name, row);
    if (held == nullptr) continue;
    require_same_ends(kinematics, std::string(kind) + " '" + item.name + "'", item.path, *held,
                      snapshots.source);
  }
}

}  // namespace

TrialSnapshots read_trial_snapshots(const std::filesystem::path& file, const model::Model& model,
                                    std::span<const double> times,
                                    const Eigen::Ref<const Eigen::VectorXd>& q) {
  TrialSnapshots found{read_path_snapshots(file, model.description()), {}};
  found.rows = rows_at(found.snapshots, times);
  model::Kinematics kinematics(model);
  kinematics.set(q);
  const std::size_t row = found.rows.front();
  require_same_ends(kinematics, "muscle", model.description().muscles, found.snapshots, row);
  require_same_ends(kinematics, "ligament", model.description().ligaments, found.snapshots, row);
  return found;
}

}  // namespace condyle::io
