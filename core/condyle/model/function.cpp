// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/function.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace condyle::model {
namespace {

constexpr std::size_t kDerivatives = 3;

// Σ c_k x^k and its derivatives by Horner's rule carried along: after all coefficients y[j] holds
// the j-th derivative / j!.
template <typename Coefficients>
std::array<double, 4> polynomial_value(const Coefficients& coefficients, double x) {
  std::array<double, 4> y{};
  for (std::size_t k = coefficients.size(); k-- > 0;) {
    for (std::size_t j = kDerivatives; j > 0; --j) y[j] = y[j] * x + y[j - 1];
    y[0] = y[0] * x + coefficients[k];
  }
  y[2] *= 2.0;
  y[3] *= 6.0;
  return y;
}

// Newton's third divided difference over four knots from `first`: a sixth of the third derivative
// of the cubic through them.
double third_difference(const std::vector<double>& x, const std::vector<double>& slope,
                        std::size_t first) {
  const auto second = [&](std::size_t i) { return (slope[i + 1] - slope[i]) / (x[i + 2] - x[i]); };
  return (second(first + 1) - second(first)) / (x[first + 3] - x[first]);
}

// σ_i = S''(x_i)/6 at the knots: S' is continuous inside, and the ends follow the kind of spline.
// Without pivoting, as in the source: the rows inside dominate their diagonal, and the end rows
// (−h, h) keep a pivot of size h or more.
std::vector<double> sixth_of_curvature(FunctionKind kind, const std::vector<double>& x,
                                       const std::vector<double>& h,
                                       const std::vector<double>& slope) {
  const std::size_t last = x.size() - 1;
  std::vector<double> diagonal(x.size()), sigma(x.size(), 0.0);
  std::vector<double> off(h);  // symmetric but for a natural spline's end rows
  for (std::size_t i = 1; i < last; ++i) {
    diagonal[i] = 2.0 * (h[i - 1] + h[i]);
    sigma[i] = slope[i] - slope[i - 1];
  }
  if (kind == FunctionKind::kNaturalCubicSpline) {
    // σ = 0 at both ends: their columns drop out, so that the rows inside no longer see them.
    diagonal[0] = diagonal[last] = 1.0;
    off[0] = off[last - 1] = 0.0;
  } else {
    // The first and last pieces take the third derivative of the cubics through the four knots at
    // each end; with three knots that is 0, and the spline is one parabola.
    diagonal[0] = -h[0];
    diagonal[last] = -h[last - 1];
    if (x.size() > 3) {
      sigma[0] = h[0] * h[0] * third_difference(x, slope, 0);
      sigma[last] = -h[last - 1] * h[last - 1] * third_difference(x, slope, last - 3);
    }
  }
  for (std::size_t i = 1; i <= last; ++i) {
    const double factor = off[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * off[i - 1];
    sigma[i] -= factor * sigma[i - 1];
  }
  sigma[last] /= diagonal[last];
  for (std::size_t i = last; i-- > 0;) sigma[i] = (sigma[i] - off[i] * sigma[i + 1]) / diagonal[i];
  return sigma;
}

void require_knots(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() < 2) {
    throw std::invalid_argument("function: x has " + std::to_string(x.size()) +
                                " knots; a spline needs at least 2");
  }
  if (x.size() != y.size()) {
    throw std::invalid_argument("function: x has " + std::to_string(x.size()) + " knots, y has " +
                                std::to_string(y.size()) + "; they must be as many");
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      throw std::invalid_argument("function: knot " + std::to_string(i) + " is (" +
                                  std::to_string(x[i]) + ", " + std::to_string(y[i]) +
                                  "); it must be finite");
    }
    if (i > 0 && !(x[i] > x[i - 1])) {
      throw std::invalid_argument("function: x[" + std::to_string(i) + "] is " +
                                  std::to_string(x[i]) + " after " + std::to_string(x[i - 1]) +
                                  "; knots must ascend");
    }
  }
}

}  // namespace

Function Function::linear(double slope, double intercept) {
  Function f;
  f.coefficients_ = {intercept, slope};
  return f;
}

Function Function::polynomial(std::vector<double> coefficients) {
  Function f;
  f.kind_ = FunctionKind::kPolynomial;
  f.coefficients_ = std::move(coefficients);
  return f;
}

Function Function::spline(FunctionKind kind, std::vector<double> x, std::vector<double> y) {
  if (kind == FunctionKind::kLinear || kind == FunctionKind::kPolynomial) {
    throw std::invalid_argument("function: a linear or polynomial function has no knots");
  }
  require_knots(x, y);
  const std::size_t intervals = x.size() - 1;
  std::vector<double> h(intervals), slope(intervals), sigma(x.size(), 0.0);
  for (std::size_t i = 0; i < intervals; ++i) {
    h[i] = x[i + 1] - x[i];
    slope[i] = (y[i + 1] - y[i]) / h[i];
  }
  if (kind != FunctionKind::kPiecewiseLinear && intervals > 1) {
    sigma = sixth_of_curvature(kind, x, h, slope);
  }
  Function f;
  f.kind_ = kind;
  f.cubic_.resize(intervals);
  for (std::size_t i = 0; i < intervals; ++i) {
    f.cubic_[i] = {slope[i] - h[i] * (sigma[i + 1] + 2.0 * sigma[i]), 3.0 * sigma[i],
                   (sigma[i + 1] - sigma[i]) / h[i]};
  }
  f.x_ = std::move(x);
  f.y_ = std::move(y);
  return f;
}

std::array<double, 4> Function::operator()(double x) const {
  if (cubic_.empty()) return polynomial_value(coefficients_, x);
  if (x < x_.front()) {
    const double slope = cubic_.front()[0];
    return {y_.front() + slope * (x - x_.front()), slope, 0.0, 0.0};
  }
  const bool beyond = x > x_.back();
  const double inside = beyond ? x_.back() : x;
  // The interval to the right of a knot; the last knot belongs to the interval before it.
  const auto next = std::upper_bound(x_.begin() + 1, x_.end() - 1, inside);
  const auto i = static_cast<std::size_t>(next - x_.begin()) - 1;
  const auto& c = cubic_[i];
  const std::array<double, 4> value =
      polynomial_value(std::array{y_[i], c[0], c[1], c[2]}, inside - x_[i]);
  if (!beyond) return value;
  return {y_.back() + value[1] * (x - x_.back()), value[1], 0.0, 0.0};
}

}  // namespace condyle::model
