// SPDX-License-Identifier: Apache-2.0
// A surface as points to integrate over: one a face, at its centroid, with the face's area.
#pragma once

#include <vector>

#include "condyle/contact/elastic_layer.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

/// Faces of one surface, in the frame of its body.
struct SurfaceFaces {
  geometry::VertexArray centroids;  ///< m × 3 [m]
  Eigen::VectorXd areas;            ///< m [m²]
  geometry::VertexArray normals;  ///< m × 3, unit, out of the body (zero for a face without area)
  /// The elastic layer under each face, for laws that have one; empty: the law's own everywhere.
  std::vector<Layer> layers;

  Eigen::Index count() const { return centroids.rows(); }
};

/// Centroids, areas and unit normals of a mesh's faces, without layers.
SurfaceFaces surface_faces(const geometry::TriangleMesh& mesh);

}  // namespace condyle::contact
