// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>

#include "condyle/geometry/cubic_spline_grid.hpp"
#include "support/random_pose.hpp"

namespace condyle::geometry {
namespace {

// Smooth, without symmetry, of order one over lengths of order one.
double smooth(const Vector3& p) {
  return std::sin(1.3 * p.x() + 0.4 * p.y()) * std::cos(0.9 * p.y() - 0.7 * p.z()) + 0.3 * p.z();
}

CubicSplineGrid grid_of(double spacing, double (*f)(const Vector3&)) {
  CubicSplineGrid grid;
  grid.spacing = spacing;
  grid.origin = Vector3(-1.37, -1.21, -1.13);
  const int n = static_cast<int>(std::ceil(2.6 / spacing));
  grid.nodes = {n, n + 1, n + 2};
  std::vector<double> samples(grid.count());
  for (int k = 0; k < grid.nodes[2]; ++k) {
    for (int j = 0; j < grid.nodes[1]; ++j) {
      for (int i = 0; i < grid.nodes[0]; ++i) {
        samples[grid.index(i, j, k)] = f(grid.node_position(i, j, k));
      }
    }
  }
  grid.interpolate(std::move(samples));
  return grid;
}

Vector3 inner_point(
    test::Draw& draw) {  // far enough from the ends that their mirror condition has died away
  return {draw(-0.35, 0.35), draw(-0.35, 0.35), draw(-0.35, 0.35)};
}

TEST_CASE(
    "[property] weights sum to one and their derivatives to zero; each derivative is the slope of "
    "the last") {
  test::Draw draw(11);
  for (int n = 0; n < 50; ++n) {
    const double t = draw(0.01, 0.99), e = 1e-5;
    const CubicWeights at = cubic_weights(t), up = cubic_weights(t + e),
                       down = cubic_weights(t - e);
    double w = 0.0, d1 = 0.0, d2 = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      w += at.w[i], d1 += at.d1[i], d2 += at.d2[i];
      // Central differences: third derivative (≤ 3) × e²/6, plus rounding 1e-16/e.
      CHECK(std::abs((up.w[i] - down.w[i]) / (2 * e) - at.d1[i]) < 1e-10);
      CHECK(std::abs((up.d1[i] - down.d1[i]) / (2 * e) - at.d2[i]) < 1e-10);
    }
    CHECK(std::abs(w - 1.0) < 1e-15);
    CHECK(std::abs(d1) < 1e-15);
    CHECK(std::abs(d2) < 1e-14);
  }
}

TEST_CASE("[property] the spline passes through its samples") {
  const CubicSplineGrid grid = grid_of(0.2, smooth);
  for (int k = 1; k < grid.nodes[2] - 2; ++k) {
    for (int i = 1; i < grid.nodes[0] - 2; ++i) {
      const Vector3 p = grid.node_position(i, (i + k) % (grid.nodes[1] - 4) + 1, k);
      // Coefficients of size ≤ 3 rounded to float: 2⁻²⁴ × 3, averaged by weights that sum to one.
      CHECK(std::abs(grid.value(p + Vector3::Constant(1e-12)) - smooth(p)) < 2e-7);
    }
  }
}

TEST_CASE(
    "[oracle] the error against a smooth function falls with the fourth power of the spacing") {
  double last = 0.0;
  for (const double h : {0.2, 0.1, 0.05}) {
    const CubicSplineGrid grid = grid_of(h, smooth);
    test::Draw draw(12);
    double worst = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const Vector3 p = inner_point(draw);
      worst = std::max(worst, std::abs(grid.value(p) - smooth(p)));
    }
    // Halving divides by 16 in the limit; 12 leaves room for h⁶ terms and float coefficients (2e-7
    // under 1.6e-6).
    if (last > 0.0) CHECK(last / worst > (h == 0.05 ? 8.0 : 12.0));
    last = worst;
  }
  CHECK(last < 2e-6);
}

TEST_CASE(
    "[derivative] gradient and Hessian are those of the spline, inside cells and across their "
    "walls") {
  const CubicSplineGrid grid = grid_of(0.2, smooth);
  test::Draw draw(13);
  const double e = 1e-5;
  for (int n = 0; n < 200; ++n) {
    Vector3 p = inner_point(draw);
    if (n % 2 == 0) {  // on a wall between cells: differences then straddle it
      const int axis = n / 2 % 3;
      p[axis] = grid.origin[axis] +
                grid.spacing * std::round((p[axis] - grid.origin[axis]) / grid.spacing);
    }
    const FieldValue at = grid.evaluate(p);
    CHECK(at.value == doctest::Approx(grid.value(p)).epsilon(1e-14));
    for (int a = 0; a < 3; ++a) {
      const Vector3 step = e * Vector3::Unit(a);
      const FieldValue up = grid.evaluate(p + step), down = grid.evaluate(p - step);
      // Central differences: e²/6 × third derivative (≤ 10 with float noise of the coefficients), +
      // 1e-16/e.
      CHECK(std::abs((up.value - down.value) / (2 * e) - at.gradient[a]) < 1e-9);
      // The second derivative has a kink at a wall, the third a jump (≤ 10/h here): e × jump.
      CHECK(((up.gradient - down.gradient) / (2 * e) - at.hessian.col(a)).norm() < 1e-3);
      CHECK((up.hessian - down.hessian).norm() < 2e-3);  // continuous: 2e × third derivative
    }
    CHECK(at.hessian == at.hessian.transpose());
  }
}

TEST_CASE("[property] a point whose stencil does not fit is not located") {
  const CubicSplineGrid grid = grid_of(0.2, smooth);
  std::array<int, 3> cell;
  Vector3 t;
  const Vector3 middle = grid.node_position(5, 5, 5);
  CHECK(grid.locate(middle, cell, t));
  for (int a = 0; a < 3; ++a) {
    Vector3 p = middle;
    p[a] = grid.origin[a] + 0.99 * grid.spacing;
    CHECK_FALSE(grid.locate(p, cell, t));
    p[a] = grid.origin[a] + 1.01 * grid.spacing;
    CHECK(grid.locate(p, cell, t));
    const double end = grid.nodes[static_cast<std::size_t>(a)] - 2;
    p[a] = grid.origin[a] + (end + 0.01) * grid.spacing;
    CHECK_FALSE(grid.locate(p, cell, t));
    p[a] = grid.origin[a] + (end - 0.01) * grid.spacing;
    CHECK(grid.locate(p, cell, t));
  }
}

}  // namespace
}  // namespace condyle::geometry
