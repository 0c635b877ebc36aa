// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "condyle/contact/contact_law.hpp"

using namespace condyle::contact;

namespace {

const ElasticLayer kLayer{463e6, 0.46, 7.3e-3};

TableLaw measured() { return {{0.0, 1.3e-4, 4.7e-4, 1.1e-3}, {0.0, 0.9e6, 7.1e6, 23.0e6}}; }

// Each with general parameters.
std::vector<ContactLaw> laws() {
  return {ContactLaw(LinearVolumeLaw{4.7e9}), ContactLaw(ThinLayerLinearLaw{kLayer}),
          ContactLaw(ThinLayerLogarithmicLaw{kLayer}), ContactLaw(PowerLaw{2.3e13, 2.35}),
          ContactLaw(measured())};
}

void check_same(const LawValue& a, const LawValue& b, double relative) {
  CHECK(std::abs(a.energy - b.energy) <= relative * b.energy);
  CHECK(std::abs(a.pressure - b.pressure) <= relative * b.pressure);
  CHECK(std::abs(a.pressure_rate - b.pressure_rate) <= relative * b.pressure_rate);
}

}  // namespace

TEST_CASE("pressure and its rate are the derivatives of the energy, for every law") {
  for (const ContactLaw& law : laws()) {
    CAPTURE(law.describe().name);
    // Up to beyond the table's last point and the logarithm's range (6.57 mm), and at no corner.
    for (const double d : {2.9e-5, 3.7e-4, 1.7e-3, 5.9e-3, 7.1e-3, 9.7e-3}) {
      CAPTURE(d);
      // Central difference over ±1e-4 d: its error is (1e-4 d)²/6 times the third derivative, which
      // is worst for the logarithm at 5.9 mm, p‴ d² = 2 d² p′/(h − d)² = 36 p′: 6e-8; and W is
      // good to 70 eps, so W′ to 70 eps/1e-4 = 2e-10.
      const double step = 1e-4 * d;
      const LawValue low = law.at(d - step), at = law.at(d), high = law.at(d + step);
      CHECK(at.pressure == doctest::Approx((high.energy - low.energy) / (2 * step)).epsilon(1e-7));
      CHECK(at.pressure_rate ==
            doctest::Approx((high.pressure - low.pressure) / (2 * step)).epsilon(1e-7));
      CHECK(at.energy > 0.0);
      CHECK(at.pressure_rate > 0.0);
    }
  }
}

TEST_CASE("there is nothing at and above the surface, for every law") {
  const Layer layer = layer_of(kLayer);
  for (const ContactLaw& law : laws()) {
    for (const double d : {0.0, -1e-3, -std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
      for (const LawValue& value : {law.at(d), law.at(d, layer)}) {
        CHECK(value.energy == 0.0);
        CHECK(value.pressure == 0.0);
        CHECK(value.pressure_rate == 0.0);
      }
    }
  }
}

TEST_CASE("a thin layer under small strain is the pressure modulus it converts to") {
  const ContactLaw layer(ThinLayerLinearLaw{kLayer});
  const ContactLaw modulus(LinearVolumeLaw{pressure_modulus(kLayer)});
  for (const double d : {2.9e-5, 1.7e-3, 9.7e-3}) check_same(layer.at(d), modulus.at(d), 1e-15);
}

TEST_CASE("the logarithmic layer is its formula within its range") {
  const auto [M, h] = layer_of(kLayer);
  const ContactLaw law(ThinLayerLogarithmicLaw{kLayer});
  for (const double s : {0.031, 0.11, 0.43, 0.89}) {
    const double e = std::log(1.0 - s);
    // Here 1 − s is rounded by eps/2, which is eps/s² of W: 2.3e-13 at s = 0.031.
    check_same(law.at(s * h), {M * h * ((1.0 - s) * e + s), -M * e, M / h / (1.0 - s)}, 3e-13);
  }
}

TEST_CASE("the logarithmic layer tends to the linear one: p/p_linear − 1 = s/2 + s²/3 + …") {
  const ContactLaw logarithmic(ThinLayerLogarithmicLaw{kLayer});
  const ContactLaw linear(ThinLayerLinearLaw{kLayer});
  for (const double s : {1e-6, 1e-4, 1e-2}) {
    const LawValue a = logarithmic.at(s * kLayer.thickness), b = linear.at(s * kLayer.thickness);
    // Series of the three: p is s + s²/2 + s³/3, W is s²/2 + s³/6 + s⁴/12, p′ is 1 + s + s². What
    // is left out is below s² times the last coefficient here; rounding is 10 eps of 1.
    const double tolerance = s * s + 2e-15;
    CHECK(std::abs(a.pressure / b.pressure - 1.0 - s / 2.0) < tolerance / 2.0);
    CHECK(std::abs(a.energy / b.energy - 1.0 - s / 3.0) < tolerance / 4.0 + 1e-15);
    CHECK(std::abs(a.pressure_rate / b.pressure_rate - 1.0 - s) < 1.1 * tolerance);
  }
}

TEST_CASE("the logarithmic layer's series and closed form of the energy meet") {
  const ContactLaw law(ThinLayerLogarithmicLaw{kLayer});
  const double d = 0.03 * kLayer.thickness, step = 1e-9 * d;
  const LawValue below = law.at(d - step), above = law.at(d + step);
  // Between them W grows by 2 step p; either side is good to 70 eps.
  CHECK(std::abs(above.energy - below.energy - 2.0 * step * below.pressure) < 4e-14 * below.energy);
}

TEST_CASE("beyond its range the logarithmic layer goes on along its tangent, finite") {
  const ContactLaw law(ThinLayerLogarithmicLaw{kLayer});
  const double end = kLogarithmicRange * kLayer.thickness, step = 1e-9 * end;
  const LawValue inside = law.at(end - step), at = law.at(end), outside = law.at(end + step);
  // C1: over a step of 1e-9 each changes by the next derivative times it; p′ by 10 of itself.
  check_same(inside, outside, 3e-8);
  for (const double beyond : {0.7e-3, 3.1e-3, 1.0}) {
    const LawValue found = law.at(end + beyond);
    const LawValue tangent{
        at.energy + at.pressure * beyond + at.pressure_rate * beyond * beyond / 2,
        at.pressure + at.pressure_rate * beyond, at.pressure_rate};
    // end + beyond is rounded, as is its difference from end: some eps of 1 m against 0.7 mm.
    check_same(found, tangent, 1e-12);
    CHECK(std::isfinite(found.energy));
  }
}

TEST_CASE("the power law is its formula, and linear for an exponent of one") {
  const ContactLaw power(PowerLaw{2.3e13, 2.35});
  const ContactLaw straight(PowerLaw{4.7e9, 1.0}), linear(LinearVolumeLaw{4.7e9});
  for (const double d : {2.9e-5, 1.7e-3}) {
    check_same(power.at(d),
               {2.3e13 / 3.35 * std::pow(d, 3.35), 2.3e13 * std::pow(d, 2.35),
                2.3e13 * 2.35 * std::pow(d, 1.35)},
               1e-14);
    check_same(straight.at(d), linear.at(d), 1e-15);
  }
}

TEST_CASE("a table sampled from a linear law is that law, beyond its end too") {
  std::vector<double> depth, pressure;
  for (const double d : {0.0, 1.1e-4, 3.7e-4, 1.9e-3}) {
    depth.push_back(d);
    pressure.push_back(4.7e9 * d);
  }
  const ContactLaw table(TableLaw{depth, pressure}), linear(LinearVolumeLaw{4.7e9});
  // A slope is a difference of neighbours: some eps, twice the values.
  for (const double d : {2.9e-5, 1.1e-4, 2.2e-4, 1.7e-3, 4.1e-3}) {
    check_same(table.at(d), linear.at(d), 2e-15);
  }
}

TEST_CASE("a table's energy is the area under its segments") {
  const TableLaw table = measured();
  const auto& d = table.depth();
  const auto& p = table.pressure();
  const double triangle = p[1] * d[1] / 2, trapezium = (p[1] + p[2]) * (d[2] - d[1]) / 2;
  CHECK(table.at(d[1]).energy == doctest::Approx(triangle).epsilon(1e-15));
  CHECK(table.at(d[2]).energy == doctest::Approx(triangle + trapezium).epsilon(1e-15));
  // Beyond the end along the last slope.
  const double slope = (p[3] - p[2]) / (d[3] - d[2]), t = 0.4e-3;
  const double last = (p[2] + p[3]) * (d[3] - d[2]) / 2;
  const LawValue beyond = table.at(d[3] + t);
  CHECK(beyond.pressure_rate == doctest::Approx(slope).epsilon(1e-15));
  CHECK(beyond.pressure == doctest::Approx(p[3] + slope * t).epsilon(1e-14));
  CHECK(beyond.energy ==
        doctest::Approx(triangle + trapezium + last + (p[3] + slope * t / 2) * t).epsilon(1e-14));
  // At a point the rate is that of the segment that ends there.
  CHECK(table.at(d[2]).pressure_rate ==
        doctest::Approx((p[2] - p[1]) / (d[2] - d[1])).epsilon(1e-15));
}

TEST_CASE("a layer given for a face takes the place of the law's own, where there is one") {
  const ElasticLayer other{712e6, 0.31, 5.1e-3};
  CHECK(ContactLaw(ThinLayerLinearLaw{kLayer}).has_layer());
  CHECK(ContactLaw(ThinLayerLogarithmicLaw{kLayer}).has_layer());
  for (const double d : {2.9e-5, 1.7e-3, 4.9e-3}) {
    check_same(ContactLaw(ThinLayerLinearLaw{kLayer}).at(d, layer_of(other)),
               ContactLaw(ThinLayerLinearLaw{other}).at(d), 0.0);
    check_same(ContactLaw(ThinLayerLogarithmicLaw{kLayer}).at(d, layer_of(other)),
               ContactLaw(ThinLayerLogarithmicLaw{other}).at(d), 0.0);
    for (const ContactLaw& law : {laws()[0], laws()[3], laws()[4]}) {
      CHECK_FALSE(law.has_layer());
      check_same(law.at(d, layer_of(other)), law.at(d), 0.0);
    }
  }
}

TEST_CASE("a law says its name and all its parameters with their units") {
  using P = std::vector<std::pair<std::string, double>>;
  const P layer{{"youngs_modulus_Pa", 463e6}, {"poissons_ratio", 0.46}, {"thickness_m", 7.3e-3}};
  const std::vector<LawDescription> expected{
      {"linear_volume", {{"modulus_N_per_m3", 4.7e9}}},
      {"thin_layer_linear", layer},
      {"thin_layer_logarithmic", layer},
      {"power", {{"coefficient_Pa_per_m^n", 2.3e13}, {"exponent", 2.35}}},
      {"table",
       {{"depth_0_m", 0.0},
        {"pressure_0_Pa", 0.0},
        {"depth_1_m", 1.3e-4},
        {"pressure_1_Pa", 0.9e6},
        {"depth_2_m", 4.7e-4},
        {"pressure_2_Pa", 7.1e6},
        {"depth_3_m", 1.1e-3},
        {"pressure_3_Pa", 23.0e6}}}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(laws()[i].describe().name == expected[i].name);
    CHECK(laws()[i].describe().parameters == expected[i].parameters);
  }
  CHECK(ContactLaw().describe().parameters == P{{"modulus_N_per_m3", 9.3e9}});
}

TEST_CASE("a law out of range is refused with its name, the parameter, the value and the limit") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(
      ContactLaw(LinearVolumeLaw{0.0}),
      "contact law linear_volume: modulus is 0 N/m^3: must be finite and greater than 0",
      std::invalid_argument);
  CHECK_THROWS_AS(ContactLaw(LinearVolumeLaw{kNaN}), std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      ContactLaw(ThinLayerLinearLaw{{463e6, 0.46, -7e-3}}),
      "contact law thin_layer_linear: thickness is -0.007 m: must be finite and greater than 0",
      std::invalid_argument);
  CHECK_THROWS_WITH_AS(ContactLaw(ThinLayerLogarithmicLaw{{463e6, 0.5, 7e-3}}),
                       "contact law thin_layer_logarithmic: poissons_ratio is 0.5: must be between "
                       "-1 and 0.5, both excluded",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      ContactLaw(PowerLaw{kNaN, 2.0}),
      "contact law power: coefficient is nan Pa/m^n: must be finite and greater than 0",
      std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      ContactLaw(PowerLaw{2.3e13, 0.97}),
      "contact law power: exponent is 0.97: must be finite and at least 1; below 1 "
      "the pressure rate is infinite at touch",
      std::invalid_argument);
}

TEST_CASE("a table that is none is refused with the point, its value and the limit") {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Wrong {
    std::vector<double> depth, pressure;
    const char* message;
  };
  for (const Wrong& wrong :
       std::vector<Wrong>{{{0, 1e-3}, {0, 1e6, 2e6}, "2 depths and 3 pressures: must be as many"},
                          {{0}, {0}, "1 points: must be at least 2, the first (0, 0)"},
                          {{1e-4, 1e-3}, {0, 1e6}, "depth 0 is 0.0001 m: must be 0"},
                          {{0, 1e-3}, {5e5, 1e6}, "pressure 0 is 500000 Pa: must be 0"},
                          {{0, 1e-3, 1e-3},
                           {0, 1e6, 2e6},
                           "depth 2 is 0.001 m: must be greater than the one before, 0.001 m"},
                          {{0, 1e-3, 2e-3},
                           {0, 3e6, 2e6},
                           "pressure 2 is 2e+06 Pa: must be at least the one before, 3e+06 Pa"},
                          {{0, kInfinity}, {0, 1e6}, "depth 1 is inf m: must be finite"},
                          {{0, 1e-3}, {0, kInfinity}, "pressure 1 is inf Pa: must be finite"},
                          {{0, 1e-3, 2e-3},
                           {0, 0, 0},
                           "every pressure is 0 Pa: the last must be greater than 0"}}) {
    const std::string message = std::string("contact law table: ") + wrong.message;
    CHECK_THROWS_WITH_AS(TableLaw(wrong.depth, wrong.pressure), message.c_str(),
                         std::invalid_argument);
  }
}
