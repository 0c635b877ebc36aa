// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_distance_field.hpp"

#include <Eigen/Geometry>

#include "condyle/geometry/signed_distance.hpp"

namespace condyle::geometry {
namespace {

Vector3 face_normal(const TriangleMesh& mesh, std::int32_t face) {
  const Vector3 a = mesh.vertices.row(mesh.faces(face, 0));
  const Vector3 b = mesh.vertices.row(mesh.faces(face, 1));
  const Vector3 c = mesh.vertices.row(mesh.faces(face, 2));
  return (b - a).cross(c - a).normalized();
}

}  // namespace

DistanceField build_distance_field(const TriangleMesh& mesh, const DistanceFieldSettings& settings,
                                   int threads) {
  const SignedDistance distance(mesh);
  const DistanceSampler sampler = [&](const Vector3& p) {
    const SurfaceQuery query = distance.query(p);
    if (!query.on_border) return DistanceSample{query.distance, false};
    const Vector3 offset = p - query.closest_point(p);
    return DistanceSample{face_normal(mesh, query.face).dot(offset), true};
  };
  const Vector3 lowest = mesh.vertices.colwise().minCoeff();
  const Vector3 highest = mesh.vertices.colwise().maxCoeff();
  return DistanceField::build(lowest, highest, settings, sampler, threads);
}

}  // namespace condyle::geometry
