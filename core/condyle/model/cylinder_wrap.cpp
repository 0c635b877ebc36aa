// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/cylinder_wrap.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace condyle::model {
namespace {

// An angle this little below a full turn is zero, missed by rounding at touch-down [rad].
constexpr double kTurnRounding = 1e-9;

/// The side of zero a component is on, as OpenSim counts: zero is positive.
int side(double value) { return value >= 0.0 ? 1 : -1; }

double planar_square(const Vector3& p) { return p.x() * p.x() + p.y() * p.y(); }

/// The tangent point seen from p when going around in the sense of `turn`, at the height of p.
Vector3 tangent_point(double radius, const Vector3& p, int turn) {
  const double square = planar_square(p);
  const double d = std::sqrt(std::max(square - radius * radius, 0.0));
  const double along = radius * radius / square, across = turn * radius * d / square;
  return {along * p.x() - across * p.y(), along * p.y() + across * p.x(), p.z()};
}

/// Angle from tangent point s to t in the sense of `turn`, in [0, 2π).
double turn_angle(const Vector3& s, const Vector3& t, int turn) {
  const double cross = s.x() * t.y() - s.y() * t.x(), dot = s.x() * t.x() + s.y() * t.y();
  double angle = std::atan2(turn * cross, dot);
  if (angle < 0.0) angle += 2.0 * std::numbers::pi;
  return angle > 2.0 * std::numbers::pi - kTurnRounding ? 0.0 : angle;
}

/// The two ways around, by their tangent points: [0] counter-clockwise, [1] clockwise.
struct Ways {
  std::array<Vector3, 2> at_a, at_b;
  double angle(int way) const {
    const auto w = static_cast<std::size_t>(way);
    return turn_angle(at_a[w], at_b[w], way == 0 ? 1 : -1);
  }
  int shorter() const { return angle(0) <= angle(1) ? 0 : 1; }
};

Ways both_ways(double radius, const Vector3& a, const Vector3& b) {
  return {{tangent_point(radius, a, 1), tangent_point(radius, a, -1)},
          {tangent_point(radius, b, -1), tangent_point(radius, b, 1)}};
}

/// The way whose tangent points are on the wanted side; the first end decides where it can.
int wanted_way(const Cylinder& cylinder, const Ways& ways) {
  const auto wanted = [&](const Vector3& p) {
    return side(p[cylinder.quadrant_axis]) == cylinder.quadrant_sign;
  };
  const bool a0 = wanted(ways.at_a[0]), a1 = wanted(ways.at_a[1]);
  const bool b0 = wanted(ways.at_b[0]), b1 = wanted(ways.at_b[1]);
  if (a0 != a1) return a0 ? 0 : 1;
  if (b0 != b1) return b0 ? 0 : 1;
  if (a0 || b0) return ways.shorter();
  // No tangent point is on the wanted side: the way whose arc bends further, as OpenSim has it.
  const auto bend = [&](int way) {
    return std::abs(std::remainder(ways.angle(way), 2.0 * std::numbers::pi));
  };
  return bend(0) > bend(1) ? 0 : 1;
}

}  // namespace

Cylinder make_cylinder(double radius, double length, std::string_view quadrant,
                       const std::string& owner) {
  const auto positive = [&](const char* field, double value) {
    if (value > 0.0 && std::isfinite(value)) return;
    throw std::invalid_argument(owner + ": " + field + " is " + std::to_string(value) +
                                ": must be finite and above 0 [m]");
  };
  positive("radius", radius);
  positive("length", length);
  Cylinder cylinder{radius, length, 0, 0};
  if (quadrant == "all") return cylinder;
  const bool negative = !quadrant.empty() && quadrant.front() == '-';
  const std::string_view axis = quadrant.substr(negative ? 1 : 0);
  if (axis != "x" && axis != "y" && axis != "z") {
    throw std::invalid_argument(owner + ": quadrant is '" + std::string(quadrant) +
                                "': must be all, x, -x, y, -y, z or -z");
  }
  cylinder.quadrant_axis = axis.front() - 'x';
  cylinder.quadrant_sign = negative ? -1 : 1;
  return cylinder;
}

CylinderDecision decide_wrap(const Cylinder& cylinder, const Vector3& a, const Vector3& b) {
  const double r = cylinder.radius;
  if (planar_square(a) < r * r || planar_square(b) < r * r) return {CylinderContact::kInside, 0};
  // The segment's nearest point to the axis, at fraction t; a segment along the axis has none and
  // misses.
  const Vector3 ab = b - a;
  const double run = planar_square(ab);
  const double t = run > 0.0 ? -(a.x() * ab.x() + a.y() * ab.y()) / run : 0.0;
  const Vector3 nearest = a + t * ab;
  const bool pierces = t > 0.0 && t < 1.0 && planar_square(nearest) < r * r;
  const int sign = cylinder.quadrant_sign, axis = cylinder.quadrant_axis;
  if (!pierces) {
    if (sign == 0) return {};
    const int side_a = side(a[axis]), side_b = side(b[axis]);
    const bool one_there = side_a == sign || side_b == sign;
    if (one_there && (side_a == side_b || side(nearest[axis]) == sign)) return {};
  }
  const Ways ways = both_ways(r, a, b);
  const int way = sign == 0 ? ways.shorter() : wanted_way(cylinder, ways);
  const CylinderDecision decision{pierces ? CylinderContact::kPierces : CylinderContact::kForced,
                                  way == 0 ? 1 : -1};
  // Off both ends of the cylinder there is nothing to go around.
  const CylinderLine line = line_around(r, a, b, decision.turn);
  const double half = 0.5 * cylinder.length;
  if (std::abs(line.tangent_a.z()) > half && std::abs(line.tangent_b.z()) > half) return {};
  return decision;
}

CylinderLine line_around(double radius, const Vector3& a, const Vector3& b, int turn) {
  CylinderLine line;
  const double square_a = planar_square(a), square_b = planar_square(b);
  const double d_a = std::sqrt(std::max(square_a - radius * radius, 0.0));
  const double d_b = std::sqrt(std::max(square_b - radius * radius, 0.0));
  line.tangent_a = tangent_point(radius, a, turn);
  line.tangent_b = tangent_point(radius, b, -turn);
  line.angle = turn_angle(line.tangent_a, line.tangent_b, turn);
  const double s = d_a + d_b + radius * line.angle, climb = b.z() - a.z();
  line.length = std::hypot(s, climb);
  // Unit planar gradients (p − tangent point)/d, written so that d = 0 does no harm.
  const auto planar = [&](const Vector3& p, double d, double square, int sense) {
    const double along = d / square, across = sense * radius / square;
    return Vector3(along * p.x() + across * p.y(), along * p.y() - across * p.x(), 0.0);
  };
  const double cosine = s / line.length, sine = climb / line.length;
  line.by_a = cosine * planar(a, d_a, square_a, turn) - sine * Vector3::UnitZ();
  line.by_b = cosine * planar(b, d_b, square_b, -turn) + sine * Vector3::UnitZ();
  line.tangent_a.z() = a.z() + climb * d_a / s;
  line.tangent_b.z() = b.z() - climb * d_b / s;
  line.arc = radius * line.angle / cosine;
  return line;
}

CylinderCurvature line_curvature(double radius, const Vector3& a, const Vector3& b,
                                 const CylinderLine& line) {
  const double climb = b.z() - a.z(), L = line.length, s = std::sqrt(L * L - climb * climb);
  // ∂²s/∂p² = n nᵀ/d, n the outward normal at the tangent point: an end swings about it.
  const auto swing = [&](const Vector3& p, const Vector3& tangent) -> Matrix3 {
    const double d = std::sqrt(std::max(planar_square(p) - radius * radius, 0.0));
    if (d <= 0.0) return Matrix3::Zero();
    const Vector3 n(tangent.x() / radius, tangent.y() / radius, 0.0);
    return (s / (L * d)) * n * n.transpose();
  };
  // The rest is of rank one: w wᵀ/L³ with w = ζ ∇s − s ∇ζ.
  const auto lean = [&](const Vector3& by_end, double end) {
    Vector3 w = climb * L / s * by_end;
    w.z() = -end * s;
    return w;
  };
  const Vector3 w_a = lean(line.by_a, -1.0), w_b = lean(line.by_b, 1.0);
  const double cube = 1.0 / (L * L * L);
  CylinderCurvature curvature;
  curvature.aa = swing(a, line.tangent_a) + cube * w_a * w_a.transpose();
  curvature.bb = swing(b, line.tangent_b) + cube * w_b * w_b.transpose();
  curvature.ab = cube * w_a * w_b.transpose();
  return curvature;
}

}  // namespace condyle::model
