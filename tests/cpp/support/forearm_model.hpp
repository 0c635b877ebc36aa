// SPDX-License-Identifier: Apache-2.0
// A forearm in the x–y plane on a hinge at ground's origin, with a flexor above and an extensor below it: everything has a
// closed form.
#pragma once

#include <string>

#include "condyle/model/model_description.hpp"
#include "support/small_models.hpp"

namespace condyle::test {

/// Forearm along x at elbow = 0, 1.5 kg at 0.12 m, 0.02 kg m² about it; muscles from (0, ±0.3) to ±0.04 m along the forearm
/// (the extensor on its other side of the hinge).
inline model::ModelDescription forearm_model() {
  model::ModelDescription d;
  d.name = "forearm";
  add_link(d, "elbow", model::kGround, Vector3::Zero(), Vector3::UnitZ(), true);
  model::BodyDescription& body = d.bodies.back();
  body.name = "forearm";
  d.joints.back().child.body = "forearm";
  body.mass = 1.5;
  body.mass_centre = {0.12, 0, 0};
  body.inertia << 0.001, 0.02, 0.02, 0, 0, 0;
  d.coordinates.back().balance = model::CoordinateBalance::kMuscles;
  const auto add = [&](const std::string& name, double along) {
    model::MuscleDescription muscle;
    muscle.name = name;
    muscle.max_isometric_force = 900.0;
    muscle.optimal_fibre_length = 0.12;
    muscle.tendon_slack_length = 0.17;
    muscle.pennation_at_optimal = 0.1;
    muscle.path.points.resize(2);
    muscle.path.points[0].body = model::kGround;
    muscle.path.points[0].location = {0, 0.3, 0};
    muscle.path.points[1].body = "forearm";
    muscle.path.points[1].location = {along, 0, 0};
    d.muscles.push_back(muscle);
  };
  add("flexor", 0.04);
  add("extensor", -0.04);
  return d;
}

}  // namespace condyle::test
