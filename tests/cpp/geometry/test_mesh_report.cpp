// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/geometry/mesh_report.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::geometry;

namespace {
RigidTransform general_placement() {
  test::Draw draw(5);
  return transform_TF(test::general_pose(draw));
}
}  // namespace

TEST_CASE("a box in a general pose: closed, one part, area and volume of a box") {
  const auto mesh = test::moved(test::box({0.013, 0.021, 0.008}), general_placement());
  const MeshReport report = report_mesh(mesh);
  CHECK(report.vertices == 8);
  CHECK(report.faces == 12);
  CHECK(report.closed);
  CHECK(report.components == 1);
  CHECK(report.boundary_edges + report.boundary_loops + report.inconsistent_edges +
            report.non_manifold_edges + report.duplicate_vertices + report.duplicate_faces +
            report.degenerate_faces + report.sliver_faces + report.unused_vertices ==
        0);
  // Rounding of a few dozen operations: 1e-13 relative is hundreds of ulps.
  CHECK(report.volume == doctest::Approx(8.0 * 0.013 * 0.021 * 0.008).epsilon(1e-13));
  CHECK(report.area ==
        doctest::Approx(8.0 * (0.013 * 0.021 + 0.021 * 0.008 + 0.008 * 0.013)).epsilon(1e-13));
  CHECK(report_mesh(test::reversed(mesh)).volume == doctest::Approx(-report.volume).epsilon(1e-13));
  CHECK((report.highest - report.lowest).minCoeff() > 0.016);
}

TEST_CASE("an open patch with a hole: two border loops, no volume") {
  auto mesh = test::patch(0.004, -0.01, 0.012, 6, [](double x, double z) { return 3.0 * x * z; });
  const Eigen::Index hole = 2 * (6 * 2 + 3);  // both faces of an inner square
  TriangleMesh open = mesh;
  open.faces.resize(mesh.face_count() - 2, 3);
  open.faces << mesh.faces.topRows(hole), mesh.faces.bottomRows(mesh.face_count() - hole - 2);
  const MeshReport report = report_mesh(open);
  CHECK(!report.closed);
  CHECK(report.boundary_edges == 4 * 6 + 4);
  CHECK(report.boundary_loops == 2);
  CHECK(report.volume == 0.0);
}

TEST_CASE("each fault is counted under its own name") {
  const auto good = test::box({0.013, 0.021, 0.008});
  auto mesh = good;
  std::swap(mesh.faces(4, 1), mesh.faces(4, 2));
  CHECK(report_mesh(mesh).inconsistent_edges == 3);

  mesh = good;
  mesh.faces.conservativeResize(15, 3);
  mesh.faces.row(12) = Eigen::RowVector3i(good.faces(2, 1), good.faces(2, 2), good.faces(2, 0));
  mesh.faces.row(13) << 5, 5, 1;
  mesh.faces.row(14) << 0, 1, 8;
  mesh.vertices.conservativeResize(11, 3);
  mesh.vertices.row(8) = 0.5 * (good.vertices.row(0) + good.vertices.row(1));
  mesh.vertices(8, 1) += 0.4e-6;  // altitude 0.4 µm
  mesh.vertices.row(9) = good.vertices.row(7);
  mesh.vertices.row(10) << 0.0, 0.001, 0.002;
  const MeshReport report = report_mesh(mesh);
  CHECK(report.duplicate_faces == 1);
  CHECK(report.degenerate_faces == 1);
  CHECK(report.sliver_faces == 1);
  CHECK(report.duplicate_vertices == 1);
  CHECK(report.unused_vertices == 2);
  CHECK(report.non_manifold_edges >= 3);
}

TEST_CASE("parts that share no edge are components, also where they touch in a vertex") {
  const auto two =
      test::joined(test::sphere(0.01, 1), test::shifted(test::sphere(0.02, 1), {0.05, 0, 0}));
  CHECK(report_mesh(two).components == 2);
  const auto butterfly =
      test::mesh_of({{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {-0.01, 0, 0}, {0, -0.01, 0}},
                    {{0, 1, 2}, {0, 3, 4}});
  CHECK(report_mesh(butterfly).components == 2);
}
