// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/implant_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "condyle/contact/surface_faces.hpp"
#include "condyle/geometry/mesh_report.hpp"

namespace condyle::contact {
namespace {

constexpr double kEndShare = 0.1;  // of the height: the end where a part faces the other
constexpr double kSideTolerance =
    1e-3;  // [m] a compartment may reach over the middle, its mean may not

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", 1e3 * metres);
  return text;
}

[[noreturn]] void fail(const std::string& what, const std::string& why) {
  throw std::invalid_argument(what + ": " + why);
}

// Area-weighted mean of n_y over the lowest (end −1) or highest (end +1) tenth of a surface, by
// face centroid. Not over all of it: a solid cut in two is closed but for the cut, and its mean
// normal says nothing.
double mean_upward(const geometry::TriangleMesh& mesh, int end) {
  const SurfaceFaces faces = surface_faces(mesh);
  const Eigen::VectorXd level = end * faces.centroids.col(1);
  const double highest = level.maxCoeff(),
               limit = highest - kEndShare * (highest - level.minCoeff());
  double upward = 0.0, area = 0.0;
  for (Eigen::Index f = 0; f < faces.count(); ++f) {
    if (level[f] < limit) continue;
    upward += faces.areas[f] * faces.normals(f, 1);
    area += faces.areas[f];
  }
  return area > 0.0 ? upward / area : 0.0;
}

double height(const geometry::TriangleMesh& mesh) {
  return mesh.vertices.col(1).maxCoeff() - mesh.vertices.col(1).minCoeff();
}

void require_outward_volume(const std::string& what, double volume) {
  if (volume > 0.0) return;
  fail(what, "normals point inwards (the closed surface has a volume of " +
                 std::to_string(1e6 * volume) + " cm^3): reverse its faces");
}

}  // namespace

void require_femur(const geometry::TriangleMesh& femur) {
  const std::string what = "femur";
  geometry::require_well_formed(femur, "femur");
  const geometry::MeshReport report = geometry::report_mesh(femur);
  if (report.inconsistent_edges > 0) {
    fail(what, "faces disagree on which side is out at " +
                   std::to_string(report.inconsistent_edges) +
                   " edges: repair the mesh (consistent orientation)");
  }
  if (report.non_manifold_edges > 0) {
    fail(what,
         std::to_string(report.non_manifold_edges) +
             " edges are shared by more than two faces: inside and outside are not defined there");
  }
  if (report.closed) return require_outward_volume(what, report.volume);
  const double upward = mean_upward(femur, -1);
  if (upward >= 0.0) {
    fail(what, "normals point inwards (mean n_y in its lowest tenth is " + std::to_string(upward) +
                   ", must be negative): reverse its faces, or check that femur and insert are not "
                   "swapped and y is up");
  }
}

void require_insert(const InsertMeshes& insert, SideOfBody side_of_body) {
  for (const Side side : {kMedial, kLateral}) {
    const geometry::TriangleMesh& mesh = insert[side];
    const std::string what = "insert (" + std::string(name(side)) + ")";
    geometry::require_well_formed(mesh, what.c_str());
    const geometry::MeshReport report = geometry::report_mesh(mesh);
    const SurfaceFaces faces = surface_faces(mesh);
    if (report.closed) {
      require_outward_volume(what, report.volume);
    } else if (const double upward = mean_upward(mesh, +1); upward <= 0.0) {
      fail(what, "normals point inwards (mean n_y in its highest tenth is " +
                     std::to_string(upward) +
                     ", must be positive): reverse its faces, or check that femur and insert are "
                     "not swapped and y is up");
    }
    const double z = faces.areas.dot(faces.centroids.col(2)) / faces.areas.sum();
    const double towards = medial_direction(side_of_body) * (side == kMedial ? 1.0 : -1.0);
    if (z * towards < -kSideTolerance) {
      fail(what, "lies about z = " + millimetres(z) + " but in a " +
                     std::string(name(side_of_body)) + " knee " + std::string(name(side)) +
                     " is z " + (towards > 0.0 ? ">" : "<") +
                     " 0: check side_of_body, and that medial and lateral are not swapped");
    }
  }
}

void require_unswapped(const geometry::TriangleMesh& femur, const InsertMeshes& insert) {
  const double insert_height = std::max(height(insert[kMedial]), height(insert[kLateral]));
  if (height(femur) >= insert_height) return;
  fail("femur", millimetres(height(femur)) + " high, less than the insert's " +
                    millimetres(insert_height) + ": are femur and insert swapped?");
}

}  // namespace condyle::contact
