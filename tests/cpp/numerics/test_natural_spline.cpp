// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "condyle/numerics/natural_spline.hpp"

using condyle::numerics::NaturalSpline;
using condyle::numerics::SplineDegree;

namespace {

constexpr SplineDegree kDegrees[] = {SplineDegree::kCubic, SplineDegree::kQuintic};

int order_of(SplineDegree degree) { return degree == SplineDegree::kCubic ? 2 : 3; }

/// Uneven knots about 1/120 s apart, as a motion's.
std::vector<double> uneven_knots(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.004, 0.013);
  std::vector<double> x{0.75};
  while (static_cast<int>(x.size()) < n) x.push_back(x.back() + step(random));
  return x;
}

NaturalSpline::Samples random_samples(int n, int columns, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.3, 2.1);
  NaturalSpline::Samples y(n, columns);
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < columns; ++c) y(i, c) = value(random);
  }
  return y;
}

/// ∫ (d^m/dx^m of the spline + shift · that of a bump)² by Gauss' rule of four points (exact to degree 7) an interval.
double energy(const NaturalSpline& spline, const std::vector<double>& x, double shift,
              const std::function<double(double)>& bump) {
  const double at[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                       0.8611363115940526};
  const double weight[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                           0.3478548451374538};
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double half = 0.5 * (x[i + 1] - x[i]), middle = 0.5 * (x[i + 1] + x[i]);
    for (int g = 0; g < 4; ++g) {
      const double here = middle + half * at[g];
      const double value =
          spline(here, order_of(spline.degree()))[0] + shift * bump((here - x[i]) / (2 * half));
      sum += half * weight[g] * value * value;
    }
  }
  return sum;
}

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace

TEST_CASE("a spline passes through its values [property]") {
  const auto x = uneven_knots(60, 3);
  const auto y = random_samples(60, 4, 5);
  for (const SplineDegree degree : kDegrees) {
    const NaturalSpline spline(degree, x, y);
    for (std::size_t i = 0; i < x.size(); ++i) {
      // Rounding of a sum of six products of values below 10.
      CHECK((spline(x[i]) - y.row(static_cast<Eigen::Index>(i)).transpose()).cwiseAbs().maxCoeff() <
            1e-13);
    }
  }
}

TEST_CASE("polynomials of degree below the order come back, also beyond the ends [property]") {
  const auto x = uneven_knots(40, 7);
  for (const SplineDegree degree : kDegrees) {
    const double a = 0.7, b = -3.1, c = degree == SplineDegree::kQuintic ? 11.0 : 0.0;
    NaturalSpline::Samples y(40, 1);
    for (int i = 0; i < 40; ++i) {
      const double t = x[static_cast<std::size_t>(i)];
      y(i, 0) = a + b * t + c * t * t;
    }
    const NaturalSpline spline(degree, x, y);
    for (const double t : {x.front() - 0.05, x.front(), 0.8031, 0.9, x.back(), x.back() + 0.07}) {
      // A value's rounding, 2e-16 × 10, divided by the shortest interval, 4 ms, once for each derivative; times ten. Beyond
      // an end the errors of slope and curvature there go on.
      const double beyond = std::max({0.0, x.front() - t, t - x.back()});
      CHECK(std::abs(spline(t)[0] - (a + b * t + c * t * t)) <
            2e-14 + 5e-12 * beyond + 1e-9 * beyond * beyond);
      CHECK(std::abs(spline(t, 1)[0] - (b + 2 * c * t)) < 5e-12 + 2e-9 * beyond);
      CHECK(std::abs(spline(t, 2)[0] - 2 * c) < 2e-9);
    }
  }
}

TEST_CASE("all derivatives but the last two are continuous, and those of high order vanish at the ends [property]") {
  const auto x = uneven_knots(30, 11);
  const auto y = random_samples(30, 1, 13);
  for (const SplineDegree degree : kDegrees) {
    const NaturalSpline spline(degree, x, y);
    const int order = order_of(degree);
    for (int derivative = 0; derivative <= 2 * order - 2; ++derivative) {
      double size = 0.0, jump = 0.0;
      for (std::size_t i = 1; i + 1 < x.size(); ++i) {
        const double below = spline(std::nextafter(x[i], x[0]), derivative)[0];
        const double above = spline(x[i], derivative)[0];
        size = std::max(size, std::abs(above));
        jump = std::max(jump, std::abs(above - below));
      }
      // Rounding of the system's solution, amplified by the unevenness of the knots (a factor of 3 to the power 2m − 1).
      CHECK_MESSAGE(jump < 1e-10 * size, "derivative " << derivative);
      if (derivative < order) continue;
      CHECK(std::abs(spline(x.front(), derivative)[0]) < 1e-10 * size);
      CHECK(std::abs(spline(x.back(), derivative)[0]) < 1e-10 * size);
    }
  }
}

TEST_CASE("each derivative is the slope of the one before it [derivative]") {
  const auto x = uneven_knots(30, 17);
  const auto y = random_samples(30, 2, 19);
  for (const SplineDegree degree : kDegrees) {
    const NaturalSpline spline(degree, x, y);
    const double step = 2e-6;
    for (std::size_t i = 0; i + 1 < x.size(); i += 4) {
      const double t = 0.37 * x[i] + 0.63 * x[i + 1];
      for (int derivative = 1; derivative <= 3; ++derivative) {
        const Eigen::VectorXd exact = spline(t, derivative);
        const Eigen::VectorXd difference =
            (spline(t + step, derivative - 1) - spline(t - step, derivative - 1)) / (2 * step);
        // step²/6 of the second derivative after it, which is (1/h)² larger: (2e-6/4e-3)² = 2.5e-7, and rounding.
        CHECK((exact - difference).norm() < 2e-6 * (exact.norm() + spline(t, derivative - 1).norm() / 4e-3));
        CHECK(exact != difference);
      }
    }
  }
}

TEST_CASE("no other function through the values has less energy [property]") {
  const auto x = uneven_knots(12, 23);
  const auto y = random_samples(12, 1, 29);
  for (const SplineDegree degree : kDegrees) {
    const NaturalSpline spline(degree, x, y);
    // d^m/dx^m of something that vanishes at the knots with its first m − 1 derivatives has no mean against polynomials
    // of degree below m: on each interval the Legendre polynomial P_m. Stationary: the energy grows with shift² alone.
    const auto bump = [&](double s) {
      const double u = 2 * s - 1;
      return degree == SplineDegree::kCubic ? 0.5 * (3 * u * u - 1) : 0.5 * (5 * u * u * u - 3 * u);
    };
    const double least = energy(spline, x, 0.0, bump);
    const double size = std::sqrt(least / (x.back() - x.front()));
    const double more = energy(spline, x, 0.1 * size, bump);
    const double less = energy(spline, x, -0.1 * size, bump);
    CHECK(more > least * 1.0001);
    CHECK(std::abs(more - less) < 1e-9 * least);
  }
}

TEST_CASE("derivatives of a smooth motion converge with the step [oracle]") {
  // In the middle, away from the ends' conditions: error of s'' ~ h⁴ for the quintic spline, so two halvings give 256.
  const auto error = [](int n) {
    std::vector<double> x;
    NaturalSpline::Samples y(n + 1, 1);
    for (int i = 0; i <= n; ++i) {
      x.push_back(3.0 * i / n);
      y(i, 0) = std::sin(4.3 * x.back() + 0.2);
    }
    const NaturalSpline spline(SplineDegree::kQuintic, x, y);
    double worst = 0.0;
    for (double t = 1.4; t < 1.6; t += 0.00137) {
      worst = std::max(worst, std::abs(spline(t, 2)[0] + 4.3 * 4.3 * std::sin(4.3 * t + 0.2)));
    }
    return worst;
  };
  const double ratio = error(60) / error(240);
  CHECK(ratio > 180);
  CHECK(ratio < 360);
}

TEST_CASE("what makes no spline is refused with the knot [error]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refusal = [](SplineDegree degree, std::vector<double> x, int rows, double last = 1.5) {
    NaturalSpline::Samples y = NaturalSpline::Samples::Constant(rows, 2, 0.3);
    y(rows - 1, 1) = last;
    return message_of([&] { NaturalSpline(degree, x, y); });
  };
  CHECK(refusal(SplineDegree::kCubic, {1.0}, 1) == "spline: 1 knots: at least 2 are needed");
  CHECK(refusal(SplineDegree::kQuintic, {1, 2}, 2) == "spline: 2 knots: at least 3 are needed");
  CHECK(refusal(SplineDegree::kCubic, {1, 2, 3}, 2) ==
        "spline: 2 rows of values for 3 knots");
  CHECK(refusal(SplineDegree::kCubic, {1, 2, 2}, 3) ==
        "spline: knot 2 is 2.000000 after 2.000000: knots must ascend");
  CHECK(refusal(SplineDegree::kCubic, {1, nan, 2}, 3) ==
        "spline: knot 1 is nan: must be finite");
  CHECK(refusal(SplineDegree::kQuintic, {1, 2, 3}, 3, nan) ==
        "spline: knot 2, column 1: the value is nan: must be finite");
  const NaturalSpline spline(SplineDegree::kCubic, std::vector<double>{1, 2},
                             NaturalSpline::Samples::Constant(2, 2, 0.3));
  CHECK(message_of([&] { spline(1.5, 6); }) == "spline: derivative 6: must be 0 to 5");
  Eigen::VectorXd short_of_one(1);
  CHECK(message_of([&] { spline.evaluate(1.5, 0, short_of_one); }) ==
        "spline: room for 1 values: there are 2 columns");
}
