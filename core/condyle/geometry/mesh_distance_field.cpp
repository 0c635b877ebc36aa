// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_distance_field.hpp"

#include "condyle/geometry/signed_distance.hpp"

namespace condyle::geometry {
DistanceField build_distance_field(const TriangleMesh& mesh, const DistanceFieldSettings& settings,
                                   int threads) {
  const SignedDistance distance(mesh);
  const DistanceSampler sampler = [&](const Vector3& p) {
    const SurfaceQuery query = distance.query(p);
    return DistanceSample{query.on_border ? query.continuation : query.distance, query.on_border};
  };
  const Vector3 lowest = mesh.vertices.colwise().minCoeff();
  const Vector3 highest = mesh.vertices.colwise().maxCoeff();
  return DistanceField::build(lowest, highest, settings, sampler, threads);
}

}  // namespace condyle::geometry
