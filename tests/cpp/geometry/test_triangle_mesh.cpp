// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "condyle/geometry/triangle_mesh.hpp"
#include "geometry/shapes.hpp"

using namespace condyle;
using namespace condyle::geometry;

TEST_CASE("area-weighted centroids of a closed surface in a general place are its middle") {
  const Vector3 middle(0.011, -0.023, 0.037);
  const auto mesh = test::shifted(test::box({0.012, 0.007, 0.019}), middle);
  const Eigen::VectorXd areas = face_areas(mesh);
  // A box: 8 (ab + bc + ca) of its half sides. A dozen operations on numbers of 1e-2: 1e-15 is
  // hundreds of roundings.
  CHECK(areas.sum() ==
        doctest::Approx(8.0 * (0.012 * 0.007 + 0.007 * 0.019 + 0.019 * 0.012)).epsilon(1e-13));
  const Vector3 mean = face_centroids(mesh).transpose() * areas / areas.sum();
  CHECK((mean - middle).norm() < 1e-15);
}

TEST_CASE("a mesh that is not well formed is refused by name") {
  auto mesh = test::box({0.01, 0.02, 0.03});
  CHECK_NOTHROW(require_well_formed(mesh, "femur"));
  auto far = mesh;
  far.faces(3, 1) = 8;
  CHECK_THROWS_WITH_AS(require_well_formed(far, "femur"), "femur: a face uses vertex 8 of 8",
                       std::invalid_argument);
  auto infinite = mesh;
  infinite.vertices(2, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(require_well_formed(infinite, "insert"),
                       "insert: the mesh has a vertex that is not finite", std::invalid_argument);
  CHECK_THROWS_WITH_AS(require_well_formed(TriangleMesh{}, "insert"),
                       "insert: the mesh has no faces", std::invalid_argument);
}
