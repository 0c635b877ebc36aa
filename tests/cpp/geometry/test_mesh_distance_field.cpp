// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>

#include "condyle/geometry/mesh_distance_field.hpp"
#include "condyle/geometry/signed_distance.hpp"
#include "support/random_pose.hpp"

namespace condyle::geometry {
namespace {

// An open dish: a quarter of an ellipsoid's surface on a grid of parameters, outward normals.
TriangleMesh dish() {
  constexpr int kU = 40, kV = 30;
  TriangleMesh mesh;
  mesh.vertices.resize((kU + 1) * (kV + 1), 3);
  for (int u = 0; u <= kU; ++u) {
    for (int v = 0; v <= kV; ++v) {
      const double a = -0.8 + 1.7 * u / kU, b = -0.6 + 1.3 * v / kV;
      mesh.vertices.row(u * (kV + 1) + v) << 0.021 * std::cos(a) * std::cos(b),
          0.017 * std::sin(a) * std::cos(b), 0.024 * std::sin(b);
    }
  }
  mesh.faces.resize(2 * kU * kV, 3);
  int f = 0;
  for (int u = 0; u < kU; ++u) {
    for (int v = 0; v < kV; ++v) {
      const int i = u * (kV + 1) + v, j = i + kV + 1;
      mesh.faces.row(f++) << i, j, j + 1;
      mesh.faces.row(f++) << i, j + 1, i + 1;
    }
  }
  return mesh;
}

TEST_CASE("[oracle] the field follows the exact distance, its sign and its border") {
  const TriangleMesh mesh = dish();
  DistanceFieldSettings settings;
  settings.spacing = 0.6e-3;
  const DistanceField field = build_distance_field(mesh, settings, 1);
  const SignedDistance exact(mesh);
  test::Draw draw(31);
  int inner = 0, border = 0;
  for (int n = 0; n < 4000; ++n) {
    const double a = draw(-0.95, 1.05), b = draw(-0.75, 0.85), scale = 1.0 + draw(-0.08, 0.02);
    const Vector3 p = scale * Vector3(0.021 * std::cos(a) * std::cos(b),
                                      0.017 * std::sin(a) * std::cos(b), 0.024 * std::sin(b));
    const SurfaceQuery query = exact.query(p);
    if (query.on_border) {
      border += field.on_border(p) ? 1 : -1;  // may disagree within half a cell
      continue;
    }
    ++inner;
    // Facets: sagitta e²/(8R) with edges of 1 mm on R ≥ 12 mm is 10 µm, and what the spline rounds
    // is less than that.
    CHECK(std::abs(field.value(p) - query.distance) < 1e-5);
  }
  CHECK(inner > 2000);
  CHECK(border > 300);
}

}  // namespace
}  // namespace condyle::geometry
