// SPDX-License-Identifier: Apache-2.0
// A musculoskeletal model, checked and compiled: names are indices, joints are chains of elementary
// axes.
//
// Every joint axis that depends on a coordinate is one elementary motion: a slide along, or a turn
// about, a line fixed in what comes before it. Its amount is m_a = constant + Σ f(q). Kinematics,
// dynamics and paths are written in the amounts m (each of them a plain one-degree-of-freedom
// joint), and the chain rule through f gives everything in the coordinates q.
//
//   X_GB = … · before_a · E_a(m_a) · … · after_B
//   E_a(m): slide by m·direction, or turn by m about direction
//
// Axes of a joint that depend on nothing are folded into the fixed placements `before` and `after`.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/model/model_description.hpp"

namespace condyle::model {

/// One elementary motion. Axes are numbered so that what a body hangs on comes before it, and so
/// that all that an axis moves, of axes, is the range [own number, subtree_end).
struct ModelAxis {
  int joint = 0;
  int predecessor = -1;  ///< the axis before it on the way from ground; −1: ground
  int subtree_end = 0;   ///< one past the last axis that hangs on this one
  bool rotational = false;
  RigidTransform before;                ///< fixed placement in the frame after its predecessor
  Vector3 direction = Vector3::Zero();  ///< unit, in the frame that `before` places
  double constant = 0.0;
  struct Term {
    int coordinate = 0;
    Function function;
  };
  std::vector<Term> terms;  ///< at least one
};

/// dependent = function(independent), by index.
struct ModelCoupling {
  int dependent = 0, independent = 0;
  Function function;
};

/// Generalised force −stiffness·(q − rest) − viscosity·q̇ on a coordinate, by index.
struct ModelSpring {
  int coordinate = 0;
  double stiffness = 0.0, rest = 0.0, viscosity = 0.0;
};

class Model {
 public:
  /// @throws std::invalid_argument naming source, list, item, field, value and limit: no body of
  /// that name, a loop in the tree, a body without a joint, a mass or an
  /// inertia below 0, a path of one point, an axis of length 0…
  explicit Model(ModelDescription description);

  const ModelDescription& description() const { return description_; }

  int n_bodies() const { return static_cast<int>(description_.bodies.size()); }
  int n_coordinates() const { return static_cast<int>(description_.coordinates.size()); }
  int n_axes() const { return static_cast<int>(axes_.size()); }

  /// Index of a body; −1 for "ground". @throws std::invalid_argument naming the model and the name.
  int body(std::string_view name) const;
  /// Index of a coordinate. @throws likewise.
  int coordinate(std::string_view name) const;

  const std::vector<ModelAxis>& axes() const { return axes_; }
  /// The axes between ground and a body, ascending; empty for ground (−1).
  std::span<const int> axes_to(int body) const;
  /// The last of them: the one the body is fixed to; −1 where nothing moves it.
  int last_axis(int body) const {
    return body < 0 ? -1 : last_axis_[static_cast<std::size_t>(body)];
  }
  /// Fixed placement of a body in the frame after its last axis (in ground where it has none).
  /// @pre body ≥ 0.
  const RigidTransform& after(int body) const { return after_[static_cast<std::size_t>(body)]; }
  /// The body that the body's joint hangs it on; −1: ground.
  int parent(int body) const;
  /// Bodies in an order in which parents come first.
  std::span<const int> order() const { return order_; }

  /// Couplings in an order in which a coordinate is set before those that follow it.
  const std::vector<ModelCoupling>& couplings() const { return couplings_; }
  const std::vector<ModelSpring>& springs() const { return springs_; }
  /// Whether a coupling sets the coordinate.
  bool dependent(int coordinate) const;

 private:
  void add_bodies_on(int parent, const std::vector<int>& joint_of_body);
  void add_joint(int joint, int parent, int child);
  void add_couplings();
  std::string label() const;

  ModelDescription description_;
  std::vector<ModelAxis> axes_;
  std::vector<int> parent_, last_axis_, order_;
  std::vector<RigidTransform> after_;
  std::vector<std::vector<int>> axes_to_;
  std::vector<ModelCoupling> couplings_;
  std::vector<ModelSpring> springs_;
  std::vector<bool> dependent_;
};

/// Placement of a frame in its body: translation, and R = Rx·Ry·Rz of its orientation.
RigidTransform placement(const FrameDescription& frame);

}  // namespace condyle::model
