// SPDX-License-Identifier: Apache-2.0
// Which faces meet at which edge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// One side of a face, as a user of an undirected edge.
struct FaceSide {
  std::int32_t low = 0;    ///< smaller vertex of the edge
  std::int32_t high = 0;   ///< larger vertex of the edge
  std::int32_t face = 0;   ///< the face
  std::int8_t corner = 0;  ///< the side runs from this corner of the face to the next
  bool forward = false;    ///< the face runs along it from low to high
};

/// All face sides grouped by edge. A side whose two vertices are the same is left out.
class MeshEdges {
 public:
  explicit MeshEdges(const TriangleMesh& mesh);

  std::size_t count() const { return first_.size() - 1; }

  /// The sides that share edge `e`, in face order: one at an open border, two on a manifold
  /// surface, more elsewhere.
  std::span<const FaceSide> sides(std::size_t e) const {
    return {sides_.data() + first_[e], first_[e + 1] - first_[e]};
  }

 private:
  std::vector<FaceSide> sides_;
  std::vector<std::size_t> first_;  // of each edge in sides_, and one past the last
};

}  // namespace condyle::geometry
