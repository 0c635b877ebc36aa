// SPDX-License-Identifier: Apache-2.0
// A scalar field on a uniform grid as a tensor product of cubic B-splines: C2 everywhere inside.
//
//   s(p) = Σ c_ijk β(u−i) β(v−j) β(w−k),   (u, v, w) = (p − origin)/spacing,
//
// β the centred cubic B-spline. interpolate() finds the coefficients of the spline that passes
// through samples at the nodes; its error against a smooth function falls with spacing⁴.
//
// Coefficients are single precision, sums double: half the memory to fetch where fetching is what
// costs. The spline is then within 6e-8 of the samples' size of the interpolant, and as smooth:
// rounded coefficients are coefficients.
//
// Source: Unser 1999, IEEE Signal Process Mag 16(6):22–38, doi:10.1109/79.799930 (recursive
// prefilter, mirror ends).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "condyle/common/types.hpp"

namespace condyle::geometry {

/// Value, gradient and Hessian of a field at a point.
struct FieldValue {
  double value = 0.0;                  ///< [m]
  Vector3 gradient = Vector3::Zero();  ///< [–]
  Matrix3 hessian = Matrix3::Zero();   ///< [1/m]
};

/// The four weights of the nodes i−1 … i+2 at fraction t in [0, 1) of cell i, and their derivatives
/// in t.
struct CubicWeights {
  std::array<double, 4> w, d1, d2;
};
CubicWeights cubic_weights(double t);

/// Nodes are stored x fastest: index = i + nodes[0]·(j + nodes[1]·k).
struct CubicSplineGrid {
  std::array<int, 3> nodes{0, 0, 0};
  Vector3 origin = Vector3::Zero();  ///< of node (0, 0, 0) [m]
  double spacing = 0.0;              ///< h [m]
  std::vector<float> coefficients;   ///< c [m]

  std::size_t count() const {
    return static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) *
           static_cast<std::size_t>(nodes[2]);
  }
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(nodes[0]) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(nodes[1]) * static_cast<std::size_t>(k));
  }
  Vector3 node_position(int i, int j, int k) const { return origin + spacing * Vector3(i, j, k); }

  /// The cell that holds p and the fractions in it; false where the 4×4×4 stencil does not fit in
  /// the grid.
  bool locate(const Vector3& p, std::array<int, 3>& cell, Vector3& fraction) const;

  /// Sets the coefficients so that the spline passes through `samples`, one a node in the nodes'
  /// order.
  /// @pre at least 2 nodes along each axis.
  void interpolate(std::vector<double> samples);

  /// @pre locate(p) holds.
  double value(const Vector3& p) const;
  FieldValue evaluate(const Vector3& p) const;
};

}  // namespace condyle::geometry
