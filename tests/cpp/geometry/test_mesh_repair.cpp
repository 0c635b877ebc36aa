// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "condyle/geometry/mesh_repair.hpp"
#include "condyle/geometry/mesh_report.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::geometry;

namespace {

TriangleMesh bumpy() {
  return test::patch(0.004, -0.01, 0.02, 12,
                     [](double x, double z) { return 8.0 * x * z + 0.003; });
}

void flip(TriangleMesh& mesh, Eigen::Index face) {
  std::swap(mesh.faces(face, 1), mesh.faces(face, 2));
}

}  // namespace

TEST_CASE("a sound mesh is returned as it is") {
  const auto mesh = bumpy();
  const RepairResult result = repair_mesh(mesh);
  CHECK(result.mesh.vertices == mesh.vertices);
  CHECK(result.mesh.faces == mesh.faces);
  CHECK(result.welded_vertices + result.unused_vertices + result.degenerate_faces +
            result.duplicate_faces + result.turned_faces + result.inconsistent_edges ==
        0);
}

TEST_CASE("a soup is welded back, also where its copies differ by less than the distance") {
  const auto mesh = bumpy();
  auto loose = test::soup(mesh);
  test::Draw draw(3);
  for (Eigen::Index i = 0; i < loose.vertices.size(); ++i)
    loose.vertices.data()[i] += draw(-1e-10, 1e-10);
  const RepairResult result = repair_mesh(loose);
  CHECK(result.mesh.vertex_count() == mesh.vertex_count());
  CHECK(result.welded_vertices == loose.vertex_count() - mesh.vertex_count());
  CHECK(report_mesh(result.mesh).boundary_edges == report_mesh(mesh).boundary_edges);
  CHECK(repair_mesh(loose, {.weld_distance = 0.0}).welded_vertices == 0);
  CHECK(repair_mesh(test::soup(mesh), {.weld_distance = 0.0}).mesh.vertex_count() ==
        mesh.vertex_count());
}

TEST_CASE("faces without area, repeated faces and stray vertices go; the shape stays") {
  auto mesh = bumpy();
  const double area = face_areas(mesh).sum();
  const auto faces = mesh.face_count(), vertices = mesh.vertex_count();
  mesh.faces.conservativeResize(faces + 3, 3);
  mesh.faces.row(faces) = mesh.faces.row(7).reverse();
  mesh.faces.row(faces + 1) << 4, 4, 9;
  mesh.faces.row(faces + 2) << 2, 5, static_cast<int>(vertices);
  mesh.vertices.conservativeResize(vertices + 2, 3);
  mesh.vertices.row(vertices) = mesh.vertices.row(5);
  mesh.vertices.row(vertices + 1) << 0.03, 0.01, 0.02;
  const RepairResult result = repair_mesh(mesh);
  CHECK(result.duplicate_faces == 1);
  CHECK(result.degenerate_faces == 2);
  CHECK(result.welded_vertices == 1);
  CHECK(result.unused_vertices == 1);
  CHECK(result.mesh.vertex_count() == vertices);
  CHECK(face_areas(result.mesh).sum() == doctest::Approx(area).epsilon(1e-14));
}

TEST_CASE(
    "windings follow the larger part of the area on an open surface, and outwards on a closed "
    "one") {
  auto open = bumpy();
  const auto good = open;
  test::Draw draw(17);
  Eigen::Index flipped = 0;
  for (Eigen::Index f = 0; f < open.face_count(); ++f) {
    if (draw(0.0, 1.0) < 0.3) flip(open, f), ++flipped;
  }
  const RepairResult result = repair_mesh(open);
  CHECK(result.turned_faces == flipped);
  for (Eigen::Index f = 0; f < good.face_count(); ++f) {
    // The same cycle: the sum of squares of rotations agrees with one of the three starts.
    const auto a = good.faces.row(f), b = result.mesh.faces.row(f);
    CHECK((b == a || b == Eigen::RowVector3i(a[1], a[2], a[0]) ||
           b == Eigen::RowVector3i(a[2], a[0], a[1])));
  }

  const auto inverted = test::reversed(test::shifted(test::sphere(0.02, 2), {0.3, -0.2, 0.1}));
  CHECK(report_mesh(repair_mesh(inverted).mesh).volume > 0.0);
  CHECK(report_mesh(repair_mesh(inverted, {.turn_closed_outward = false}).mesh).volume < 0.0);
}

TEST_CASE("a Moebius band has no two sides: what cannot be done is counted") {
  std::vector<Vector3> v;
  std::vector<Eigen::Vector3i> f;
  constexpr int kSegments = 16;
  for (int i = 0; i < kSegments; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kSegments;
    for (const double w : {-0.005, 0.005}) {
      const double r = 0.03 + w * std::cos(0.5 * a);
      v.emplace_back(r * std::cos(a), w * std::sin(0.5 * a), r * std::sin(a));
    }
  }
  for (int i = 0; i < kSegments; ++i) {
    const bool last = i + 1 == kSegments;  // the band closes with its two rims swapped
    const int a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    f.insert(f.end(), {{a, c, b}, {b, c, d}});
  }
  CHECK(repair_mesh(test::mesh_of(v, f)).inconsistent_edges >= 1);
}

TEST_CASE("settings out of range and meshes without area are refused") {
  CHECK_THROWS_WITH_AS(repair_mesh(bumpy(), {.weld_distance = -1.0}),
                       "weld_distance is -1.000000 m: must be finite and not negative",
                       std::invalid_argument);
  const auto line = test::mesh_of({{0, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0}}, {{0, 1, 2}});
  CHECK_THROWS_WITH_AS(repair_mesh(line), "mesh repair: no face has an area",
                       std::invalid_argument);
}
