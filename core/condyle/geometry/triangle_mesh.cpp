// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <stdexcept>
#include <string>

namespace condyle::geometry {

void require_well_formed(const TriangleMesh& mesh, const char* what) {
  const std::string name(what);
  if (mesh.face_count() == 0) throw std::invalid_argument(name + ": the mesh has no faces");
  if (!mesh.vertices.allFinite()) {
    throw std::invalid_argument(name + ": the mesh has a vertex that is not finite");
  }
  const auto lowest = mesh.faces.minCoeff(), highest = mesh.faces.maxCoeff();
  if (lowest < 0 || highest >= mesh.vertex_count()) {
    throw std::invalid_argument(name + ": a face uses vertex " +
                                std::to_string(lowest < 0 ? lowest : highest) + " of " +
                                std::to_string(mesh.vertex_count()));
  }
}

VertexArray face_centroids(const TriangleMesh& mesh) {
  VertexArray centroids(mesh.face_count(), 3);
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    centroids.row(f) = (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) +
                        mesh.vertices.row(mesh.faces(f, 2))) /
                       3.0;
  }
  return centroids;
}

Eigen::VectorXd face_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas(mesh.face_count());
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    const Vector3 a = mesh.vertices.row(mesh.faces(f, 0));
    const Vector3 b = mesh.vertices.row(mesh.faces(f, 1));
    const Vector3 c = mesh.vertices.row(mesh.faces(f, 2));
    areas[f] = 0.5 * (b - a).cross(c - a).norm();
  }
  return areas;
}

}  // namespace condyle::geometry
