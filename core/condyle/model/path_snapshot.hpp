// SPDX-License-Identifier: Apache-2.0
// A path held fast at one instant: its points, via and wrap, each fixed to its body.
//
//   L = Σ |p_{i+1} − p_i| + arc_excess,   arc_excess = arcs on surfaces − chords between their ends
//
// A taut path is the shortest there is, so where it touches moves its length by second order only:
// the held path has, at its instant, the length and the gradient of the path itself, and near it
// differs by O(h²) in length and O(h) in gradient.
// Its second derivative is that of the held polyline: the sliding and rolling of the points of
// contact is left out. So is what a point does that moves in its body with coordinates, even to
// first order: paths with such points had better be computed.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/common/types.hpp"

namespace condyle::model {

struct HeldPoint {
  int body = -1;                       ///< in the model's list; −1: ground
  Vector3 location = Vector3::Zero();  ///< in the body's frame [m]
};

struct PathSnapshot {
  std::vector<HeldPoint> points;  ///< in order; at least two
  double arc_excess = 0.0;        ///< [m]
};

/// Snapshots of paths over time, from an outside engine.
struct PathSnapshots {
  std::string source;                                                   ///< for messages: a file
  std::vector<double> times;                                            ///< [s], ascending
  std::map<std::string, std::vector<PathSnapshot>, std::less<>> paths;  ///< by name; one a time

  /// The snapshots of a path at a time frame; nullptr where the path has none.
  const PathSnapshot* find(std::string_view path, std::size_t time_frame) const;
};

/// Throws std::invalid_argument naming source, path, time frame, field, value and limit: times that
/// do not ascend, another number of snapshots than of times, fewer than two points, a body that is
/// not among the model's `n_bodies`, not finite.
void require_valid(const PathSnapshots& snapshots, int n_bodies);

}  // namespace condyle::model
