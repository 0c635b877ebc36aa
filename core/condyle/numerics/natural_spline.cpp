// SPDX-License-Identifier: Apache-2.0
#include "condyle/numerics/natural_spline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

namespace condyle::numerics {
namespace {

/// Coefficients of t^m … t^(2m−1) of the Hermite interpolant on t ∈ [0, 1], from the nodal values [y, y', y''] of the left
/// end, then of the right.
template <int Order>
Eigen::Matrix<double, Order, 2 * Order> hermite_rows() {
  Eigen::Matrix<double, Order, 2 * Order> rows;
  if constexpr (Order == 2) {
    rows << -3, -2, 3, -1,  //
        2, 1, -2, 1;
  } else {
    rows << -10, -6, -1.5, 10, -4, 0.5,  //
        15, 8, 1.5, -15, 7, -1,          //
        -6, -3, -0.5, 6, -3, 0.5;
  }
  return rows;
}

/// k (k − 1) … (k − derivative + 1)
double falling(int k, int derivative) {
  double product = 1.0;
  for (int i = 0; i < derivative; ++i) product *= k - i;
  return product;
}

/// ∫₀¹ (d^m/dt^m)² of the Hermite interpolant, a quadratic form in its 2m nodal values.
template <int Order>
Eigen::Matrix<double, 2 * Order, 2 * Order> energy() {
  Eigen::Matrix<double, Order, Order> gram;
  for (int j = 0; j < Order; ++j) {
    for (int k = 0; k < Order; ++k) {
      gram(j, k) = falling(j + Order, Order) * falling(k + Order, Order) / (j + k + 1);
    }
  }
  const auto rows = hermite_rows<Order>();
  return rows.transpose() * gram * rows;
}

/// What a derivative on t ∈ [0, 1] takes of each nodal value [y, y', y''] of an interval's two ends.
struct Weights {
  double left[3] = {0, 0, 0}, right[3] = {0, 0, 0};
};

/// d^derivative/dt^derivative of t^k
double power(int k, double t, int derivative) {
  return k < derivative ? 0.0 : falling(k, derivative) * std::pow(t, k - derivative);
}

/// The Taylor polynomial of degree m − 1 about the left end.
Weights taylor_weights(int order, double t, int derivative) {
  Weights weights;
  for (int k = 0; k < order; ++k) weights.left[k] = power(k, t, derivative) / falling(k, k);
  return weights;
}

/// The terms of degree m to 2m − 1, which meet the right end.
template <int Order>
void add_hermite_weights(double t, int derivative, Weights& weights) {
  const auto rows = hermite_rows<Order>();
  for (int j = 0; j < Order; ++j) {
    const double term = power(Order + j, t, derivative);
    for (int k = 0; k < Order; ++k) {
      weights.left[k] += term * rows(j, k);
      weights.right[k] += term * rows(j, Order + k);
    }
  }
}

void require_knots(std::span<const double> x, const Eigen::Ref<const NaturalSpline::Samples>& y,
                   std::size_t least) {
  const std::string who = "spline: ";
  if (x.size() < least) {
    throw std::invalid_argument(who + std::to_string(x.size()) + " knots: at least " +
                                std::to_string(least) + " are needed");
  }
  if (y.rows() != static_cast<Eigen::Index>(x.size())) {
    throw std::invalid_argument(who + std::to_string(y.rows()) + " rows of values for " +
                                std::to_string(x.size()) + " knots");
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::string knot = who + "knot " + std::to_string(i);
    if (!std::isfinite(x[i])) {
      throw std::invalid_argument(knot + " is " + std::to_string(x[i]) + ": must be finite");
    }
    if (i > 0 && x[i] <= x[i - 1]) {
      throw std::invalid_argument(knot + " is " + std::to_string(x[i]) + " after " +
                                  std::to_string(x[i - 1]) + ": knots must ascend");
    }
    for (Eigen::Index c = 0; c < y.cols(); ++c) {
      const double value = y(static_cast<Eigen::Index>(i), c);
      if (!std::isfinite(value)) {
        throw std::invalid_argument(knot + ", column " + std::to_string(c) + ": the value is " +
                                    std::to_string(value) + ": must be finite");
      }
    }
  }
}

}  // namespace

NaturalSpline::NaturalSpline(SplineDegree degree, std::span<const double> x,
                             const Eigen::Ref<const Samples>& y)
    : order_(degree == SplineDegree::kCubic ? 2 : 3),
      columns_(static_cast<int>(y.cols())),
      x_(x.begin(), x.end()) {
  require_knots(x, y, static_cast<std::size_t>(order_));
  nodes_.assign(x_.size() * static_cast<std::size_t>(order_ * columns_), 0.0);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    for (int c = 0; c < columns_; ++c) node(i, 0)[c] = y(static_cast<Eigen::Index>(i), c);
  }
  if (order_ == 2) {
    solve<2>();
  } else {
    solve<3>();
  }
}

double* NaturalSpline::node(std::size_t knot, int derivative) {
  return nodes_.data() + (knot * static_cast<std::size_t>(order_) +
                          static_cast<std::size_t>(derivative)) *
                             static_cast<std::size_t>(columns_);
}

const double* NaturalSpline::node(std::size_t knot, int derivative) const {
  return const_cast<NaturalSpline*>(this)->node(knot, derivative);
}

template <int Order>
void NaturalSpline::solve() {
  constexpr int kUnknowns = Order - 1;
  using Block = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  const std::size_t n = x_.size();
  // In units of the mean interval the unknowns are of the size of the values' differences, whatever the unit of x.
  const double unit = (x_.back() - x_.front()) / static_cast<double>(n - 1);
  const Eigen::Matrix<double, 2 * Order, 2 * Order> unit_energy = energy<Order>();
  std::vector<Block> diagonal(n, Block::Zero()), above(n, Block::Zero());
  Samples right = Samples::Zero(static_cast<Eigen::Index>(n * kUnknowns), columns_);

  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double h = (x_[i + 1] - x_[i]) / unit;
    Eigen::Matrix<double, 2 * Order, 1> scale;  // nodal values on [0, 1] from those in units of the mean interval
    for (int k = 0; k < Order; ++k) scale[k] = scale[Order + k] = std::pow(h, k);
    const Eigen::Matrix<double, 2 * Order, 2 * Order> form =
        std::pow(h, 1 - 2 * Order) * (scale.asDiagonal() * unit_energy * scale.asDiagonal());
    diagonal[i] += form.template block<kUnknowns, kUnknowns>(1, 1);
    above[i] = form.template block<kUnknowns, kUnknowns>(1, Order + 1);
    diagonal[i + 1] += form.template block<kUnknowns, kUnknowns>(Order + 1, Order + 1);
    const auto row = static_cast<Eigen::Index>(i * kUnknowns);
    for (int c = 0; c < columns_; ++c) {
      // The form vanishes for a constant: only the values' difference acts.
      const double rise = node(i + 1, 0)[c] - node(i, 0)[c];
      for (int k = 0; k < kUnknowns; ++k) {
        right(row + k, c) -= form(1 + k, Order) * rise;
        right(row + kUnknowns + k, c) -= form(Order + 1 + k, Order) * rise;
      }
    }
  }

  const auto rows = [&](std::size_t i) {
    return right.template middleRows<kUnknowns>(static_cast<Eigen::Index>(i * kUnknowns));
  };
  for (std::size_t i = 1; i < n; ++i) {
    const Block factor = diagonal[i - 1].llt().solve(above[i - 1]).transpose();
    diagonal[i] -= factor * above[i - 1];
    rows(i) -= factor * rows(i - 1);
  }
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) rows(i) -= above[i] * rows(i + 1);
    rows(i) = diagonal[i].llt().solve(rows(i)).eval();
    for (int k = 1; k < Order; ++k) {
      const double per_unit = std::pow(unit, -k);
      for (int c = 0; c < columns_; ++c) node(i, k)[c] = rows(i)(k - 1, c) * per_unit;
    }
  }
}

void NaturalSpline::evaluate(double x, int derivative, Eigen::Ref<Eigen::VectorXd> out) const {
  if (derivative < 0 || derivative > 5) {
    throw std::invalid_argument("spline: derivative " + std::to_string(derivative) +
                                ": must be 0 to 5");
  }
  if (out.size() != columns_) {
    throw std::invalid_argument("spline: room for " + std::to_string(out.size()) +
                                " values: there are " + std::to_string(columns_) + " columns");
  }
  const auto after = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  const auto interval = static_cast<std::size_t>(after - x_.begin()) - 1;
  const double h = x_[interval + 1] - x_[interval];
  const bool within = x >= x_.front() && x <= x_.back();
  const std::size_t i = x > x_.back() ? interval + 1 : interval;
  const double t = (x - x_[i]) / h;
  Weights weights = taylor_weights(order_, t, derivative);
  if (within && order_ == 2) add_hermite_weights<2>(t, derivative, weights);
  if (within && order_ == 3) add_hermite_weights<3>(t, derivative, weights);

  const double per_unit = std::pow(h, -derivative);
  for (int c = 0; c < columns_; ++c) {
    // The two weights of the values sum to 1, or to 0 in a derivative: with their difference a constant comes back to
    // the last digit.
    double sum = derivative == 0 ? node(i, 0)[c] : 0.0;
    if (within) sum += weights.right[0] * per_unit * (node(i + 1, 0)[c] - node(i, 0)[c]);
    for (int k = 1; k < order_; ++k) {
      const double scale = per_unit * std::pow(h, k);
      sum += scale * weights.left[k] * node(i, k)[c];
      if (within) sum += scale * weights.right[k] * node(i + 1, k)[c];
    }
    out[c] = sum;
  }
}

Eigen::VectorXd NaturalSpline::operator()(double x, int derivative) const {
  Eigen::VectorXd out(columns_);
  evaluate(x, derivative, out);
  return out;
}

}  // namespace condyle::numerics
