// SPDX-License-Identifier: Apache-2.0
// A triangle surface as plain arrays.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "condyle/common/types.hpp"

namespace condyle::geometry {

using VertexArray = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using FaceArray = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// An indexed triangle surface, open or closed. Row-major, so that NumPy sees (n, 3) arrays without a copy.
struct TriangleMesh {
  VertexArray vertices;  ///< n × 3 [m]
  FaceArray faces;       ///< m × 3 indices into vertices, counter-clockwise seen from outside

  Eigen::Index vertex_count() const { return vertices.rows(); }
  Eigen::Index face_count() const { return faces.rows(); }
};

/// Throws std::invalid_argument unless the mesh has faces, finite vertices and indices in range; `what` names it.
void require_well_formed(const TriangleMesh& mesh, const char* what);

/// Centroids of the faces, m × 3 [m].
VertexArray face_centroids(const TriangleMesh& mesh);

/// Areas of the faces, m [m²].
Eigen::VectorXd face_areas(const TriangleMesh& mesh);

}  // namespace condyle::geometry
