// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "condyle/model/function.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

constexpr FunctionKind kSplines[] = {FunctionKind::kNaturalCubicSpline, FunctionKind::kSimmSpline};

struct Knots {
  std::vector<double> x, y;
};

Knots random_knots(test::Draw& draw, int n) {
  Knots knots;
  double x = -0.7;
  for (int i = 0; i < n; ++i) {
    knots.x.push_back(x);
    knots.y.push_back(draw(-1.0, 1.0));
    x += draw(0.15, 0.6);
  }
  return knots;
}

}  // namespace

TEST_CASE("linear and polynomial functions are what they are called [property]") {
  const double x = 0.37;
  const auto line = Function::linear(-1.7, 0.21)(x);
  CHECK(line[0] == doctest::Approx(0.21 - 1.7 * x).epsilon(1e-15));
  CHECK(line[1] == -1.7);
  CHECK((line[2] == 0.0 && line[3] == 0.0));
  const auto p = Function::polynomial({0.3, -0.5, 0.7, 1.1, -0.4})(x);
  CHECK(p[0] ==
        doctest::Approx(0.3 - 0.5 * x + 0.7 * x * x + 1.1 * x * x * x - 0.4 * x * x * x * x));
  CHECK(p[1] == doctest::Approx(-0.5 + 1.4 * x + 3.3 * x * x - 1.6 * x * x * x));
  CHECK(p[2] == doctest::Approx(1.4 + 6.6 * x - 4.8 * x * x));
  CHECK(p[3] == doctest::Approx(6.6 - 9.6 * x));
  const auto nothing = Function()(x);
  for (double value : nothing) CHECK(value == 0.0);
}

TEST_CASE("a SIMM spline is OpenSim's [oracle]") {
  const Function f = Function::spline(FunctionKind::kSimmSpline, {-0.5, 0.1, 0.4, 0.8, 1.3, 1.9},
                                      {0.30, -0.21, 0.12, 0.55, 0.07, 0.63});
  struct Row {
    double x;
    std::array<double, 3> y;
  };
  // OpenSim 4.6, SimmSpline: value, first and second derivative; outside, at a knot, inside.
  const Row rows[] = {
      {-0.7, {0.90353758869916545, -3.0176879434958277, 0}},
      {-0.31, {-0.11786319711808746, -1.4420304510766755, 7.3272748299677755}},
      {0.25, {-0.071349473899689125, 1.1204379238658801, 2.3421754577501392}},
      {0.4, {0.11999999999999997, 1.4104504709307593, 1.5246585031149176}},
      {1.07, {0.35788945320237786, -1.2419513466398699, -1.8531385531818607}},
      {1.85, {0.45190576224498424, 3.249916275680437, 12.213250961307599}},
      {2.2, {1.7941471319722302, 3.8804904399074305, 0}},
  };
  // A tridiagonal system of six rows: rounding of some 10 eps, times 1/h² in the second derivative.
  for (const Row& row : rows) {
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(std::abs(f(row.x)[k] - row.y[k]) < 1e-13 * (1.0 + std::abs(row.y[k])));
    }
  }
}

TEST_CASE(
    "a SIMM spline through points of a cubic is that cubic, of three points the parabola, "
    "of two the line [property]") {
  const auto cubic = Function::polynomial({0.3, -0.5, 0.7, 1.1});
  Knots knots = {{-0.9, -0.4, 0.1, 0.9, 1.2, 2.0}, {}};
  for (double x : knots.x) knots.y.push_back(cubic(x)[0]);
  const auto spline = Function::spline(FunctionKind::kSimmSpline, knots.x, knots.y);
  for (double x = -0.89; x < 2.0; x += 0.17) {
    for (std::size_t k = 0; k < 4; ++k) {
      CHECK(spline(x)[k] == doctest::Approx(cubic(x)[k]).epsilon(1e-11));
    }
  }
  const auto parabola = Function::polynomial({0.3, -0.5, 0.7});
  const auto three = Function::spline(FunctionKind::kSimmSpline, {-0.9, 0.1, 0.4},
                                      {parabola(-0.9)[0], parabola(0.1)[0], parabola(0.4)[0]});
  for (FunctionKind kind : {FunctionKind::kSimmSpline, FunctionKind::kNaturalCubicSpline,
                            FunctionKind::kPiecewiseLinear}) {
    const auto two = Function::spline(kind, {-0.9, 0.4}, {0.2, -0.7});
    CHECK(two(0.1)[1] == doctest::Approx(-0.9 / 1.3));
    CHECK(two(0.1)[0] == doctest::Approx(0.2 - 0.9 / 1.3));
    CHECK(two(0.1)[2] == 0.0);
  }
  for (double x : {-0.8, 0.05, 0.1, 0.3}) {
    for (std::size_t k = 0; k < 4; ++k) {
      CHECK(std::abs(three(x)[k] - parabola(x)[k]) < 1e-13);
    }
  }
}

TEST_CASE(
    "splines pass their knots with continuous slope and curvature; natural ones end straight "
    "[property]") {
  test::Draw draw(5);
  for (const FunctionKind kind : kSplines) {
    for (int n : {3, 4, 5, 9}) {
      const Knots knots = random_knots(draw, n);
      const auto f = Function::spline(kind, knots.x, knots.y);
      CAPTURE(n);
      for (std::size_t i = 0; i < knots.x.size(); ++i) {
        CHECK(std::abs(f(knots.x[i])[0] - knots.y[i]) < 1e-14);
        if (i == 0 || i + 1 == knots.x.size()) continue;
        // One step to the left by the smallest number: what differs is third derivative times that,
        // and rounding.
        const double left = std::nextafter(knots.x[i], -10.0);
        for (std::size_t k = 0; k < 3; ++k) {
          CHECK(std::abs(f(left)[k] - f(knots.x[i])[k]) < 1e-11 * (1.0 + std::abs(f(left)[k])));
        }
      }
      if (kind == FunctionKind::kNaturalCubicSpline) {
        CHECK(std::abs(f(knots.x.front())[2]) < 1e-12);
        CHECK(std::abs(f(knots.x.back())[2]) < 1e-12);
      }
    }
  }
}

TEST_CASE("each derivative is that of the one before, inside and beyond the knots [derivative]") {
  test::Draw draw(6);
  const Knots knots = random_knots(draw, 7);
  const Function functions[] = {
      Function::linear(0.4, -0.3), Function::polynomial({0.1, 0.7, -1.3, 0.4, 0.9}),
      Function::spline(FunctionKind::kNaturalCubicSpline, knots.x, knots.y),
      Function::spline(FunctionKind::kSimmSpline, knots.x, knots.y),
      Function::spline(FunctionKind::kPiecewiseLinear, knots.x, knots.y)};
  const double h = 1e-6;
  for (const Function& f : functions) {
    for (double x = -1.3; x < 3.5; x += 0.0917) {
      bool near_knot = false;
      for (double knot : knots.x) near_knot = near_knot || std::abs(x - knot) < 2 * h;
      if (near_knot) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const double difference = (f(x + h)[k] - f(x - h)[k]) / (2 * h);
        // Central difference: rounding eps·|f|/h; h² times a third derivative is below it.
        CHECK(std::abs(f(x)[k + 1] - difference) < 1e-8 * (1.0 + std::abs(f(x)[k])));
      }
    }
  }
}

TEST_CASE("beyond the knots a function goes straight on [property]") {
  test::Draw draw(7);
  const Knots knots = random_knots(draw, 6);
  for (FunctionKind kind : {FunctionKind::kSimmSpline, FunctionKind::kNaturalCubicSpline,
                            FunctionKind::kPiecewiseLinear}) {
    const auto f = Function::spline(kind, knots.x, knots.y);
    for (const auto& [end, out] :
         {std::pair{knots.x.front(), -0.83}, std::pair{knots.x.back(), 0.71}}) {
      const auto there = f(end + out), here = f(end);
      CHECK(there[1] == doctest::Approx(here[1]).epsilon(1e-12));
      CHECK(there[0] == doctest::Approx(here[0] + out * here[1]).epsilon(1e-12));
      CHECK((there[2] == 0.0 && there[3] == 0.0));
    }
  }
}

TEST_CASE("knots that make no function are refused by number and value [error]") {
  const auto spline = [](std::vector<double> x, std::vector<double> y) {
    Function::spline(FunctionKind::kSimmSpline, std::move(x), std::move(y));
  };
  CHECK_THROWS_WITH_AS(spline({0.5}, {0.5}), "function: x has 1 knots; a spline needs at least 2",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(spline({0.5, 0.7}, {0.5, 0.1, 0.2}),
                       "function: x has 2 knots, y has 3; they must be as many",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(spline({0.5, 0.7, 0.7}, {0.5, 0.1, 0.2}),
                       "function: x[2] is 0.700000 after 0.700000; knots must ascend",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(spline({0.5, NAN}, {0.5, 0.1}),
                       doctest::Contains("knot 1 is (nan, 0.100000); it must be finite"),
                       std::invalid_argument);
  CHECK_THROWS_AS(Function::spline(FunctionKind::kLinear, {0.5, 0.7}, {0.5, 0.1}),
                  std::invalid_argument);
}
