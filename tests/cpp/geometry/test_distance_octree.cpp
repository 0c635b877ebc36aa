// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "condyle/geometry/distance_octree.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::geometry;

TEST_CASE(
    "a cell's word can be taken: outside is outside, and the closest face is among the "
    "candidates") {
  // A folded open sheet: both its sides are seen from between the folds.
  const auto mesh = test::patch(0.001, -0.002, 0.015, 20, [](double x, double z) {
    return 0.006 * std::sin(400.0 * x) + 0.5 * z;
  });
  const SurfaceFeatures surface(mesh);
  const DistanceOctree octree(surface);
  test::Draw draw(41);
  int kinds[3] = {0, 0, 0};
  for (int i = 0; i < 3000; ++i) {
    const double reach = i % 5 == 0 ? 0.1 : 0.02;
    const Vector3 p(draw(-reach, reach), draw(-reach, reach), draw(-reach, reach));
    double best = 1e9, best_candidate = 1e9;
    std::int32_t closest = -1;
    for (std::int32_t f = 0; f < surface.face_count(); ++f) {
      const double distance = (closest_point(p, surface.triangle(f)).point - p).norm();
      if (distance < best) best = distance, closest = f;
    }
    const auto cell = octree.cell(p);
    ++kinds[static_cast<int>(cell.kind)];
    if (cell.kind == DistanceOctree::CellKind::kOutside) {
      CHECK(surface.resolve(p, closest, closest_point(p, surface.triangle(closest))).distance >
            0.0);
    } else if (cell.kind == DistanceOctree::CellKind::kCandidates) {
      for (const auto f : cell.candidates) {
        best_candidate =
            std::min(best_candidate, (closest_point(p, surface.triangle(f)).point - p).norm());
      }
      CHECK(best_candidate == best);
    }
  }
  CHECK(kinds[0] > 300);
  CHECK(kinds[1] > 300);
  CHECK(octree.cell({100.0, 0.0, 0.0}).kind == DistanceOctree::CellKind::kUnknown);
}
