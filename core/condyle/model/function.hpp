// SPDX-License-Identifier: Apache-2.0
// A function of one coordinate: constant, linear, polynomial or piecewise cubic, with its first
// three derivatives.
//
//   kind               text in a model file      what it is
//   linear             "linear"                  y = slope·x + intercept
//   polynomial         "polynomial"              y = Σ c_k x^k, c_0 first
//   natural spline     "natural_cubic_spline"    second derivative zero at both ends
//   SIMM spline        "simm_spline"             OpenSim's SimmSpline: the third derivatives of the
//                                                first and last pieces are those of the cubics
//                                                through the four knots at each end
//   piecewise linear   "piecewise_linear"        at a knot, the slope is that of the piece after it
//
// Beyond its knots a spline goes straight on with its end slope. Two knots make a line, three knots
// of a SIMM spline a parabola.
//
// Source of the SIMM spline: Forsythe, Malcolm & Moler 1977, Computer Methods for Mathematical
// Computations, ch. 4.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace condyle::model {

enum class FunctionKind {
  kLinear,
  kPolynomial,
  kNaturalCubicSpline,
  kSimmSpline,
  kPiecewiseLinear
};

class Function {
 public:
  /// Zero everywhere.
  Function() = default;

  static Function linear(double slope, double intercept = 0.0);
  static Function polynomial(std::vector<double> coefficients);
  /// @param x ascending knots, at least two.
  /// @throws std::invalid_argument for fewer, another number of y, or knots that do not ascend.
  static Function spline(FunctionKind kind, std::vector<double> x, std::vector<double> y);

  /// Value and first, second and third derivative at x.
  std::array<double, 4> operator()(double x) const;

  FunctionKind kind() const { return kind_; }
  /// Polynomial coefficients (linear: intercept, slope); empty for splines.
  const std::vector<double>& coefficients() const { return coefficients_; }
  /// Knots of a spline.
  const std::vector<double>& x() const { return x_; }
  const std::vector<double>& y() const { return y_; }

 private:
  FunctionKind kind_ = FunctionKind::kLinear;
  std::vector<double> coefficients_;
  std::vector<double> x_, y_;
  std::vector<std::array<double, 3>> cubic_;  ///< per interval: coefficients of h, h², h³
};

}  // namespace condyle::model
