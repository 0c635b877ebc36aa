// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/ligament_law.hpp"

#include <cmath>
#include <stdexcept>

namespace condyle::model {
namespace {

// Strain over which OpenSim's damping is phased in.
constexpr double kDampingStrain = 0.01;

[[noreturn]] void refuse(const std::string& owner, const char* field, double value,
                         const char* limit) {
  throw std::invalid_argument(owner + ": " + field + " is " + std::to_string(value) + ": must be " +
                              limit);
}

}  // namespace

LigamentForceLaw force_law(const LigamentDescription& ligament) {
  return {ligament.law, ligament.stiffness, ligament.slack_length, ligament.transition_strain,
          ligament.damping};
}

void require_valid(const LigamentForceLaw& law, const std::string& owner) {
  if (!(law.stiffness >= 0.0) || !std::isfinite(law.stiffness)) {
    refuse(owner, "stiffness", law.stiffness, "finite and at least 0");
  }
  if (!(law.slack_length > 0.0) || !std::isfinite(law.slack_length)) {
    refuse(owner, "slack_length", law.slack_length, "finite and above 0 [m]");
  }
  if (!(law.transition_strain > 0.0 && law.transition_strain < 2.0)) {
    refuse(owner, "transition_strain", law.transition_strain, "above 0 and below 2 [-]");
  }
  if (!(law.damping >= 0.0) || !std::isfinite(law.damping)) {
    refuse(owner, "damping", law.damping, "finite and at least 0 [N s]");
  }
}

LigamentTension tension(const LigamentForceLaw& law, double length) {
  LigamentTension t;
  t.strain = length / law.slack_length - 1.0;
  if (t.strain <= 0.0) return t;
  if (law.kind == LigamentLaw::kLinear) {
    t.force = law.stiffness * (length - law.slack_length);
    t.by_length = law.stiffness;
    return t;
  }
  const double toe = law.transition_strain;
  if (t.strain <= toe) {
    t.force = law.stiffness * t.strain * t.strain / (2.0 * toe);
    t.by_length = law.stiffness * t.strain / toe / law.slack_length;
  } else {
    t.force = law.stiffness * (t.strain - 0.5 * toe);
    t.by_length = law.stiffness / law.slack_length;
  }
  return t;
}

double energy(const LigamentForceLaw& law, double length) {
  const double e = length / law.slack_length - 1.0;
  if (e <= 0.0) return 0.0;
  if (law.kind == LigamentLaw::kLinear) {
    const double stretch = length - law.slack_length;
    return 0.5 * law.stiffness * stretch * stretch;
  }
  const double toe = law.transition_strain, k = law.stiffness * law.slack_length;
  if (e <= toe) return k * e * e * e / (6.0 * toe);
  const double beyond = e - 0.5 * toe;
  return k * (toe * toe / 24.0 + 0.5 * beyond * beyond);
}

LigamentDamping damping(const LigamentForceLaw& law, double length, double velocity) {
  LigamentDamping d;
  const double e = length / law.slack_length - 1.0;
  if (law.kind == LigamentLaw::kLinear || e <= 0.0 || velocity <= 0.0) return d;
  const double per_velocity = law.damping / law.slack_length;
  if (e >= kDampingStrain) {
    d.by_velocity = per_velocity;
  } else {
    const double x = e / kDampingStrain;
    d.by_velocity = per_velocity * x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
    d.by_length = per_velocity * velocity * 30.0 * x * x * (1.0 - x) * (1.0 - x) /
                  (kDampingStrain * law.slack_length);
  }
  d.force = d.by_velocity * velocity;
  return d;
}

}  // namespace condyle::model
