// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/surface_faces.hpp"

#include <Eigen/Geometry>

namespace condyle::contact {

SurfaceFaces surface_faces(const geometry::TriangleMesh& mesh) {
  SurfaceFaces faces{geometry::face_centroids(mesh), geometry::face_areas(mesh),
                     geometry::VertexArray::Zero(mesh.face_count(), 3),
                     {}};
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    const Vector3 a = mesh.vertices.row(mesh.faces(f, 0));
    const Vector3 b = mesh.vertices.row(mesh.faces(f, 1));
    const Vector3 c = mesh.vertices.row(mesh.faces(f, 2));
    if (faces.areas[f] > 0.0) faces.normals.row(f) = (b - a).cross(c - a) / (2.0 * faces.areas[f]);
  }
  return faces;
}

}  // namespace condyle::contact
