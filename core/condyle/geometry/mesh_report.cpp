// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_report.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "condyle/geometry/mesh_edges.hpp"

namespace condyle::geometry {
namespace {

// Union-find over small integers.
class Groups {
 public:
  explicit Groups(Eigen::Index count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  void join(std::int32_t a, std::int32_t b) { parent_[index(root(a))] = root(b); }
  bool is_root(std::int32_t a) { return root(a) == a; }

 private:
  static std::size_t index(std::int32_t a) { return static_cast<std::size_t>(a); }
  std::int32_t root(std::int32_t a) {
    while (parent_[index(a)] != a) a = parent_[index(a)] = parent_[index(parent_[index(a)])];
    return a;
  }
  std::vector<std::int32_t> parent_;
};

template <typename Key>
Eigen::Index count_repeats(std::vector<Key> keys) {
  std::sort(keys.begin(), keys.end());
  const auto distinct = std::unique(keys.begin(), keys.end()) - keys.begin();
  return static_cast<Eigen::Index>(keys.size()) - distinct;
}

void count_edges(const TriangleMesh& mesh, MeshReport& report) {
  const MeshEdges edges(mesh);
  Groups faces(mesh.face_count()), border(mesh.vertex_count());
  std::vector<std::int32_t> border_vertices;
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto sides = edges.sides(e);
    for (const auto& side : sides) faces.join(side.face, sides[0].face);
    if (sides.size() == 1) {
      ++report.boundary_edges;
      border.join(sides[0].low, sides[0].high);
      border_vertices.push_back(sides[0].low);
      border_vertices.push_back(sides[0].high);
    } else if (sides.size() > 2) {
      ++report.non_manifold_edges;
    } else if (sides[0].forward == sides[1].forward) {
      ++report.inconsistent_edges;
    }
  }
  std::sort(border_vertices.begin(), border_vertices.end());
  border_vertices.erase(std::unique(border_vertices.begin(), border_vertices.end()),
                        border_vertices.end());
  report.boundary_loops = std::count_if(border_vertices.begin(), border_vertices.end(),
                                        [&](std::int32_t v) { return border.is_root(v); });
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) report.components += faces.is_root(f);
  report.closed = report.boundary_edges == 0;
}

void count_repeated(const TriangleMesh& mesh, MeshReport& report) {
  std::vector<std::array<double, 3>> places;
  for (Eigen::Index v = 0; v < mesh.vertex_count(); ++v) {
    // + 0.0 makes a negative zero positive: the same place.
    places.push_back(
        {mesh.vertices(v, 0) + 0.0, mesh.vertices(v, 1) + 0.0, mesh.vertices(v, 2) + 0.0});
  }
  report.duplicate_vertices = count_repeats(std::move(places));

  std::vector<std::array<std::int32_t, 3>> corners;
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertex_count()), false);
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    std::array<std::int32_t, 3> abc{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
    for (const auto v : abc) used[static_cast<std::size_t>(v)] = true;
    std::sort(abc.begin(), abc.end());
    corners.push_back(abc);
  }
  report.duplicate_faces = count_repeats(std::move(corners));
  report.unused_vertices = std::count(used.begin(), used.end(), false);
}

}  // namespace

MeshReport report_mesh(const TriangleMesh& mesh) {
  require_well_formed(mesh, "mesh report");
  MeshReport report;
  report.vertices = mesh.vertex_count();
  report.faces = mesh.face_count();
  count_edges(mesh, report);
  count_repeated(mesh, report);
  report.lowest = mesh.vertices.colwise().minCoeff();
  report.highest = mesh.vertices.colwise().maxCoeff();
  // Volume by tetrahedra from the middle of the box: from a far origin they would cancel.
  const Vector3 middle = 0.5 * (report.lowest + report.highest);
  double volume = 0.0;
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    const Vector3 a = mesh.vertices.row(mesh.faces(f, 0)).transpose() - middle;
    const Vector3 b = mesh.vertices.row(mesh.faces(f, 1)).transpose() - middle;
    const Vector3 c = mesh.vertices.row(mesh.faces(f, 2)).transpose() - middle;
    const double twice_area = (b - a).cross(c - a).norm();
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    report.area += 0.5 * twice_area;
    volume += a.dot(b.cross(c)) / 6.0;
    if (!(twice_area > 0.0)) {
      ++report.degenerate_faces;
    } else if (twice_area < kSliverAltitude * longest) {
      ++report.sliver_faces;
    }
  }
  if (report.closed) report.volume = volume;
  return report;
}

}  // namespace condyle::geometry
