// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "condyle/contact/contact_law.hpp"

using namespace condyle::contact;

TEST_CASE("pressure and its rate are the derivatives of the energy") {
  const ContactLaw law(LinearVolumeLaw{4.7e9});
  for (const double d : {3e-5, 4.1e-4, 1.7e-3}) {
    // W is a quadratic: a central difference is exact but for rounding, 1e-16 / 1e-3.
    const double h = 1e-3 * d;
    CHECK(law.at(d).pressure ==
          doctest::Approx((law.at(d + h).energy - law.at(d - h).energy) / (2 * h)).epsilon(1e-12));
    CHECK(law.at(d).pressure_rate ==
          doctest::Approx((law.at(d + h).pressure - law.at(d - h).pressure) / (2 * h))
              .epsilon(1e-12));
    CHECK(law.at(d).energy > 0.0);
  }
}

TEST_CASE("there is nothing at and above the surface") {
  const ContactLaw law;
  for (const double d : {0.0, -1e-3, -std::numeric_limits<double>::infinity()}) {
    CHECK(law.at(d).energy == 0.0);
    CHECK(law.at(d).pressure == 0.0);
    CHECK(law.at(d).pressure_rate == 0.0);
  }
}

TEST_CASE("a law says its name and parameters with their units, and refuses what is out of range") {
  const LawDescription description = ContactLaw().describe();
  CHECK(description.name == "linear_volume");
  REQUIRE(description.parameters.size() == 1);
  CHECK(description.parameters[0].first == "modulus_N_per_m3");
  CHECK(description.parameters[0].second == 9.3e9);
  CHECK_THROWS_WITH_AS(
      ContactLaw(LinearVolumeLaw{0.0}),
      "contact law linear_volume: modulus is 0.000000 N/m^3: must be finite and greater than 0",
      std::invalid_argument);
  CHECK_THROWS_AS(ContactLaw(LinearVolumeLaw{std::numeric_limits<double>::quiet_NaN()}),
                  std::invalid_argument);
}
