// SPDX-License-Identifier: Apache-2.0
// Natural interpolating splines of several columns over one axis, cubic or quintic.
//
//   minimise  ∫ (d^m s / dx^m)² dx   subject to   s(x_i) = y_i,      m = 2 (cubic), 3 (quintic)
//
// The minimiser is a polynomial of degree 2m − 1 between knots, has 2m − 2 continuous derivatives, and its derivatives of
// order m to 2m − 2 vanish at both ends; beyond them it is the polynomial of degree m − 1 that continues it. Data on a
// polynomial of degree below m come back as that polynomial.
//
// It is the generalised cross-validation spline of Woltring 1986 (Adv Eng Softw 8:104–113, GCVSPL) without smoothing: what
// OpenSim differentiates coordinates with (degree 5) and interpolates ground reactions with (degree 3).
//
// Unknown are the first m − 1 derivatives at the knots. The energy is a sum over intervals of a quadratic form in those of
// their two ends (Hermite interpolation), so its minimum is one banded positive definite system.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace condyle::numerics {

enum class SplineDegree { kCubic = 3, kQuintic = 5 };

class NaturalSpline {
 public:
  /// One knot a row, one function a column.
  using Samples = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// @param x (n) ascending knots, n ≥ 2 (cubic) or 3 (quintic). @param y (n, columns) values there.
  /// @throws std::invalid_argument for fewer knots, knots that do not ascend, another number of rows, or a value that is
  /// not finite; the message names the knot's index and value.
  NaturalSpline(SplineDegree degree, std::span<const double> x,
                const Eigen::Ref<const Samples>& y);

  SplineDegree degree() const { return order_ == 2 ? SplineDegree::kCubic : SplineDegree::kQuintic; }
  int columns() const { return columns_; }
  double first() const { return x_.front(); }
  double last() const { return x_.back(); }

  /// Derivative of every column at x; 0: the value. Allocates nothing; safe from several threads.
  /// @param derivative 0 to 5 (those above the degree are zero).
  /// @param out (columns), in units of y per (unit of x)^derivative.
  /// @throws std::invalid_argument for another derivative or length of `out`.
  void evaluate(double x, int derivative, Eigen::Ref<Eigen::VectorXd> out) const;
  Eigen::VectorXd operator()(double x, int derivative = 0) const;

 private:
  template <int Order>
  void solve();
  double* node(std::size_t knot, int derivative);
  const double* node(std::size_t knot, int derivative) const;

  int order_ = 2;  ///< m
  int columns_ = 0;
  std::vector<double> x_;
  std::vector<double> nodes_;  ///< [knot][derivative 0 … m − 1][column]
};

}  // namespace condyle::numerics
