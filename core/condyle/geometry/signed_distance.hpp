// SPDX-License-Identifier: Apache-2.0
// Exact signed distance to a triangle surface, open or closed.
//
//   φ(p) = ± |p − c|,  c the closest point of the triangles, the sign that of (p − c)·n with n the
//   angle-weighted
// pseudonormal of the feature (face, edge or vertex) that c lies on; negative on the inner side.
//
// Away from the surface and from its medial axis φ is smooth, with g = ∇φ = (p − c)/φ and
//
//   ∇²φ = 0 (face),   (I − g gᵀ − e eᵀ)/φ (edge along e),   (I − g gᵀ)/φ (vertex).
//
// Source: Bærentzen & Aanæs 2005, IEEE Trans Vis Comput Graph 11(3):243–253,
// doi:10.1109/TVCG.2005.49 (signs).
#pragma once

#include <cstdint>
#include <memory>

#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// What part of the surface a closest point lies on.
enum class Feature : std::uint8_t { kFace, kEdge, kVertex };

/// The answer at one point; all in the mesh's frame.
struct SurfaceQuery {
  double distance = 0.0;                     ///< φ, negative inside [m]
  Vector3 gradient = Vector3::Zero();        ///< ∇φ, unit; the pseudonormal where |φ| < 1 pm
  Vector3 edge_direction = Vector3::Zero();  ///< e, unit, for Feature::kEdge
  std::int32_t face = -1;                    ///< a face that holds the closest point
  Feature feature = Feature::kFace;          ///< what the closest point lies on
  bool on_border = false;  ///< the feature is an edge or vertex of the open border
  /// n·(p − closest) with n the normal of `face`: how far p is above the surface's continuation where
  /// on_border [m]; near φ elsewhere.
  double continuation = 0.0;

  Vector3 closest_point(const Vector3& p) const { return p - distance * gradient; }

  /// ∇²φ [1/m]. Zero where |φ| < 1 pm: there it is unbounded, and a contact that stores no energy
  /// needs none.
  Matrix3 hessian() const;
};

/// Signed distance to a fixed surface, for many queries. Copies what it needs of the mesh.
///
/// Thread safety: all queries are const and may run at once.
/// @pre windings agree across edges (see mesh_repair.hpp); otherwise signs near the offending edges
/// are arbitrary.
class SignedDistance {
 public:
  /// @throws std::invalid_argument if the mesh is not well formed.
  explicit SignedDistance(const TriangleMesh& mesh);
  ~SignedDistance();
  SignedDistance(SignedDistance&&) noexcept;
  SignedDistance& operator=(SignedDistance&&) noexcept;

  /// The signed distance at any point p [m]: one closest-point search over the whole surface (CGAL
  /// AABB tree).
  SurfaceQuery query(const Vector3& p) const;

  /// True, and `result` filled as query() would (to rounding), where φ(p) < 0; false where φ(p) >=
  /// 0. Much quicker than query(): an octree knows the cells that are certainly outside, and near
  /// the surface the few triangles that can be closest.
  bool penetrates(const Vector3& p, SurfaceQuery& result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace condyle::geometry
