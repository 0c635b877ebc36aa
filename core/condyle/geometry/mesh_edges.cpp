// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_edges.hpp"

#include <algorithm>
#include <tuple>

namespace condyle::geometry {

MeshEdges::MeshEdges(const TriangleMesh& mesh) {
  sides_.reserve(static_cast<std::size_t>(3 * mesh.face_count()));
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::int32_t from = mesh.faces(f, corner), to = mesh.faces(f, (corner + 1) % 3);
      if (from == to) continue;
      sides_.push_back(
          {std::min(from, to), std::max(from, to), f, static_cast<std::int8_t>(corner), from < to});
    }
  }
  std::sort(sides_.begin(), sides_.end(), [](const FaceSide& a, const FaceSide& b) {
    return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
  });
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    if (i == 0 || sides_[i].low != sides_[i - 1].low || sides_[i].high != sides_[i - 1].high) {
      first_.push_back(i);
    }
  }
  first_.push_back(sides_.size());
}

}  // namespace condyle::geometry
