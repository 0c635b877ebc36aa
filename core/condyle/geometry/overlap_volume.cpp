// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/overlap_volume.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <exception>
#include <iterator>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "condyle/common/parallel.hpp"
#include "condyle/geometry/mesh_report.hpp"

namespace condyle::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
// Inexact constructions suffice: every decision of one Boolean operation rests on the input's own
// points, and no operation follows whose input its rounded points would be.
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

constexpr double kRotationTolerance = 1e-6;  // poses from files have six digits or more

[[noreturn]] void fail(const std::string& what, const std::string& why) {
  throw std::invalid_argument(what + ": " + why);
}

Vector3 from_cgal(const Point& p) { return {p.x(), p.y(), p.z()}; }

void require_closed_outward(const TriangleMesh& mesh, const std::string& what) {
  const MeshReport report = report_mesh(mesh);
  const auto edges = [](Eigen::Index count) {
    return std::to_string(count) + (count == 1 ? " edge" : " edges");
  };
  if (report.degenerate_faces > 0) {
    fail(what, std::to_string(report.degenerate_faces) +
                   " faces have no area: repair the mesh (drop them)");
  }
  if (!report.closed) {
    fail(what, "the surface is open (" + edges(report.boundary_edges) + " of one face in " +
                   std::to_string(report.boundary_loops) +
                   " loops): an overlap volume needs a closed solid; give the solid's own file, or "
                   "weld the vertices of this one");
  }
  if (report.non_manifold_edges > 0) {
    fail(what, edges(report.non_manifold_edges) +
                   " shared by more than two faces: inside and outside are not defined there");
  }
  if (report.inconsistent_edges > 0) {
    fail(what, "faces disagree on which side is out at " + edges(report.inconsistent_edges) +
                   ": repair the mesh (consistent orientation)");
  }
  if (!(report.volume > 0.0)) {
    char volume[32];
    std::snprintf(volume, sizeof volume, "%.4g", 1e6 * report.volume);
    fail(what, std::string("normals point inwards (the closed surface has a volume of ") + volume +
                   " cm^3): reverse its faces");
  }
}

Surface surface_of(const TriangleMesh& mesh, const std::string& what) {
  Surface surface;
  surface.reserve(static_cast<unsigned>(mesh.vertex_count()),
                  static_cast<unsigned>(3 * mesh.face_count() / 2),
                  static_cast<unsigned>(mesh.face_count()));
  // A vertex in no face would be an isolated point of the surface, which corefinement does not
  // know.
  std::vector<Surface::Vertex_index> vertex(static_cast<std::size_t>(mesh.vertex_count()));
  const auto added = [&](std::int32_t v) {
    auto& at = vertex[static_cast<std::size_t>(v)];
    if (at == Surface::null_vertex()) {
      at = surface.add_vertex({mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)});
    }
    return at;
  };
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    const auto face =
        surface.add_face(added(mesh.faces(f, 0)), added(mesh.faces(f, 1)), added(mesh.faces(f, 2)));
    if (face == Surface::null_face()) {
      fail(what, "face " + std::to_string(f) +
                     " meets others in just a vertex: give each part vertices of its own");
    }
  }
  return surface;
}

Surface placed(Surface surface, const RigidTransform& X) {
  for (const auto v : surface.vertices()) {
    const Vector3 p = X * from_cgal(surface.point(v));
    surface.point(v) = Point(p.x(), p.y(), p.z());
  }
  return surface;
}

Eigen::Index count_self_intersections(const Surface& surface) {
  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> pairs;
  pmp::self_intersections(surface, std::back_inserter(pairs));
  return static_cast<Eigen::Index>(pairs.size());
}

bool boxes_apart(const Surface& a, const Surface& b) {
  Eigen::AlignedBox3d boxes[2];
  for (int i = 0; i < 2; ++i) {
    const Surface& surface = i == 0 ? a : b;
    for (const auto v : surface.vertices()) boxes[i].extend(from_cgal(surface.point(v)));
  }
  return !boxes[0].intersects(boxes[1]);
}

// Volume and centroid by tetrahedra to one of the surface's own corners: sums stay as small as the
// solid, wherever it is.
void integrate(const Surface& surface, OverlapVolume& result) {
  if (surface.number_of_faces() == 0) return;
  const Vector3 apex = from_cgal(surface.point(*surface.vertices().begin()));
  double sixfold = 0.0;
  Vector3 moment = Vector3::Zero();
  for (const auto f : surface.faces()) {
    Vector3 corner[3];
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) {
      corner[k++] = from_cgal(surface.point(v)) - apex;
    }
    const double part = corner[0].dot(corner[1].cross(corner[2]));
    sixfold += part;
    moment += part * 0.25 * (corner[0] + corner[1] + corner[2]);
  }
  result.volume = sixfold / 6.0;
  if (sixfold > 0.0) result.centroid = apex + moment / sixfold;
}

// Forms A ∩ B of copies that it may cut; false where the result is no manifold surface.
bool intersect(Surface a, Surface b, bool throw_on_self_intersection, Surface& result) {
  return pmp::corefine_and_compute_intersection(
      a, b, result, CGAL::parameters::throw_on_self_intersection(throw_on_self_intersection));
}

OverlapStatus form_overlap(const Surface& a, const Surface& b, bool self_intersecting,
                           Surface& result) {
  auto status = OverlapStatus::kOk;
  try {
    bool formed = false;
    try {
      formed = intersect(a, b, self_intersecting, result);
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
      status = OverlapStatus::kSelfIntersectionAtCut;
      result.clear();
      formed = intersect(a, b, false, result);
    }
    return formed ? status : OverlapStatus::kFailed;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // CGAL's: a case that its corefinement does not handle
    return OverlapStatus::kFailed;
  }
}

}  // namespace

struct OverlapSolid::Impl {
  Surface surface;
  double volume;
  Eigen::Index self_intersections;
};

OverlapSolid::OverlapSolid(const TriangleMesh& mesh, const std::string& what) {
  require_well_formed(mesh, what.c_str());
  require_closed_outward(mesh, what);
  Surface surface = surface_of(mesh, what);
  if (!pmp::does_bound_a_volume(surface)) {
    fail(what,
         "a part of the closed surface is inside out: normals must point out of each part, "
         "and into a void within one");
  }
  OverlapVolume whole;
  integrate(surface, whole);
  const Eigen::Index pairs = count_self_intersections(surface);
  impl_ = std::make_unique<const Impl>(Impl{std::move(surface), whole.volume, pairs});
}

OverlapSolid::~OverlapSolid() = default;
OverlapSolid::OverlapSolid(OverlapSolid&&) noexcept = default;
OverlapSolid& OverlapSolid::operator=(OverlapSolid&&) noexcept = default;

double OverlapSolid::volume() const { return impl_->volume; }
Eigen::Index OverlapSolid::self_intersections() const { return impl_->self_intersections; }

std::string_view name(OverlapStatus status) {
  switch (status) {
    case OverlapStatus::kOk:
      return "ok";
    case OverlapStatus::kSelfIntersectionAtCut:
      return "self_intersection_at_cut";
    case OverlapStatus::kFailed:
      break;
  }
  return "failed";
}

OverlapVolume overlap_volume(const OverlapSolid& a, const OverlapSolid& b,
                             const RigidTransform& X_BA) {
  if (!X_BA.R.allFinite() || !X_BA.p.allFinite()) {
    throw std::invalid_argument("overlap volume: the placement has a number that is not finite");
  }
  const double skew = (X_BA.R * X_BA.R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (skew > kRotationTolerance || X_BA.R.determinant() < 0.0) {
    throw std::invalid_argument(
        "overlap volume: the placement's R is not a rotation (R·Rᵀ differs "
        "from the identity by " +
        std::to_string(skew) + ")");
  }
  OverlapVolume result;
  result.self_intersections = a.self_intersections() + b.self_intersections();
  const Surface a_in_B = placed(a.impl().surface, X_BA);
  const Surface& b_in_B = b.impl().surface;
  if (boxes_apart(a_in_B, b_in_B)) return result;
  Surface overlap;
  result.status = form_overlap(a_in_B, b_in_B, result.self_intersections > 0, overlap);
  if (result.status == OverlapStatus::kFailed) {
    result.volume = std::numeric_limits<double>::quiet_NaN();
    result.centroid.setConstant(result.volume);
  } else {
    integrate(overlap, result);
  }
  return result;
}

std::vector<OverlapVolume> overlap_volumes(const OverlapSolid& femur, const OverlapSolid& insert,
                                           std::span<const Pose> poses, int threads) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i].allFinite()) {
      fail("overlap volume", "pose " + std::to_string(i) + " has a number that is not finite");
    }
  }
  std::vector<OverlapVolume> results(poses.size());
  parallel_for(poses.size(), threads, [&](std::size_t i) {
    results[i] = overlap_volume(femur, insert, transform_TF(poses[i]));
  });
  return results;
}

}  // namespace condyle::geometry
