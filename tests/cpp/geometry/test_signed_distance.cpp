// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "condyle/geometry/signed_distance.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::geometry;

namespace {

const Vector3 kHalf(0.013, 0.021, 0.017);

/// Signed distance of a box about the origin, in closed form.
double box_distance(const Vector3& p) {
  const Vector3 q = p.cwiseAbs() - kHalf;
  return q.cwiseMax(0.0).norm() + std::min(0.0, q.maxCoeff());
}

RigidTransform placement() {
  test::Draw draw(23);
  return transform_TF(test::general_pose(draw));
}

/// A wavy surface with ridges, valleys and a slope; open or closed below by nothing.
TriangleMesh wavy() {
  return test::patch(0.004, -0.007, 0.02, 24, [](double x, double z) {
    return 0.004 * std::sin(320.0 * x) * std::cos(260.0 * z) + 0.3 * std::abs(x) - 0.1 * z;
  });
}

void check_same(const SurfaceQuery& a, const SurfaceQuery& b) {
  // The same triangles, projected the same way; a tie between neighbours may fall either way and
  // moves the numbers by rounding of coordinates of 0.05 only.
  CHECK(std::abs(a.distance - b.distance) < 1e-15);
  CHECK(a.on_border == b.on_border);
}

}  // namespace

TEST_CASE("distance, gradient and sign of a box in a general pose are those in closed form") {
  const RigidTransform X = placement();
  const SignedDistance surface(test::moved(test::box(kHalf), X));
  test::Draw draw(7);
  int features[3] = {0, 0, 0}, inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3 p =
        1.8 * Vector3(draw(-1, 1) * kHalf.x(), draw(-1, 1) * kHalf.y(), draw(-1, 1) * kHalf.z());
    const SurfaceQuery query = surface.query(X * p);
    // Rounding of coordinates of 0.05: 7e-18 each, and a dozen operations.
    CHECK(std::abs(query.distance - box_distance(p)) < 1e-15);
    CHECK(std::abs(query.gradient.norm() - 1.0) < 1e-12);
    CHECK(std::abs(box_distance(X.inverse() * query.closest_point(X * p))) < 1e-15);
    CHECK(!query.on_border);
    ++features[static_cast<int>(query.feature)];
    inside += query.distance < 0.0;
  }
  CHECK(features[0] > 100);
  CHECK(features[1] > 100);
  CHECK(features[2] > 100);
  CHECK(inside > 100);
}

TEST_CASE(
    "gradient and Hessian are the derivatives of the distance, on faces, edges and vertices") {
  const SignedDistance surface(wavy());
  test::Draw draw(29);
  constexpr double kStep = 1e-8;
  int features[3] = {0, 0, 0};
  for (int i = 0; i < 600; ++i) {
    const Vector3 p(draw(-0.01, 0.018), draw(-0.006, 0.012), draw(-0.02, 0.006));
    const SurfaceQuery query = surface.query(p);
    Matrix3 hessian;
    Vector3 gradient;
    bool smooth = std::abs(query.distance) > 2e-4;
    for (int k = 0; k < 3; ++k) {
      const auto ahead = surface.query(p + kStep * Vector3::Unit(k)),
                 behind = surface.query(p - kStep * Vector3::Unit(k));
      smooth = smooth && ahead.feature == query.feature && behind.feature == query.feature &&
               (ahead.gradient - behind.gradient).norm() < 1e-3;
      gradient[k] = (ahead.distance - behind.distance) / (2.0 * kStep);
      hessian.col(k) = (ahead.gradient - behind.gradient) / (2.0 * kStep);
    }
    if (!smooth) continue;
    ++features[static_cast<int>(query.feature)];
    // Rounding of the distance, 1e-17, over the step: 1e-9.
    CHECK((gradient - query.gradient).norm() < 1e-8);
    // Rounding of the gradient: 1e-17 / |φ| >= 2e-4, over the step: 5e-6; third derivatives 1/φ²
    // times the step squared: 3e-9.
    CHECK((hessian - query.hessian()).norm() < 5e-5 * (1.0 + query.hessian().norm()));
  }
  CHECK(features[0] > 20);
  CHECK(features[1] > 20);
  CHECK(features[2] > 20);
}

TEST_CASE("penetrates() is query() where the distance is negative, and false elsewhere") {
  const TriangleMesh meshes[] = {wavy(), test::reversed(wavy()),
                                 test::moved(test::box(kHalf), placement()), test::sphere(0.02, 4)};
  for (const auto& mesh : meshes) {
    const SignedDistance surface(mesh);
    test::Draw draw(31);
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      // Near the surface mostly, and far off now and then, beyond the octree too.
      const double reach = i % 10 == 0 ? 0.2 : i % 97 == 0 ? 5.0 : 0.03;
      const Vector3 p(draw(-reach, reach), draw(-reach, reach), draw(-reach, reach));
      const SurfaceQuery expected = surface.query(p);
      SurfaceQuery found;
      // On the surface itself the sign is a matter of rounding.
      if (std::abs(expected.distance) < 1e-15) continue;
      REQUIRE(surface.penetrates(p, found) == (expected.distance < 0.0));
      if (expected.distance < 0.0) check_same(found, expected), ++inside;
    }
    CHECK(inside > 100);
  }
}

TEST_CASE("the open border is told from the rest, and the sign there is that of its face") {
  const auto flat =
      test::patch(0.0, 0.0, 0.01, 8, [](double x, double) { return 0.2 * x + 0.003; });
  const SignedDistance surface(flat);
  const auto above = surface.query({0.002, 0.02, 0.001}),
             below = surface.query({0.002, -0.02, 0.001});
  CHECK(above.distance > 0.0);
  CHECK(below.distance < 0.0);
  CHECK(!above.on_border);
  CHECK(!below.on_border);
  const auto side_above = surface.query({0.002, 0.02, 0.015}),
             side_below = surface.query({0.002, -0.02, 0.015});
  CHECK(side_above.on_border);
  CHECK(side_below.on_border);
  CHECK(side_above.distance > 0.0);
  CHECK(side_below.distance < 0.0);
  CHECK(surface.query({0.03, 0.02, 0.03}).on_border);
}

TEST_CASE("on the surface the gradient is the pseudonormal and the Hessian is finite") {
  const SignedDistance surface(test::box(kHalf));
  const SurfaceQuery corner = surface.query(kHalf);
  CHECK(corner.distance == 0.0);
  CHECK((corner.gradient - Vector3::Constant(1.0 / std::sqrt(3.0))).norm() < 1e-12);
  CHECK(corner.hessian() == Matrix3::Zero());
}

TEST_CASE("a mesh that is not well formed is refused") {
  CHECK_THROWS_WITH_AS(SignedDistance(TriangleMesh{}), "signed distance: the mesh has no faces",
                       std::invalid_argument);
}
