// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "condyle/contact/elastic_layer.hpp"

using namespace condyle::contact;

TEST_CASE("the confined modulus is the stress of a uniaxial strain by Hooke's law") {
  // Strain (e, 0, 0): σx = λ e + 2 μ e with Lamé's λ = E ν/((1 + ν)(1 − 2ν)), μ = E/(2(1 + ν)).
  for (const double nu : {-0.4, 0.0, 0.23, 0.46}) {
    const double E = 463e6;
    const double lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu = E / (2.0 * (1.0 + nu));
    // Both are a handful of operations on numbers of one size: some eps.
    CHECK(layer_of({E, nu, 7e-3}).modulus == doctest::Approx(lambda + 2.0 * mu).epsilon(1e-14));
  }
  CHECK(layer_of({463e6, 0.46, 7e-3}).thickness == 7e-3);
}

TEST_CASE("modulus and material convert into each other") {
  for (const double nu : {-0.3, 0.31, 0.46, 0.4999}) {
    const ElasticLayer layer{712e6, nu, 8.3e-3};
    const double modulus = pressure_modulus(layer);
    CHECK(modulus == doctest::Approx(layer_of(layer).modulus / 8.3e-3).epsilon(1e-15));
    CHECK(youngs_modulus(modulus, nu, 8.3e-3) == doctest::Approx(712e6).epsilon(1e-14));
  }
}

TEST_CASE("9.3 GN/m³ is a layer some tens of times softer than polyethylene") {
  // The figures that elastic_layer.hpp quotes: E to 1 %, M/E to its last digit.
  CHECK(youngs_modulus(9.3e9, 0.46, 5e-3) == doctest::Approx(10.06e6).epsilon(1e-3));
  CHECK(youngs_modulus(9.3e9, 0.46, 10e-3) == doctest::Approx(20.12e6).epsilon(1e-3));
  CHECK(layer_of({1.0e6, 0.46, 5e-3}).modulus == doctest::Approx(4.623e6).epsilon(1e-3));
}

TEST_CASE("a layer that cannot be is refused with its parameter, value and limit") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(layer_of({-463e6, 0.46, 7e-3}),
                       "youngs_modulus is -4.63e+08 Pa: must be finite and greater than 0",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(layer_of({463e6, 0.5, 7e-3}),
                       "poissons_ratio is 0.5: must be between -1 and 0.5, both excluded",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(layer_of({463e6, 0.46, 0.0}),
                       "thickness is 0 m: must be finite and greater than 0",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(youngs_modulus(0.0, 0.46, 7e-3),
                       "modulus is 0 N/m^3: must be finite and greater than 0",
                       std::invalid_argument);
  CHECK_THROWS_AS(layer_of({}), std::invalid_argument);
  CHECK_THROWS_AS(layer_of({463e6, kNaN, 7e-3}), std::invalid_argument);
  CHECK_THROWS_AS(pressure_modulus({kNaN, 0.46, 7e-3}), std::invalid_argument);
  CHECK_THROWS_AS(youngs_modulus(9.3e9, -1.0, 7e-3), std::invalid_argument);
  CHECK_THROWS_AS(youngs_modulus(9.3e9, 0.46, kNaN), std::invalid_argument);
}
