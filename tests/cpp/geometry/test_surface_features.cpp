// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <array>

#include "condyle/geometry/surface_features.hpp"
#include "geometry/shapes.hpp"

using namespace condyle;
using namespace condyle::geometry;

TEST_CASE("pseudonormals are angle-weighted: a corner's does not depend on how its faces are cut") {
  // Each side of a box is two triangles, and a corner sees one or two of them; the angles add up
  // all the same.
  const Vector3 half(0.013, 0.021, 0.017);
  const auto mesh = test::box(half);
  const SurfaceFeatures surface(mesh);
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const Triangle& t = surface.triangle(f);
    const std::array<Vector3, 3> corners{t.a, t.b, t.c};
    for (int k = 0; k < 3; ++k) {
      const Vector3 corner = corners[static_cast<std::size_t>(k)];
      const auto part = static_cast<TrianglePart>(static_cast<int>(TrianglePart::kCorner0) + k);
      const SurfaceQuery on = surface.resolve(corner, f, {corner, part});
      CHECK((on.gradient - corner.cwiseSign() / std::sqrt(3.0)).norm() < 1e-12);
      CHECK(!on.on_border);
    }
  }
}

TEST_CASE("a face's ball holds the face") {
  const SurfaceFeatures surface(test::sphere(0.02, 2));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const Triangle& t = surface.triangle(f);
    for (const auto& v : {t.a, t.b, t.c}) {
      CHECK((v - surface.ball(f).centre).norm() <= surface.ball(f).radius * (1.0 + 1e-15));
    }
  }
}
