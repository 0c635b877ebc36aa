// SPDX-License-Identifier: Apache-2.0
// The point of a triangle closest to a point, and the part of the triangle that it lies on.
#pragma once

#include <cstdint>

#include "condyle/common/types.hpp"

namespace condyle::geometry {

struct Triangle {
  Vector3 a, b, c;
};

/// Part of a triangle: its inside, the side that starts at corner k (0, 1, 2), or corner k.
enum class TrianglePart : std::uint8_t {
  kInside,
  kSide0,
  kSide1,
  kSide2,
  kCorner0,
  kCorner1,
  kCorner2
};

struct ClosestPoint {
  Vector3 point;
  TrianglePart part;
};

/// The closest point of triangle abc to p, by the Voronoi regions of the triangle's parts.
/// A triangle without area answers with one of its sides or corners.
/// Source: Ericson 2005, Real-Time Collision Detection, section 5.1.5.
inline ClosestPoint closest_point(const Vector3& p, const Triangle& t) {
  const Vector3 ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {t.a, TrianglePart::kCorner0};

  const Vector3 bp = p - t.b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {t.b, TrianglePart::kCorner1};

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) {
    return {t.a + (d1 / (d1 - d3)) * ab, TrianglePart::kSide0};
  }

  const Vector3 cp = p - t.c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {t.c, TrianglePart::kCorner2};

  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6) {
    return {t.a + (d2 / (d2 - d6)) * ac, TrianglePart::kSide2};
  }

  const double va = d3 * d6 - d5 * d4, d43 = d4 - d3, d56 = d5 - d6;
  if (va <= 0.0 && d43 >= 0.0 && d56 >= 0.0 && d43 + d56 > 0.0) {
    return {t.b + (d43 / (d43 + d56)) * (t.c - t.b), TrianglePart::kSide1};
  }

  // A sliver whose area drowns in rounding can pass all the tests above: its sides are as good as
  // its inside.
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return {t.a, TrianglePart::kCorner0};
  const double scale = 1.0 / sum;
  return {t.a + (vb * scale) * ab + (vc * scale) * ac, TrianglePart::kInside};
}

}  // namespace condyle::geometry
