// SPDX-License-Identifier: Apache-2.0
// A smooth (C2) signed-distance field of a body's surface, built once and cheap to evaluate.
//
//   φ(p) ≈ s(p), a tensor-product cubic spline through samples of the signed distance (negative
// inside).
//
// Near the surface (−band_inside … band_outside, and six nodes more) every node holds an exact
// sample; further away the nodes are filled from a four times coarser spline of exact samples, so
// that the field is one C2 function over its whole box. Error near a smooth surface falls with
// spacing⁴; a faceted one adds what the spline smooths away of its edges.
//
// Open surfaces. Where the closest point lies on the open border, the sign of the distance flips
// across the surface's continuation and φ jumps. There the sampler gives the smooth continuation
// instead, φ = n·(p − closest) with n the border's normal: it meets the distance with the same
// value and gradient, so nothing rings into the valid region. Nodes keep a flag; a point counts as
// "on the border" where the trilinear interpolant of its cell's eight flags is at least ½. That
// places the limit within half a spacing of the true one, and costs nothing where no corner is
// flagged.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "condyle/geometry/cubic_spline_grid.hpp"

namespace condyle::geometry {

struct DistanceFieldSettings {
  /// h [m]. Finer follows the mesh's facets better, and costs time to build and memory:
  /// tests/benchmarks/README.md has the error over spacing on a femoral component meshed at 0.85
  /// mm.
  /// 0.3 mm is the coarsest that holds 0.2 % there.
  double spacing = 0.3e-3;
  /// The grid reaches this far beyond the surface's bounding box [m], and ten nodes more; beyond it
  /// a point is outside.
  double margin = 1e-3;
  /// The field is to be exact this far out [m]: only its sign matters there.
  double band_outside = 0.5e-3;
  /// ... and this deep [m]: the implausible depth.
  double band_inside = 2e-3;
};

/// The signed distance at a point.
struct DistanceSample {
  double value = 0.0;      ///< [m], negative inside; the smooth continuation where on_border
  bool on_border = false;  ///< the closest point lies on the surface's open border
};
/// Must be safe to call from many threads.
using DistanceSampler = std::function<DistanceSample(const Vector3&)>;

class DistanceField {
 public:
  /// Value of a point that lies outside the box.
  static constexpr double kOutside = std::numeric_limits<double>::infinity();

  /// Samples the distance and fits the spline. Same bytes for any number of threads.
  /// @param lowest, highest corners of the surface's bounding box [m].
  /// @param threads 0: all.
  /// @throws std::invalid_argument naming a setting that is out of range, or a box whose grid would
  /// exceed 60 million nodes
  ///         (360 MB).
  static DistanceField build(const Vector3& lowest, const Vector3& highest,
                             const DistanceFieldSettings& settings, const DistanceSampler& sampler,
                             int threads);

  /// From stored parts; for the cache. @throws std::invalid_argument if their sizes disagree.
  DistanceField(CubicSplineGrid spline, std::vector<std::uint8_t> border_nodes);

  bool contains(const Vector3& p) const;

  /// φ(p), or kOutside beyond the box.
  double value(const Vector3& p) const;

  /// φ, ∇φ, ∇²φ; value kOutside and zero derivatives beyond the box.
  FieldValue evaluate(const Vector3& p) const;

  /// Whether p is closest to the open border. False beyond the box.
  bool on_border(const Vector3& p) const;

  const CubicSplineGrid& spline() const { return spline_; }
  /// One flag a node, in the spline's order.
  const std::vector<std::uint8_t>& border_nodes() const { return border_nodes_; }
  /// One flag a cell (i, j, k) at the index of its lowest node: any of its eight nodes is flagged.
  const std::vector<std::uint8_t>& border_cells() const { return border_cells_; }

 private:
  CubicSplineGrid spline_;
  std::vector<std::uint8_t> border_nodes_;
  std::vector<std::uint8_t> border_cells_;
};

}  // namespace condyle::geometry
