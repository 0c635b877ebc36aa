// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>

#include "condyle/model/ligament_law.hpp"

using namespace condyle::model;

namespace {

// Nothing is 1: a stiffness multiplied by the slack length instead of divided would show.
const LigamentForceLaw kStrand{LigamentLaw::kBlankevoort, 687.0, 0.0437, 0.057, 0.0031};
const LigamentForceLaw kSpring{LigamentLaw::kLinear, 1.187e6, 0.0437, 0.06, 0.0};

}  // namespace

TEST_CASE("both laws by hand: slack, toe, linear; a spring that only pulls [oracle]") {
  const double L0 = kStrand.slack_length;
  CHECK(tension(kStrand, 0.98 * L0).force == 0.0);
  CHECK(tension(kStrand, 1.03 * L0).strain == doctest::Approx(0.03).epsilon(1e-12));
  CHECK(tension(kStrand, 1.03 * L0).force ==
        doctest::Approx(687.0 * 0.03 * 0.03 / (2 * 0.057)).epsilon(1e-12));
  CHECK(tension(kStrand, 1.09 * L0).force ==
        doctest::Approx(687.0 * (0.09 - 0.0285)).epsilon(1e-12));
  CHECK(tension(kStrand, 1.09 * L0).by_length == doctest::Approx(687.0 / L0).epsilon(1e-12));
  CHECK(tension(kSpring, L0 - 1e-4).force == 0.0);
  CHECK(tension(kSpring, L0 + 1e-4).force == doctest::Approx(118.7).epsilon(1e-9));
}

TEST_CASE("tension is the energy's slope and its stiffness the tension's [derivative]") {
  for (const LigamentForceLaw& law : {kStrand, kSpring}) {
    for (const double strain : {-0.03, 0.004, 0.031, 0.0565, 0.0575, 0.13}) {
      CAPTURE(strain);
      const double L = law.slack_length * (1.0 + strain), h = 1e-7;
      const LigamentTension t = tension(law, L);
      const double scale = law.kind == LigamentLaw::kLinear ? 1.0 : 1e-3;
      // Energies of 1e-1..10 J: rounding 1e-16·10/1e-7; tensions of 1e4 N likewise, over
      // stiffnesses of 1e4..1e6.
      CHECK(std::abs((energy(law, L + h) - energy(law, L - h)) / (2 * h) - t.force) <
            1e-5 * scale + 1e-6);
      CHECK(std::abs((tension(law, L + h).force - tension(law, L - h).force) / (2 * h) -
                     t.by_length) < 1e-2 * scale + 1e-3);
    }
  }
}

TEST_CASE(
    "damping is c times the strain rate, phased in over 1 % of strain, while stretched and "
    "lengthening [oracle]") {
  const double L0 = kStrand.slack_length, v = 0.083;
  CHECK(damping(kStrand, 1.04 * L0, v).force == doctest::Approx(0.0031 * v / L0).epsilon(1e-12));
  // Halfway through a smooth step is a half.
  CHECK(damping(kStrand, 1.005 * L0, v).force ==
        doctest::Approx(0.5 * 0.0031 * v / L0).epsilon(1e-10));
  CHECK(damping(kStrand, 1.04 * L0, -v).force == 0.0);
  CHECK(damping(kStrand, 0.99 * L0, v).force == 0.0);
  CHECK(damping(kSpring, 1.04 * L0, v).force == 0.0);
  for (const double strain : {0.0031, 0.0082, 0.05}) {
    const double L = L0 * (1 + strain), h = 1e-8;
    const LigamentDamping d = damping(kStrand, L, v);
    // Forces of 6e-3 N: rounding 1e-18/1e-8.
    CHECK(std::abs((damping(kStrand, L + h, v).force - damping(kStrand, L - h, v).force) / (2 * h) -
                   d.by_length) < 1e-6);
    CHECK(std::abs((damping(kStrand, L, v + h).force - damping(kStrand, L, v - h).force) / (2 * h) -
                   d.by_velocity) < 1e-8);
  }
}

TEST_CASE("a description's law is taken over, and one that cannot be is refused by name [error]") {
  LigamentDescription from;
  from.law = LigamentLaw::kLinear;
  from.stiffness = 3.0;
  from.slack_length = 0.07;
  from.transition_strain = 0.05;
  from.damping = 0.002;
  const LigamentForceLaw law = force_law(from);
  CHECK(law.kind == LigamentLaw::kLinear);
  CHECK(law.stiffness == 3.0);
  CHECK(law.slack_length == 0.07);
  CHECK(law.transition_strain == 0.05);
  CHECK(law.damping == 0.002);
  LigamentForceLaw wrong = kStrand;
  wrong.slack_length = 0.0;
  CHECK_THROWS_WITH_AS(require_valid(wrong, "ligament 'pCAP1'"),
                       "ligament 'pCAP1': slack_length is 0.000000: must be finite and above 0 [m]",
                       std::invalid_argument);
  wrong = kStrand;
  wrong.damping = -0.1;
  CHECK_THROWS_AS(require_valid(wrong, "ligament 'pCAP1'"), std::invalid_argument);
}
