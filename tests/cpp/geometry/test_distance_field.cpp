// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "condyle/geometry/distance_field.hpp"
#include "support/random_pose.hpp"

namespace condyle::geometry {
namespace {

constexpr double kRadius = 0.0187;
const Vector3 kCentre(0.0031, -0.0022, 0.0014);

DistanceSample sphere(const Vector3& p) { return {(p - kCentre).norm() - kRadius, false}; }

// The part of that sphere with its polar angle about `axis` below `kCap`: open, with a circle for a
// border.
const Vector3 kAxis = Vector3(0.5, -0.7, 0.4).normalized();
constexpr double kCap = 1.3;

DistanceSample cap(const Vector3& p) {
  const Vector3 r = p - kCentre;
  const double along = r.dot(kAxis);
  const Vector3 radial = r - along * kAxis;
  if (std::atan2(radial.norm(), along) <= kCap) return {r.norm() - kRadius, false};
  const Vector3 normal = std::cos(kCap) * kAxis + std::sin(kCap) * radial.normalized();
  return {normal.dot(r - kRadius * normal), true};
}

DistanceField build(const DistanceSampler& sampler, double spacing, int threads = 1) {
  DistanceFieldSettings settings;
  settings.spacing = spacing;
  const Vector3 half = Vector3::Constant(kRadius);
  return DistanceField::build(kCentre - half, kCentre + half, settings, sampler, threads);
}

Vector3 direction(test::Draw& draw) {
  Vector3 v;
  do {
    v = Vector3(draw(-1, 1), draw(-1, 1), draw(-1, 1));
  } while (v.norm() > 1.0 || v.norm() < 0.1);
  return v.normalized();
}

TEST_CASE("[oracle] a sphere's field: value, normal and curvature near the surface") {
  const DistanceField field = build(sphere, 0.8e-3);
  test::Draw draw(21);
  for (int n = 0; n < 1000; ++n) {
    const Vector3 normal = direction(draw);
    const double depth = draw(-1.5e-3, 0.5e-3);
    const FieldValue at = field.evaluate(kCentre + (kRadius + depth) * normal);
    // Interpolation: h⁴/384·|∂⁴φ| with |∂⁴φ| ≤ 9/r³ along an axis, three axes: 4e-9 m at r = 17 mm;
    // the derivatives lose a factor of about 1/h and 10/h² of it.
    CHECK(std::abs(at.value - depth) < 1e-8);
    CHECK((at.gradient - normal).norm() < 3e-5);
    const Matrix3 curvature =
        (Matrix3::Identity() - normal * normal.transpose()) / (kRadius + depth);
    CHECK((at.hessian - curvature).norm() < 0.25);  // of 80 1/m
    CHECK_FALSE(field.on_border(kCentre + (kRadius + depth) * normal));
  }
}

TEST_CASE("[oracle] a sphere's field error falls with the fourth power of the spacing") {
  double last = 0.0;
  for (const double h : {2.4e-3, 1.2e-3}) {
    const DistanceField field = build(sphere, h);
    test::Draw draw(22);
    double worst = 0.0;
    for (int n = 0; n < 3000; ++n) {
      const double depth = draw(-1e-3, 0.5e-3);
      const Vector3 p = kCentre + (kRadius + depth) * direction(draw);
      worst = std::max(worst, std::abs(field.value(p) - depth));
    }
    if (last > 0.0) CHECK(last / worst > 11.0);  // 16 in the limit
    last = worst;
  }
}

TEST_CASE("[property] beyond the box is outside; deep inside is finite and inside") {
  const DistanceField field = build(sphere, 1.1e-3);
  const Vector3 far = kCentre + Vector3(0.05, 0.0, 0.0);
  CHECK_FALSE(field.contains(far));
  CHECK(field.value(far) == DistanceField::kOutside);
  CHECK(field.evaluate(far).gradient.isZero());
  CHECK_FALSE(field.on_border(far));
  test::Draw draw(23);
  for (int n = 0; n < 500; ++n) {
    const double radius = draw(0.0, kRadius - 3e-3);
    const double value = field.value(kCentre + radius * direction(draw));
    // Filled from the coarse spline, whose spacing is 4.4 mm; it rounds the cone at the centre by
    // about half of that.
    CHECK(std::abs(value - (radius - kRadius)) < 3e-3);
  }
}

TEST_CASE("[property] an open border does not ring into the surface, and is told to half a cell") {
  const double h = 0.7e-3;
  const DistanceField field = build(cap, h);
  test::Draw draw(24);
  int beyond = 0;
  double worst = 0.0;
  for (int n = 0; n < 20000; ++n) {
    const Vector3 normal = direction(draw);
    const double angle = std::acos(normal.dot(kAxis)), depth = draw(-1e-3, 0.3e-3);
    const Vector3 p = kCentre + (kRadius + depth) * normal;
    const double inside = (kCap - angle) * kRadius;  // distance to the border along the surface
    if (inside > 0.0) worst = std::max(worst, std::abs(field.value(p) - depth));
    // The flags' ½ level lies within a cell's half diagonal of the border.
    if (inside > 0.9 * h) CHECK_FALSE(field.on_border(p));
    if (inside < -0.9 * h && inside > -4e-3) {
      CHECK(field.on_border(p));
      ++beyond;
    }
  }
  CHECK(beyond > 500);
  // The continuation meets the distance with a jump of curvature only: error ~ h²/(8R)/4. A jump of
  // sign would be 1e-4.
  CHECK(worst < h * h / (8.0 * kRadius));
}

TEST_CASE("[property] same bytes for any number of threads") {
  const DistanceField one = build(cap, 1.3e-3, 1), three = build(cap, 1.3e-3, 3);
  REQUIRE(one.spline().coefficients.size() == three.spline().coefficients.size());
  CHECK(std::memcmp(one.spline().coefficients.data(), three.spline().coefficients.data(),
                    one.spline().coefficients.size() * sizeof(float)) == 0);
  CHECK(one.border_nodes() == three.border_nodes());
}

TEST_CASE("[error] settings out of range are refused by name") {
  const auto message = [](double spacing, double margin) -> std::string {
    DistanceFieldSettings settings;
    settings.spacing = spacing;
    settings.margin = margin;
    try {
      DistanceField::build(Vector3::Zero(), Vector3::Constant(0.3), settings, sphere, 1);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK(message(0.0, 3e-3).find("spacing is 0.000000 m: must be between") != std::string::npos);
  CHECK(message(std::nan(""), 3e-3).find("spacing is nan") != std::string::npos);
  CHECK(message(1e-3, -1.0).find("margin is -1.000000 m") != std::string::npos);
  CHECK(message(1e-4, 3e-3).find("more than 60 million nodes") != std::string::npos);
}

}  // namespace
}  // namespace condyle::geometry
