// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <set>

#include "condyle/geometry/closest_point.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::geometry;

TEST_CASE(
    "the closest point of a triangle: no point of it is nearer, and the named part holds it") {
  test::Draw draw(11);
  std::set<TrianglePart> seen;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto point = [&] { return Vector3(draw(-1, 1), draw(-1, 1), draw(-1, 1)); };
    const Triangle t{point(), point(), point()};
    const Vector3 p = 1.5 * point();
    const ClosestPoint closest = closest_point(p, t);
    seen.insert(closest.part);
    // The triangle is convex: c is closest if and only if (p − c)·(v − c) <= 0 at all corners v;
    // 1e-12 is rounding of O(1).
    const std::array<Vector3, 3> corners{t.a, t.b, t.c};
    for (const auto& v : corners) CHECK((p - closest.point).dot(v - closest.point) < 1e-12);
    // And c lies where it is said to.
    const auto part = static_cast<std::size_t>(closest.part);
    if (part == 0) {
      CHECK(std::abs((t.b - t.a).cross(t.c - t.a).normalized().dot(closest.point - t.a)) < 1e-12);
    } else if (part <= 3) {
      const Vector3 e = (corners[part % 3] - corners[part - 1]).normalized();
      CHECK((closest.point - corners[part - 1]).cross(e).norm() < 1e-12);
    } else {
      CHECK(closest.point == corners[part - 4]);
    }
  }
  CHECK(seen.size() == 7);
}

TEST_CASE("a triangle without area has finite closest points") {
  const Vector3 a(0.1, 0.2, 0.3), b(0.4, -0.2, 0.1);
  const Vector3 p(0.9, 0.1, -0.4);
  for (const Triangle& t : {Triangle{a, b, 0.5 * (a + b)}, Triangle{a, a, b}, Triangle{a, a, a}}) {
    CHECK(closest_point(p, t).point.allFinite());
  }
}
