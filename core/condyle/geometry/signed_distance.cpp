// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/signed_distance.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "condyle/geometry/distance_octree.hpp"
#include "condyle/geometry/surface_features.hpp"

namespace condyle::geometry {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using TriangleList = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, TriangleList::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Point to_cgal(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

TriangleList triangle_list(const SurfaceFeatures& surface) {
  TriangleList list;
  list.reserve(static_cast<std::size_t>(surface.face_count()));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const Triangle& t = surface.triangle(f);
    list.emplace_back(to_cgal(t.a), to_cgal(t.b), to_cgal(t.c));
  }
  return list;
}

const TriangleMesh& checked(const TriangleMesh& mesh) {
  require_well_formed(mesh, "signed distance");
  return mesh;
}

}  // namespace

struct SignedDistance::Impl {
  explicit Impl(const TriangleMesh& mesh)
      : surface(checked(mesh)), triangles(triangle_list(surface)), octree(surface) {
    tree.insert(triangles.cbegin(), triangles.cend());
    // Both are otherwise built by the first query: do it here, so that queries only read.
    tree.build();
    tree.accelerate_distance_queries();
  }

  SurfaceQuery search(const Vector3& p) const {
    const auto found = tree.closest_point_and_primitive(to_cgal(p));
    const auto face = static_cast<std::int32_t>(found.second - triangles.cbegin());
    // CGAL says which triangle; the projection is done again here, with the feature that it falls
    // on.
    return surface.resolve(p, face, closest_point(p, surface.triangle(face)));
  }

  SurfaceQuery search(const Vector3& p, std::span<const std::int32_t> candidates) const {
    double best = std::numeric_limits<double>::infinity(), best_squared = best;
    std::int32_t best_face = -1;
    ClosestPoint best_point{};
    for (const std::int32_t face : candidates) {
      const Ball& ball = surface.ball(face);
      const double reach = best + ball.radius;
      if ((p - ball.centre).squaredNorm() > reach * reach) continue;
      const ClosestPoint c = closest_point(p, surface.triangle(face));
      const double squared = (c.point - p).squaredNorm();
      if (squared >= best_squared) continue;
      best_squared = squared;
      best = std::sqrt(squared);
      best_face = face;
      best_point = c;
    }
    return surface.resolve(p, best_face, best_point);
  }

  SurfaceFeatures surface;
  TriangleList triangles;
  DistanceOctree octree;
  Tree tree;
};

SignedDistance::SignedDistance(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

SurfaceQuery SignedDistance::query(const Vector3& p) const { return impl_->search(p); }

bool SignedDistance::penetrates(const Vector3& p, SurfaceQuery& result) const {
  const auto cell = impl_->octree.cell(p);
  if (cell.kind == DistanceOctree::CellKind::kOutside) return false;
  const SurfaceQuery query = cell.kind == DistanceOctree::CellKind::kCandidates
                                 ? impl_->search(p, cell.candidates)
                                 : impl_->search(p);
  if (!(query.distance < 0.0)) return false;
  result = query;
  return true;
}

}  // namespace condyle::geometry
