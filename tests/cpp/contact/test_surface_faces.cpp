// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "condyle/contact/surface_faces.hpp"
#include "contact/contact_fixtures.hpp"

using namespace condyle;
using namespace condyle::contact;

TEST_CASE("a surface's points: centroid, area and unit normal; no normal without an area") {
  const auto dish = test::dished_insert(8)[kMedial];
  const SurfaceFaces faces = surface_faces(dish);
  REQUIRE(faces.count() == dish.face_count());
  for (Eigen::Index f = 0; f < faces.count(); ++f) {
    const Vector3 n = faces.normals.row(f), c = faces.centroids.row(f);
    CHECK(std::abs(n.norm() - 1.0) < 1e-14);
    CHECK(n.y() > 0.9);
    for (int k = 0; k < 3; ++k) {  // the normal is across the plane of the corners and the centroid
      CHECK(std::abs(n.dot(Vector3(dish.vertices.row(dish.faces(f, k))) - c)) < 1e-16);
    }
  }
  const auto line = test::mesh_of({{0, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0}}, {{0, 1, 2}});
  CHECK(surface_faces(line).areas[0] == 0.0);
  CHECK(surface_faces(line).normals.row(0).norm() == 0.0);
}
