// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/muscle.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "condyle/model/muscle_curves.hpp"

namespace condyle::model {
namespace {

constexpr double kRightAngle = 1.5707963267948966;

void require(bool ok, const MuscleDescription& muscle, const char* field, double value, const char* limit) {
  if (ok) return;
  std::ostringstream text;
  text << "muscle '" << muscle.name << "': " << field << " is " << value << "; it must be " << limit;
  throw std::invalid_argument(text.str());
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }
bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

void require_valid(const MuscleDescription& muscle) {
  require(positive(muscle.max_isometric_force), muscle, "max_isometric_force", muscle.max_isometric_force,
          "above 0 N");
  require(positive(muscle.optimal_fibre_length), muscle, "optimal_fibre_length", muscle.optimal_fibre_length,
          "above 0 m");
  require(not_negative(muscle.tendon_slack_length), muscle, "tendon_slack_length",
          muscle.tendon_slack_length, "at least 0 m");
  const double pennation = muscle.pennation_at_optimal;
  require(not_negative(pennation) && pennation < kRightAngle, muscle, "pennation_at_optimal", pennation,
          "at least 0 and below π/2 rad");
  require(positive(muscle.max_contraction_velocity), muscle, "max_contraction_velocity",
          muscle.max_contraction_velocity, "above 0 optimal fibre lengths a second");
}

MuscleStrength muscle_strength(const MuscleDescription& muscle, StrengthModel model, double length,
                               double velocity) {
  MuscleStrength result;
  const double optimal = muscle.optimal_fibre_length;
  const double width = optimal * std::sin(muscle.pennation_at_optimal);
  const double along = length - muscle.tendon_slack_length;
  result.slack = along <= 0.0;
  const double fibre = std::hypot(result.slack ? 0.0 : along, width);
  result.cos_pennation = fibre > 0.0 && !result.slack ? along / fibre : 0.0;
  result.fibre_length = fibre / optimal;
  const double fastest = muscle.max_contraction_velocity * optimal;
  result.fibre_velocity = velocity * result.cos_pennation / fastest;
  if (model == StrengthModel::kConstant) {
    result.strength = muscle.max_isometric_force;
    return result;
  }
  if (result.slack) return result;

  const CurvePoint active = active_force_length(result.fibre_length);
  const CurvePoint speed = force_velocity(result.fibre_velocity);
  const CurvePoint passive = passive_force_length(result.fibre_length);
  const double c = result.cos_pennation;
  // dl/dL = cos α, d(cos α)/dL = sin² α / l.
  const double cos_by_length = (1.0 - c * c) / fibre;
  const double length_by_length = c / optimal;
  const double velocity_by_length = velocity * cos_by_length / fastest;
  const double f = muscle.max_isometric_force;
  result.strength = f * active.value * speed.value * c;
  result.strength_by_length = f * (active.slope * length_by_length * speed.value * c +
                                   active.value * speed.slope * velocity_by_length * c +
                                   active.value * speed.value * cos_by_length);
  result.strength_by_velocity = f * active.value * speed.slope * c * c / fastest;
  result.passive = f * passive.value * c;
  result.passive_by_length = f * (passive.slope * length_by_length * c + passive.value * cos_by_length);
  return result;
}

}  // namespace condyle::model
