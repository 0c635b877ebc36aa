// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/model.hpp"

#include <Eigen/Geometry>
#include <stdexcept>
#include <utility>

#include "condyle/model/model_checks.hpp"

namespace condyle::model {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

Matrix3 turn(double angle, const Vector3& unit_axis) {
  return Eigen::AngleAxisd(angle, unit_axis).toRotationMatrix();
}

// Index of each body's joint. @throws if a body has none or two.
std::vector<int> joints_of_bodies(const ModelDescription& d, const std::string& label,
                                  const Model& model) {
  std::vector<int> joint_of_body(d.bodies.size(), -1);
  for (std::size_t j = 0; j < d.joints.size(); ++j) {
    const int child = model.body(d.joints[j].child.body);
    int& joint = joint_of_body[at(child)];
    if (joint >= 0) {
      throw std::invalid_argument(label + ": joint '" + d.joints[j].name + "': child.body '" +
                                  d.joints[j].child.body + "' already hangs on joint '" +
                                  d.joints[at(joint)].name +
                                  "'; a body has one joint (the model is a tree)");
    }
    joint = static_cast<int>(j);
  }
  for (std::size_t b = 0; b < d.bodies.size(); ++b) {
    if (joint_of_body[b] < 0) {
      throw std::invalid_argument(label + ": body '" + d.bodies[b].name +
                                  "': is no joint's child.body; every body needs a joint");
    }
  }
  return joint_of_body;
}

}  // namespace

RigidTransform placement(const FrameDescription& frame) {
  const Vector3& a = frame.orientation_xyz;
  return {
      turn(a.x(), Vector3::UnitX()) * turn(a.y(), Vector3::UnitY()) * turn(a.z(), Vector3::UnitZ()),
      frame.translation};
}

Model::Model(ModelDescription description) : description_(std::move(description)) {
  require_valid(description_);
  const std::size_t bodies = description_.bodies.size();
  const std::vector<int> joint_of_body = joints_of_bodies(description_, label(), *this);
  parent_.assign(bodies, -1);
  for (std::size_t b = 0; b < bodies; ++b) {
    parent_[b] = body(description_.joints[at(joint_of_body[b])].parent.body);
  }
  last_axis_.assign(bodies, -1);
  after_.resize(bodies);
  axes_to_.resize(bodies);
  add_bodies_on(-1, joint_of_body);
  if (order_.size() != bodies) {
    std::vector<bool> reached(bodies, false);
    for (int b : order_) reached[at(b)] = true;
    std::size_t lost = 0;
    while (reached[lost]) ++lost;
    throw std::invalid_argument(
        label() + ": joint '" + description_.joints[at(joint_of_body[lost])].name + "': body '" +
        description_.bodies[lost].name +
        "' hangs on itself through its parents; the tree must begin at '" + kGround + "'");
  }
  add_couplings();
  for (const SpringDescription& s : description_.springs) {
    springs_.push_back({coordinate(s.coordinate), s.stiffness, s.rest, s.viscosity});
  }
}

// Depth first, so that the axes of everything on a body are one range.
void Model::add_bodies_on(int parent, const std::vector<int>& joint_of_body) {
  for (int child = 0; child < n_bodies(); ++child) {
    if (parent_[at(child)] != parent) continue;
    const auto first = axes_.size();
    order_.push_back(child);
    add_joint(joint_of_body[at(child)], parent, child);
    const auto last = axes_.size();
    add_bodies_on(child, joint_of_body);
    for (auto a = first; a < last; ++a) axes_[a].subtree_end = n_axes();
  }
}

void Model::add_joint(int joint, int parent, int child) {
  const JointDescription& d = description_.joints[at(joint)];
  if (parent >= 0) axes_to_[at(child)] = axes_to_[at(parent)];
  int last = last_axis(parent);
  RigidTransform before = placement(d.parent);
  if (parent >= 0) before = after(parent) * before;

  const auto add_axis = [&](const AxisDescription& axis, bool rotational) {
    const Vector3 direction = axis.axis.normalized();
    if (axis.terms.empty()) {
      if (axis.constant == 0.0) return;
      if (rotational) {
        before.R = before.R * turn(axis.constant, direction);
      } else {
        before.p += before.R * direction * axis.constant;
      }
      return;
    }
    ModelAxis compiled;
    compiled.joint = joint;
    compiled.predecessor = last;
    compiled.rotational = rotational;
    compiled.before = before;
    compiled.direction = direction;
    compiled.constant = axis.constant;
    for (const TermDescription& term : axis.terms) {
      compiled.terms.push_back({coordinate(term.coordinate), term.function});
    }
    last = n_axes();
    axes_.push_back(std::move(compiled));
    axes_to_[at(child)].push_back(last);
    before = {};
  };
  for (const AxisDescription& axis : d.translations) add_axis(axis, false);
  for (const AxisDescription& axis : d.rotations) add_axis(axis, true);
  last_axis_[at(child)] = last;
  after_[at(child)] = before * placement(d.child).inverse();
}

// A coordinate may follow one that follows another; each round takes the couplings whose
// independent coordinate is set.
void Model::add_couplings() {
  dependent_.assign(description_.coordinates.size(), false);
  for (const CouplingDescription& c : description_.couplings) {
    dependent_[at(coordinate(c.dependent))] = true;
  }
  std::vector<bool> set(dependent_.size());
  for (std::size_t c = 0; c < set.size(); ++c) set[c] = !dependent_[c];
  for (std::size_t before = couplings_.size();; before = couplings_.size()) {
    for (const CouplingDescription& c : description_.couplings) {
      const int dependent = coordinate(c.dependent), independent = coordinate(c.independent);
      if (set[at(dependent)] || !set[at(independent)]) continue;
      set[at(dependent)] = true;
      couplings_.push_back({dependent, independent, c.function});
    }
    if (couplings_.size() == description_.couplings.size()) return;
    if (couplings_.size() > before) continue;
    std::size_t lost = 0;
    while (set[lost]) ++lost;
    throw std::invalid_argument(label() + ": couplings: coordinate '" +
                                description_.coordinates[lost].name +
                                "' follows itself through other couplings; a chain of couplings "
                                "must begin at a coordinate that is free");
  }
}

int Model::body(std::string_view name) const {
  if (name == kGround) return -1;
  for (std::size_t b = 0; b < description_.bodies.size(); ++b) {
    if (description_.bodies[b].name == name) return static_cast<int>(b);
  }
  throw std::invalid_argument(label() + ": no body '" + std::string(name) + "'");
}

int Model::coordinate(std::string_view name) const {
  for (std::size_t c = 0; c < description_.coordinates.size(); ++c) {
    if (description_.coordinates[c].name == name) return static_cast<int>(c);
  }
  throw std::invalid_argument(label() + ": no coordinate '" + std::string(name) + "'");
}

std::span<const int> Model::axes_to(int body) const {
  if (body < 0) return {};
  return axes_to_[at(body)];
}

int Model::parent(int body) const { return parent_[at(body)]; }

bool Model::dependent(int coordinate) const { return dependent_[at(coordinate)]; }

std::string Model::label() const { return model_label(description_); }

}  // namespace condyle::model
