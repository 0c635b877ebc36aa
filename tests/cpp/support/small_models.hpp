// SPDX-License-Identifier: Apache-2.0
// Mechanisms of textbooks, built from the same descriptions as a body: each joint named after its
// coordinate.
#pragma once

#include <string>
#include <vector>

#include "condyle/model/model_description.hpp"

namespace condyle::test {

/// Adds a body on one axis in the parent's frame: a turn about, or a slide along, `axis` by the
/// coordinate `name`, which is also the body's name.
inline model::BodyDescription& add_link(model::ModelDescription& d, const std::string& name,
                                        const std::string& parent, const Vector3& origin,
                                        const Vector3& axis, bool rotational) {
  model::BodyDescription body;
  body.name = name;
  d.bodies.push_back(body);
  model::CoordinateDescription coordinate;
  coordinate.name = name;
  coordinate.rotational = rotational;
  d.coordinates.push_back(coordinate);
  model::JointDescription joint;
  joint.name = name;
  joint.parent.body = parent;
  joint.parent.translation = origin;
  joint.child.body = name;
  model::AxisDescription& moved = rotational ? joint.rotations[0] : joint.translations[0];
  moved.axis = axis;
  moved.terms.push_back({name, model::Function::linear(1.0)});
  d.joints.push_back(joint);
  return d.bodies.back();
}

}  // namespace condyle::test
