// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "condyle/contact/compartments.hpp"
#include "geometry/shapes.hpp"

using namespace condyle;
using namespace condyle::contact;
using geometry::face_areas;
using geometry::face_centroids;

TEST_CASE("an insert is split by face centroid: every face is in one compartment, uncut") {
  // 21 squares across: faces straddle z = 0.
  const auto insert =
      test::patch(0.003, 0.0007, 0.03, 21, [](double x, double z) { return 0.01 + x * z; });
  for (const SideOfBody side : {SideOfBody::kLeft, SideOfBody::kRight}) {
    const InsertMeshes split = split_insert(insert, side);
    CHECK(split[kMedial].face_count() + split[kLateral].face_count() == insert.face_count());
    CHECK(face_areas(split[kMedial]).sum() + face_areas(split[kLateral]).sum() ==
          doctest::Approx(face_areas(insert).sum()).epsilon(1e-14));
    const double medial = medial_direction(side);
    CHECK((face_centroids(split[kMedial]).col(2).array() * medial >= 0.0).all());
    CHECK((face_centroids(split[kLateral]).col(2).array() * medial <= 0.0).all());
    const auto& right = split[medial > 0.0 ? kMedial : kLateral];
    CHECK(right.vertices.col(2).minCoeff() < 0.0);
  }
  CHECK(split_insert(insert, SideOfBody::kLeft)[kMedial].faces ==
        split_insert(insert, SideOfBody::kRight)[kLateral].faces);
}

TEST_CASE("an insert that lies on one side alone is refused") {
  const auto insert = test::patch(0.003, 0.04, 0.03, 4, [](double, double) { return 0.01; });
  CHECK_THROWS_WITH_AS(
      split_insert(insert, SideOfBody::kRight),
      "insert: no face on the medial side of z = 0: is the insert's frame in the middle of it, "
      "with z to the right?",
      std::invalid_argument);
}
