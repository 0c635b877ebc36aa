// SPDX-License-Identifier: Apache-2.0
// The repairs that a triangle surface can be given without changing its shape.
#pragma once

#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

struct RepairSettings {
  /// Vertices closer than this become one [m]; 0 joins only those at exactly the same place. Text
  /// files round to about 1e-9 m.
  double weld_distance = 1e-9;
  /// Turn a closed component whose volume is negative. Off, an inverted solid stays inverted, for
  /// the caller to refuse.
  bool turn_closed_outward = true;
};

/// The repaired surface, and how much of what was done.
struct RepairResult {
  TriangleMesh mesh;
  Eigen::Index welded_vertices = 0;
  Eigen::Index unused_vertices = 0;   ///< dropped: in no face
  Eigen::Index degenerate_faces = 0;  ///< dropped: without area, or with a vertex twice
  Eigen::Index duplicate_faces = 0;   ///< dropped: same vertices as an earlier face, in any order
  Eigen::Index turned_faces = 0;      ///< whose winding was reversed
  Eigen::Index inconsistent_edges =
      0;  ///< still there: the surface has no two sides (a Möbius band)
};

/// Welds vertices, drops faces without area and repeated faces, and makes windings agree.
///
/// Windings spread over edges of two faces, component by component; each component keeps the
/// winding of the larger part of its area, then a closed one is turned outward if asked. Order of
/// what remains is kept.
/// @throws std::invalid_argument if the mesh is not well formed, weld_distance is negative or not
/// finite, or no face
///   is left.
RepairResult repair_mesh(const TriangleMesh& mesh, const RepairSettings& settings = {});

}  // namespace condyle::geometry
