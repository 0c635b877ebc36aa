// SPDX-License-Identifier: Apache-2.0
// What is right and wrong with a triangle surface, in numbers.
#pragma once

#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// Altitude below which a face is called a sliver [m]: its normal is then rounding of the file's
/// numbers (STL keeps float32, 4 nm at 50 mm) rather than shape.
inline constexpr double kSliverAltitude = 1e-6;

struct MeshReport {
  Eigen::Index vertices = 0;
  Eigen::Index faces = 0;
  Eigen::Index unused_vertices = 0;     ///< in no face
  Eigen::Index boundary_edges = 0;      ///< edges of one face
  Eigen::Index boundary_loops = 0;      ///< connected runs of boundary edges
  Eigen::Index inconsistent_edges = 0;  ///< edges whose two faces run along them the same way
  Eigen::Index non_manifold_edges = 0;  ///< edges of three faces or more
  Eigen::Index duplicate_vertices = 0;  ///< at exactly the place of an earlier vertex
  Eigen::Index duplicate_faces = 0;     ///< with the vertices of an earlier face, in any order
  Eigen::Index degenerate_faces = 0;    ///< without area, or with a vertex twice
  Eigen::Index sliver_faces = 0;        ///< with area, but an altitude under kSliverAltitude
  Eigen::Index components = 0;          ///< parts that share no edge
  bool closed = false;                  ///< no boundary edge
  double area = 0.0;                    ///< [m²]
  double volume = 0.0;                ///< signed, positive with normals out; 0 unless closed [m³]
  Vector3 lowest = Vector3::Zero();   ///< corner of the bounding box [m]
  Vector3 highest = Vector3::Zero();  ///< opposite corner [m]
};

/// Counts what MeshReport names. Vertices are taken as indexed: weld a mesh first if its faces do
/// not share them.
/// @throws std::invalid_argument if the mesh is not well formed.
MeshReport report_mesh(const TriangleMesh& mesh);

}  // namespace condyle::geometry
