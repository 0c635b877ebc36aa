// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>

#include "condyle/model/cylinder_wrap.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

constexpr double kRadius = 0.0274;

Vector3 polar(double rho, double angle, double z) {
  return {rho * std::cos(angle), rho * std::sin(angle), z};
}

/// Two points whose straight line pierces a cylinder of radius kRadius.
std::array<Vector3, 2> piercing(test::Draw& draw) {
  const double at = draw(-3.0, 3.0), a = draw(1.3, 3.0) * kRadius, b = draw(1.3, 3.0) * kRadius;
  const double free = std::acos(kRadius / a) + std::acos(kRadius / b);
  const double apart = draw(free + 0.05, std::numbers::pi - 0.02);
  const int turn = draw(0.0, 1.0) < 0.5 ? 1 : -1;
  return {polar(a, at, draw(-0.05, 0.05)), polar(b, at + turn * apart, draw(-0.05, 0.05))};
}

CylinderLine wrapped(const Cylinder& cylinder, const Vector3& a, const Vector3& b) {
  const CylinderDecision decision = decide_wrap(cylinder, a, b);
  REQUIRE(decision.goes_around());
  return line_around(cylinder.radius, a, b, decision.turn);
}

const Cylinder kAll = make_cylinder(kRadius, 0.7, "all", "test");

}  // namespace

TEST_CASE("planar wraps and helices have their closed forms [oracle]") {
  const double rho_a = 0.051, rho_b = 0.043, apart = 2.6;
  const double climb = 0.037;
  const double s = std::sqrt(rho_a * rho_a - kRadius * kRadius) +
                   std::sqrt(rho_b * rho_b - kRadius * kRadius) +
                   kRadius * (apart - std::acos(kRadius / rho_a) - std::acos(kRadius / rho_b));
  const Vector3 a = polar(rho_a, 0.4, 0.011);
  CHECK(wrapped(kAll, a, polar(rho_b, 0.4 + apart, 0.011)).length ==
        doctest::Approx(s).epsilon(1e-14));
  CHECK(wrapped(kAll, a, polar(rho_b, 0.4 - apart, 0.011 + climb)).length ==
        doctest::Approx(std::hypot(s, climb)).epsilon(1e-14));
  // Ends a part in 1e9 off the surface: their tangents are short, and s differs from the arc by
  // (2e-9)^1.5 r.
  const double rho = kRadius * (1.0 + 1e-9);
  const CylinderLine helix = wrapped(kAll, polar(rho, -1.1, -0.02), polar(rho, 1.3, 0.03));
  CHECK(std::abs(helix.length - std::hypot(kRadius * 2.4, 0.05)) < 1e-14);
  CHECK(std::abs(helix.angle - 2.4) < 2e-4);
}

TEST_CASE("the line is tangent where it touches, and no other line around is shorter [property]") {
  test::Draw draw(51);
  for (int k = 0; k < 200; ++k) {
    const auto [a, b] = piercing(draw);
    const CylinderLine line = wrapped(kAll, a, b);
    const Vector3 to_a = (a - line.tangent_a).normalized(),
                  to_b = (b - line.tangent_b).normalized();
    // Unit gradients along the tangents; 1e-16 over a tangent's length of 1e-2.
    CHECK((to_a - line.by_a).norm() < 1e-12);
    CHECK((to_b - line.by_b).norm() < 1e-12);
    CHECK(std::abs(line.by_a.norm() - 1.0) < 1e-14);
    for (const Vector3& t : {line.tangent_a, line.tangent_b}) {
      CHECK(std::abs(std::hypot(t.x(), t.y()) - kRadius) < 1e-16);
    }
    const double parts = (a - line.tangent_a).norm() + line.arc + (b - line.tangent_b).norm();
    CHECK(std::abs(parts - line.length) < 1e-15);
    CHECK(line.length > (b - a).norm());
    // The touching points slid along the axis: tangents and helix between them, longer.
    const Vector3 slide_a = draw(-0.004, 0.004) * Vector3::UnitZ();
    const Vector3 slide_b = draw(-0.004, 0.004) * Vector3::UnitZ();
    const double rise = (line.tangent_b + slide_b - line.tangent_a - slide_a).z();
    const double other = (a - line.tangent_a - slide_a).norm() +
                         (b - line.tangent_b - slide_b).norm() +
                         std::hypot(kRadius * line.angle, rise);
    CHECK(other >= line.length - 1e-16);
  }
}

TEST_CASE("gradient and curvature are those of the length [derivative]") {
  test::Draw draw(52);
  for (int k = 0; k < 50; ++k) {
    const auto [a, b] = piercing(draw);
    const int turn = decide_wrap(kAll, a, b).turn;
    const CylinderLine line = line_around(kRadius, a, b, turn);
    const CylinderCurvature c = line_curvature(kRadius, a, b, line);
    CHECK((c.aa - c.aa.transpose()).norm() < 1e-12);
    const double h = 1e-6;
    for (int i = 0; i < 6; ++i) {
      Vector3 da = Vector3::Zero(), db = Vector3::Zero();
      (i < 3 ? da : db)[i % 3] = h;
      const CylinderLine ahead = line_around(kRadius, a + da, b + db, turn);
      const CylinderLine behind = line_around(kRadius, a - da, b - db, turn);
      const double slope = i < 3 ? line.by_a[i] : line.by_b[i - 3];
      // Tangents of 2 cm and more: third derivatives ~ 1/d² = 3e3, fourth ~ 1e5; rounding 1e-17/h.
      CHECK(std::abs((ahead.length - behind.length) / (2 * h) - slope) < 3e-9);
      const Vector3 by_a = (ahead.by_a - behind.by_a) / (2 * h),
                    by_b = (ahead.by_b - behind.by_b) / (2 * h);
      const Vector3 a_row = i < 3 ? c.aa.col(i) : c.ab.col(i - 3);
      const Vector3 b_row = i < 3 ? Vector3(c.ab.row(i)) : Vector3(c.bb.col(i - 3));
      CHECK((by_a - a_row).norm() < 1e-5);
      CHECK((by_b - b_row).norm() < 1e-5);
    }
    CHECK(c.ab.norm() > 1e-3);
  }
}

TEST_CASE(
    "length and gradient are continuous through touch-down, and the line stays on its side "
    "[property]") {
  // A segment past the cylinder at distance r + gap from its axis, oblique to it.
  const auto ends = [](double gap) -> std::array<Vector3, 2> {
    return {Vector3(kRadius + gap, -0.05, -0.013), Vector3(kRadius + gap, 0.07, 0.024)};
  };
  for (const char* quadrant : {"all", "x"}) {
    const Cylinder cylinder = make_cylinder(kRadius, 0.7, quadrant, "test");
    for (const double depth : {1e-4, 1e-6, 1e-8, 1e-12}) {
      CAPTURE(depth);
      CHECK(!decide_wrap(cylinder, ends(depth)[0], ends(depth)[1]).goes_around());
      const auto [a, b] = ends(-depth);
      const CylinderLine line = wrapped(cylinder, a, b);
      // The line bends by θ ~ depth (1/0.05 + 1/0.07): longer by second order, turned by first.
      CHECK(line.length >= (b - a).norm() - 1e-16);
      CHECK(line.length - (b - a).norm() < 20 * depth * depth + 1e-16);
      CHECK((line.by_b - (b - a).normalized()).norm() < 40 * depth + 1e-15);
      CHECK((line.by_a + (b - a).normalized()).norm() < 40 * depth + 1e-15);
      CHECK(line.tangent_a.x() > 0.0);
    }
  }
}

TEST_CASE("spinning about the axis, mirroring and reversing change nothing [property]") {
  test::Draw draw(53);
  for (int k = 0; k < 100; ++k) {
    const auto [a, b] = piercing(draw);
    const CylinderLine line = wrapped(kAll, a, b);
    const Matrix3 spin = Eigen::AngleAxisd(draw(-3.0, 3.0), Vector3::UnitZ()).toRotationMatrix();
    const CylinderLine spun = wrapped(kAll, spin * a, spin * b);
    CHECK(std::abs(spun.length - line.length) < 1e-15);
    CHECK((spun.by_a - spin * line.by_a).norm() < 1e-13);
    const CylinderLine back = wrapped(kAll, b, a);
    CHECK(std::abs(back.length - line.length) < 1e-16);
    CHECK((back.by_b - line.by_a).norm() < 1e-14);
    const Vector3 mirror(1.0, -1.0, 1.0);
    const CylinderLine mirrored = wrapped(kAll, a.cwiseProduct(mirror), b.cwiseProduct(mirror));
    CHECK(std::abs(mirrored.length - line.length) < 1e-15);
  }
}

TEST_CASE("a quadrant decides the side, OpenSim's way [property]") {
  const Cylinder x = make_cylinder(0.03, 0.4, "x", "test"),
                 minus_x = make_cylinder(0.03, 0.4, "-x", "test");
  struct Case {
    const char* what;
    Vector3 a, b;
    CylinderContact on_x, on_minus_x;
  };
  const Case cases[] = {
      {"pierced on the +x half",
       {0.01, -0.06, 0.01},
       {0.02, 0.07, -0.02},
       CylinderContact::kPierces,
       CylinderContact::kPierces},
      {"beyond on the +x side",
       {0.04, -0.06, 0.01},
       {0.05, 0.07, -0.02},
       CylinderContact::kMisses,
       CylinderContact::kForced},
      {"across, passing on +x",
       {-0.001, -0.09, 0.01},
       {0.09, 0.04, 0.0},
       CylinderContact::kMisses,
       CylinderContact::kForced},
      {"across, passing on −x",
       {0.001, -0.09, 0.01},
       {-0.09, 0.04, 0.0},
       CylinderContact::kForced,
       CylinderContact::kMisses},
  };
  for (const Case& it : cases) {
    CAPTURE(it.what);
    const CylinderDecision right = decide_wrap(x, it.a, it.b),
                           left = decide_wrap(minus_x, it.a, it.b);
    CHECK(right.contact == it.on_x);
    CHECK(left.contact == it.on_minus_x);
    // Forced or not, the middle of the arc is on the wanted half.
    for (const auto& [cylinder, decision, sign] :
         {std::tuple(x, right, 1), std::tuple(minus_x, left, -1)}) {
      if (!decision.goes_around()) continue;
      const CylinderLine line = line_around(cylinder.radius, it.a, it.b, decision.turn);
      const Vector3 middle =
          Eigen::AngleAxisd(0.5 * line.angle * decision.turn, Vector3::UnitZ()) * line.tangent_a;
      CHECK(sign * middle.x() > 0.0);
    }
  }
  // The same along y, for a turned case.
  const Cylinder y = make_cylinder(0.03, 0.4, "-y", "test");
  CHECK(decide_wrap(y, {-0.06, 0.04, 0.0}, {0.07, 0.05, 0.0}).contact == CylinderContact::kForced);
  CHECK(decide_wrap(y, {-0.06, -0.04, 0.0}, {0.07, -0.05, 0.0}).contact ==
        CylinderContact::kMisses);
}

TEST_CASE("no wrap from inside the radius, beyond both ends, or along the axis [property]") {
  const Cylinder c = make_cylinder(0.03, 0.1, "all", "test");
  CHECK(decide_wrap(c, {0.029, 0.0, 0.0}, {-0.06, 0.01, 0.0}).contact == CylinderContact::kInside);
  CHECK(decide_wrap(c, {0.06, 0.01, 0.0}, {0.0, -0.029, 0.0}).contact == CylinderContact::kInside);
  CHECK(decide_wrap(c, {0.06, 0.001, 0.04}, {-0.06, 0.001, 0.04}).contact ==
        CylinderContact::kPierces);
  CHECK(!decide_wrap(c, {0.06, 0.001, 0.06}, {-0.06, 0.001, 0.06}).goes_around());
  // One tangent point on the cylinder is enough.
  CHECK(decide_wrap(c, {0.06, 0.001, 0.06}, {-0.06, 0.001, 0.02}).goes_around());
  CHECK(!decide_wrap(c, {0.06, 0.001, -0.03}, {0.06, 0.001, 0.03}).goes_around());
}

TEST_CASE("a cylinder that cannot be is refused, naming owner, field and value [error]") {
  CHECK_THROWS_WITH_AS(make_cylinder(0.0, 0.1, "all", "muscle 'm'"),
                       "muscle 'm': radius is 0.000000: must be finite and above 0 [m]",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_cylinder(0.02, 0.1, "+x", "muscle 'm'"),
                       "muscle 'm': quadrant is '+x': must be all, x, -x, y, -y, z or -z",
                       std::invalid_argument);
}
