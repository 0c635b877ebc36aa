// SPDX-License-Identifier: Apache-2.0
// The smooth distance field of a triangle surface, from exact signed distances.
#pragma once

#include "condyle/geometry/distance_field.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// Samples the exact signed distance (signed_distance.hpp) of `mesh` and fits the spline.
///
/// Where the closest point lies on the open border the sample is n·(p − closest), n the normal of a
/// face there: the smooth continuation that distance_field.hpp asks for.
/// @param threads 0: all. Same bytes for any number.
/// @throws std::invalid_argument if the mesh is not well formed or a setting is out of range.
DistanceField build_distance_field(const TriangleMesh& mesh, const DistanceFieldSettings& settings,
                                   int threads = 0);

}  // namespace condyle::geometry
