// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/muscle_curves.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

using namespace condyle::model;

namespace {

using Curve = CurvePoint (*)(double);

double numeric_slope(Curve curve, double x, double step) {
  return (curve(x + step).value - curve(x - step).value) / (2.0 * step);
}

}  // namespace

TEST_CASE("the curves take the values of De Groote et al. 2016 [closed form]") {
  // The paper's Table of coefficients has three digits; its curves agree with ours to that.
  const auto bell = [](double l, double b1, double b2, double b3, double b4) {
    const double x = (l - b2) / (b3 + b4 * l);
    return b1 * std::exp(-0.5 * x * x);
  };
  for (const double l : {0.5, 0.7, 0.93, 1.0, 1.21, 1.5}) {
    const double printed = bell(l, 0.815, 1.055, 0.162, 0.063) + bell(l, 0.433, 0.717, -0.030, 0.200) +
                           bell(l, 0.100, 1.000, 0.354, 0.000);
    CAPTURE(l);
    CHECK(active_force_length(l).value == doctest::Approx(printed).epsilon(3e-3));
  }
  for (const double v : {-0.7, -0.3, -0.1, 0.1, 0.4, 0.9}) {
    const double x = -8.149 * v - 0.374;
    CAPTURE(v);
    CHECK(std::abs(force_velocity(v).value - (-0.318 * std::log(x + std::sqrt(x * x + 1.0)) + 0.886)) < 0.012);
  }
  CHECK(force_velocity(0.0).value == doctest::Approx(1.0).epsilon(1e-12));
  CHECK(std::abs(force_velocity(-1.0).value) < 1e-3);
  CHECK(passive_force_length(1.6).value == doctest::Approx(1.0).epsilon(1e-12));
}

TEST_CASE("slopes are the curves' derivatives [finite differences]") {
  // Central differences with step h err by h² f'''/6; f''' stays below 2e3 on these ranges.
  const double h = 1e-5;
  for (double x = 0.25; x < 1.9; x += 0.0373) {
    CAPTURE(x);
    CHECK(std::abs(active_force_length(x).slope - numeric_slope(active_force_length, x, h)) < 1e-6);
    CHECK(std::abs(passive_force_length(x).slope - numeric_slope(passive_force_length, x, h)) < 1e-6);
  }
  for (double v = -0.95; v < 1.2; v += 0.0291) {
    CAPTURE(v);
    CHECK(std::abs(force_velocity(v).slope - numeric_slope(force_velocity, v, h)) < 1e-6);
  }
}

TEST_CASE("beyond what a fibre does, curves stay finite, never negative, and flat") {
  for (const double l : {-1.0, 0.0, 0.1, 0.149746, 0.2}) {
    CAPTURE(l);
    CHECK(active_force_length(l).value >= 0.0);
    CHECK(active_force_length(l).value < 1e-2);
    CHECK(passive_force_length(l).value == 0.0);
    CHECK(passive_force_length(l).slope == 0.0);
  }
  CHECK(force_velocity(-3.0).value == 0.0);
  CHECK(force_velocity(-3.0).slope == 0.0);
}
