// SPDX-License-Identifier: Apache-2.0
// A batch of points and where they lie in the field's grid, for the fast contact's kernels. Included
// by kernel compilations only; everything is static (see fast_kernel_body.hpp).
#pragma once

#include "condyle/contact/fast_kernel.hpp"
#include "condyle/contact/fast_vector.hpp"

namespace condyle::contact::fast {
namespace {

/// Points are treated in batches, one stage of the work after the other, so that the many
/// independent short chains of a stage overlap in the processor; a point at a time would wait for
/// its own latencies.
constexpr int kBatch = 32;

struct Points {
  alignas(64) double q[3][kBatch];  ///< in F [m]
  alignas(64) float t[3][kBatch];   ///< fractions in their cells
  std::int32_t base[kBatch];        ///< where their stencils begin
  int inside[kBatch / kGroup];  ///< bit l: the stencil fits in the grid; elsewhere the nearest cell
                                ///< stands in
};

/// Points are evaluated two groups at a time.
constexpr int kTwo = 2 * kGroup;
CONDYLE_INLINE int whole_twos(int count) { return (count + kTwo - 1) / kTwo * kTwo; }

/// Fills t, base and inside from q; an odd last group is doubled, so that twos are whole.
/// @param count multiple of kGroup.
CONDYLE_INLINE void locate(const FieldView& field, int count, Points& at) {
  const vd row = splat(static_cast<double>(field.row));
  const vd plane = splat(static_cast<double>(field.plane));
  const vd first = splat(static_cast<double>(1 + field.row + field.plane));
  for (int n = 0; n < count; n += kGroup) {
    vd cell[3];
    int inside = kAllLanes;
    for (int a = 0; a < 3; ++a) {
      const vd u = load(at.q[a] + n) * splat(field.inverse_spacing) + splat(field.offset[a]);
      const vd held = smaller(larger(u, splat(1.0)), splat(field.last[a]));
      inside &= equal_lanes(u, held);
      cell[a] = truncated(held);
      store_floats(at.t[a] + n, held - cell[a]);
    }
    store_integers(at.base + n, (cell[2] * plane + cell[1] * row + cell[0]) - first);
    at.inside[n / kGroup] = inside;
  }
  if (count % kTwo == 0) return;
  for (int l = 0; l < kGroup; ++l) {
    at.base[count + l] = at.base[count - kGroup + l];
    for (int a = 0; a < 3; ++a) at.t[a][count + l] = at.t[a][count - kGroup + l];
  }
}

/// Of the group of points from n on: bit l: φ may be below zero at point n + l, judged by the
/// coefficient of the node nearest to it.
CONDYLE_INLINE int near_lanes(const FieldView& field, const Points& at, int n) {
  const vd row = splat(static_cast<double>(field.row));
  const vd plane = splat(static_cast<double>(field.plane));
  vd node[3];
  for (int a = 0; a < 3; ++a) {
    const vd u = load(at.q[a] + n) * splat(field.inverse_spacing) + splat(field.offset[a] + 0.5);
    node[a] = truncated(smaller(larger(u, splat(1.0)), splat(field.last[a])));
  }
  std::int32_t index[kGroup];
  store_integers(index, node[2] * plane + node[1] * row + node[0]);
  int lanes = 0;
  for (int l = 0; l < kGroup; ++l) lanes |= field.coefficients[index[l]] < field.near ? 1 << l : 0;
  return lanes;
}

/// Of the group of points from n on: bit l: point n + l is closest to the open border, as
/// geometry::DistanceField::on_border says. @param lanes the points to ask about.
static int border_lanes(const FieldView& field, const Points& at, int n, int lanes) {
  const std::int64_t centre =
      1 + field.row + field.plane;  // from a stencil's first node to its cell
  int flagged = 0;
  for (int l = 0; l < kGroup; ++l) {
    flagged |= field.border_cells[at.base[n + l] + centre] == 0 ? 0 : 1 << l;
  }
  int result = 0;
  for (int l = 0; l < kGroup && (lanes & flagged) != 0; ++l) {
    if (((lanes & flagged) >> l & 1) == 0) continue;
    const std::int64_t low = at.base[n + l] + centre;
    const double x = at.t[0][n + l], y = at.t[1][n + l], z = at.t[2][n + l];
    double share = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
      const double w = (i ? x : 1.0 - x) * (j ? y : 1.0 - y) * (k ? z : 1.0 - z);
      if (field.border_nodes[low + i + field.row * j + field.plane * k] != 0) share += w;
    }
    if (share >= 0.5) result |= 1 << l;
  }
  return result;
}

}  // namespace
}  // namespace condyle::contact::fast
