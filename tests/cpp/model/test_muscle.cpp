// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/muscle.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

#include "condyle/model/muscle_curves.hpp"

using namespace condyle::model;

namespace {

MuscleDescription pennate_muscle() {
  MuscleDescription muscle;
  muscle.name = "vasmed";
  muscle.max_isometric_force = 1443.7;
  muscle.optimal_fibre_length = 0.10774;
  muscle.tendon_slack_length = 0.14091;
  muscle.pennation_at_optimal = 0.5168;
  muscle.max_contraction_velocity = 11.0;
  return muscle;
}

std::string message_of(const MuscleDescription& muscle) {
  try {
    require_valid(muscle);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("at optimal length and at rest, strength is F0 cos α0 times the curve's peak region [closed form]") {
  const MuscleDescription muscle = pennate_muscle();
  const double cos_optimal = std::cos(muscle.pennation_at_optimal);
  const double length = muscle.tendon_slack_length + muscle.optimal_fibre_length * cos_optimal;
  const MuscleStrength at = muscle_strength(muscle, StrengthModel::kHill, length, 0.0);
  CHECK(at.fibre_length == doctest::Approx(1.0).epsilon(1e-14));
  CHECK(at.cos_pennation == doctest::Approx(cos_optimal).epsilon(1e-14));
  CHECK(at.strength == doctest::Approx(muscle.max_isometric_force * active_force_length(1.0).value * cos_optimal)
                           .epsilon(1e-12));
  CHECK(at.passive ==
        doctest::Approx(muscle.max_isometric_force * passive_force_length(1.0).value * cos_optimal).epsilon(1e-12));
}

TEST_CASE("without pennation the fibre is what the tendon leaves [closed form]") {
  MuscleDescription muscle = pennate_muscle();
  muscle.pennation_at_optimal = 0.0;
  const MuscleStrength at = muscle_strength(muscle, StrengthModel::kHill, 0.27, -0.35);
  CHECK(at.fibre_length == doctest::Approx((0.27 - 0.14091) / 0.10774).epsilon(1e-13));
  CHECK(at.fibre_velocity == doctest::Approx(-0.35 / (11.0 * 0.10774)).epsilon(1e-13));
  CHECK(at.cos_pennation == doctest::Approx(1.0).epsilon(1e-15));
}

TEST_CASE("derivatives agree with differences [finite differences]") {
  const MuscleDescription muscle = pennate_muscle();
  const double h = 1e-6;  // central differences: truncation h² · third derivative ≈ 1e-12 · 1e8 N
  for (const double length : {0.19, 0.22, 0.245, 0.29}) {
    for (const double velocity : {-0.4, 0.0, 0.3}) {
      CAPTURE(length);
      CAPTURE(velocity);
      const auto at = [&](double dl, double dv) {
        return muscle_strength(muscle, StrengthModel::kHill, length + dl, velocity + dv);
      };
      const MuscleStrength here = at(0, 0);
      CHECK(here.strength_by_length ==
            doctest::Approx((at(h, 0).strength - at(-h, 0).strength) / (2 * h)).epsilon(1e-6));
      CHECK(here.strength_by_velocity ==
            doctest::Approx((at(0, h).strength - at(0, -h).strength) / (2 * h)).epsilon(1e-6));
      CHECK(here.passive_by_length ==
            doctest::Approx((at(h, 0).passive - at(-h, 0).passive) / (2 * h)).epsilon(1e-6));
    }
  }
}

TEST_CASE("a slack tendon carries nothing and says so; a constant strength does not ask") {
  const MuscleDescription muscle = pennate_muscle();
  const MuscleStrength hill = muscle_strength(muscle, StrengthModel::kHill, 0.14, 0.2);
  CHECK(hill.slack);
  CHECK(hill.strength == 0.0);
  CHECK(hill.passive == 0.0);
  const MuscleStrength constant = muscle_strength(muscle, StrengthModel::kConstant, 0.14, 0.2);
  CHECK(constant.strength == muscle.max_isometric_force);
  CHECK(constant.strength_by_length == 0.0);
}

TEST_CASE("impossible parameters are refused by name, with value and limit") {
  CHECK(message_of(pennate_muscle()).empty());
  MuscleDescription muscle = pennate_muscle();
  muscle.max_isometric_force = 0.0;
  CHECK(message_of(muscle) == "muscle 'vasmed': max_isometric_force is 0; it must be above 0 N");
  muscle = pennate_muscle();
  muscle.pennation_at_optimal = 1.6;
  CHECK(message_of(muscle) ==
        "muscle 'vasmed': pennation_at_optimal is 1.6; it must be at least 0 and below π/2 rad");
  muscle = pennate_muscle();
  muscle.optimal_fibre_length = std::numeric_limits<double>::quiet_NaN();
  CHECK(message_of(muscle).find("optimal_fibre_length is nan") != std::string::npos);
  muscle = pennate_muscle();
  muscle.tendon_slack_length = -0.1;
  CHECK(message_of(muscle).find("tendon_slack_length is -0.1") != std::string::npos);
  muscle = pennate_muscle();
  muscle.max_contraction_velocity = 0.0;
  CHECK(message_of(muscle).find("max_contraction_velocity is 0") != std::string::npos);
}
