// SPDX-License-Identifier: Apache-2.0
// A division of space around a surface that lets most signed-distance questions be answered without
// a search.
//
// For a cell with centre c and half diagonal h, let D be the distance from c to the surface. Any
// point of the cell is within D + h of the surface, so only triangles within D + 2h of c can be
// closest to a point of the cell: its candidates. Every feature's pseudonormal is a non-negative
// combination of the normals of the faces that meet there, all of which are candidates and contain
// the closest point; so where the whole cell lies on the outer side of every candidate's plane, φ >
// 0 in the whole cell. This holds for open surfaces too, and leaves no approximation behind.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "condyle/geometry/surface_features.hpp"

namespace condyle::geometry {

class DistanceOctree {
 public:
  explicit DistanceOctree(const SurfaceFeatures& surface);

  enum class CellKind : std::uint8_t {
    kOutside,     ///< φ > 0 in the whole cell
    kCandidates,  ///< the closest face is one of `candidates`
    kUnknown      ///< nothing is known: search the whole surface
  };
  struct Cell {
    CellKind kind = CellKind::kUnknown;
    std::span<const std::int32_t> candidates;
  };

  /// The cell that holds p; kUnknown for points beyond the octree.
  Cell cell(const Vector3& p) const;

  std::size_t node_count() const { return nodes_.size(); }
  std::size_t candidate_count() const { return candidates_.size(); }

 private:
  struct Node {
    std::int32_t first_child = -1;  // eight in a row; −1 at a leaf
    std::int32_t first = 0, count = 0;
    CellKind kind = CellKind::kUnknown;
  };
  struct Builder;

  std::vector<Node> nodes_;
  std::vector<std::int32_t> candidates_;
  Vector3 centre_ = Vector3::Zero();
  double half_side_ = 0.0;
};

}  // namespace condyle::geometry
