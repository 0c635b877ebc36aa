// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/path_snapshot.hpp"

#include <cmath>
#include <stdexcept>

namespace condyle::model {
namespace {

void require_valid(const PathSnapshot& snapshot, const std::string& where, int n_bodies) {
  const auto refuse = [&](const std::string& what) { throw std::invalid_argument(where + what); };
  if (snapshot.points.size() < 2) {
    refuse(": " + std::to_string(snapshot.points.size()) + " points: must be at least 2");
  }
  if (!std::isfinite(snapshot.arc_excess)) refuse(": arc_excess is not finite");
  for (std::size_t i = 0; i < snapshot.points.size(); ++i) {
    const HeldPoint& point = snapshot.points[i];
    const std::string item = ": points[" + std::to_string(i) + "]";
    if (point.body < -1 || point.body >= n_bodies) {
      refuse(item + ".body is " + std::to_string(point.body) + ": must be −1 (ground) to " +
             std::to_string(n_bodies - 1));
    }
    if (!point.location.allFinite()) refuse(item + ".location is not finite");
  }
}

}  // namespace

const PathSnapshot* PathSnapshots::find(std::string_view path, std::size_t time_frame) const {
  const auto found = paths.find(path);
  if (found == paths.end() || time_frame >= found->second.size()) return nullptr;
  return &found->second[time_frame];
}

void require_valid(const PathSnapshots& snapshots, int n_bodies) {
  for (std::size_t k = 0; k < snapshots.times.size(); ++k) {
    if (!std::isfinite(snapshots.times[k]) ||
        (k > 0 && !(snapshots.times[k] > snapshots.times[k - 1]))) {
      throw std::invalid_argument(snapshots.source + ": times[" + std::to_string(k) + "] is " +
                                  std::to_string(snapshots.times[k]) +
                                  ": must be finite and above the one before");
    }
  }
  for (const auto& [name, over_time] : snapshots.paths) {
    const std::string path = snapshots.source + ": paths." + name;
    if (over_time.size() != snapshots.times.size()) {
      throw std::invalid_argument(path + ": " + std::to_string(over_time.size()) +
                                  " snapshots: must be as many as times, " +
                                  std::to_string(snapshots.times.size()));
    }
    for (std::size_t k = 0; k < over_time.size(); ++k) {
      require_valid(over_time[k], path + "[" + std::to_string(k) + "]", n_bodies);
    }
  }
}

}  // namespace condyle::model
