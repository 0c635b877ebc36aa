// SPDX-License-Identifier: Apache-2.0
// Where everything is and how it moves, at one configuration of a model.
//
// All vectors are expressed in ground. A Kinematics object is the workspace of one thread: it
// allocates when it is made and never again.
//
// With S_a the motion of axis a as a twist at ground's origin (turn: ω = direction, v = point ×
// direction; slide: v = direction):
//
//   V_a = V_before + S_a ṁ_a,   A_a = A_before + S_a m̈_a + V_a × S_a ṁ_a,
//   ṁ_a = Σ f'(q) q̇,   m̈_a = Σ f'(q) q̈ + f''(q) q̇²
//
// A coupling dependent = g(independent) is put into the functions: the terms name the independent
// coordinate alone, and carry the derivatives of f∘g. What is written with the terms is right for
// coupled coordinates without another word.
//
// Source: Featherstone 2008, Rigid Body Dynamics Algorithms, ch. 2 and 5,
// doi:10.1007/978-1-4899-7560-7.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "condyle/common/types.hpp"
#include "condyle/model/model.hpp"

namespace condyle::model {

/// An elementary motion where it is now.
struct AxisNow {
  bool rotational = false;
  Vector3 direction = Vector3::Zero();  ///< unit
  Vector3 point = Vector3::Zero();      ///< on the line of a turn [m]
};

/// ∂m_a/∂q_c and the higher derivatives, at this configuration.
struct TermNow {
  int axis = 0;
  int coordinate = 0;  ///< never a dependent one
  double slope = 0.0, curvature = 0.0, third = 0.0;
};

/// A coordinate as a function of a free one: of itself, or of the one that couplings make it
/// follow.
struct CoordinateNow {
  int independent = 0;
  double slope = 1.0, curvature = 0.0, third = 0.0;  ///< derivatives by the independent one
};

class Kinematics {
 public:
  /// @pre the model outlives it.
  explicit Kinematics(const Model& model);

  const Model& model() const { return *model_; }

  /// Places the bodies, at rest. @param q (n_coordinates) [rad, m]; dependent coordinates are set
  /// from those they follow.
  /// @throws std::invalid_argument for another length or a value that is not finite, naming the
  /// coordinate.
  void set(const Eigen::Ref<const Eigen::VectorXd>& q);
  /// Places and moves the bodies. @param qd, qdd likewise [rad/s, m/s, rad/s², m/s²].
  void set(const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& qd,
           const Eigen::Ref<const Eigen::VectorXd>& qdd);

  /// As set, with dependent coordinates filled in.
  const Eigen::VectorXd& q() const { return q_; }
  const Eigen::VectorXd& qd() const { return qd_; }
  const Eigen::VectorXd& qdd() const { return qdd_; }
  /// What a coordinate follows. It turns a load on, or a derivative by, a coordinate into one of a
  /// free coordinate.
  const CoordinateNow& coordinate(int c) const { return follows_[static_cast<std::size_t>(c)]; }

  /// Placement of a body in ground; the identity for ground (−1).
  const RigidTransform& X_GB(int body) const { return X_GB_[static_cast<std::size_t>(body + 1)]; }
  /// The axes of `Model::axes()` as they stand.
  std::span<const AxisNow> axes() const { return axes_; }
  /// The functions' derivatives; those of one axis are adjacent.
  std::span<const TermNow> terms() const { return terms_; }
  std::span<const TermNow> terms(int axis) const {
    const auto first = static_cast<std::size_t>(first_term_[static_cast<std::size_t>(axis)]);
    const auto end = static_cast<std::size_t>(first_term_[static_cast<std::size_t>(axis) + 1]);
    return terms().subspan(first, end - first);
  }
  /// Where the terms of an axis begin in terms().
  int first_term(int axis) const { return first_term_[static_cast<std::size_t>(axis)]; }

  /// Velocity of a body: of the point that is at ground's origin, and angular [m/s, rad/s].
  struct Twist {
    Vector3 v = Vector3::Zero(), w = Vector3::Zero();
  };
  Twist twist(int body) const { return axis_twist(model_->last_axis(body)); }
  /// Its time derivative, in ground: (d/dt v, d/dt ω) [m/s², rad/s²]. The acceleration of the
  /// body's point at p_G is v̇ + ω̇ × p_G + ω × (v + ω × p_G).
  Twist twist_rate(int body) const { return axis_twist_rate(model_->last_axis(body)); }
  /// The same of the frame after axis a; zero for ground (−1).
  const Twist& axis_twist(int axis) const { return twists_[static_cast<std::size_t>(axis + 1)]; }
  const Twist& axis_twist_rate(int axis) const {
    return rates_[static_cast<std::size_t>(axis + 1)];
  }

  /// Velocity of a point of a body, at p_G [m/s].
  Vector3 point_velocity(int body, const Vector3& p_G) const {
    const Twist& V = axis_twist(model_->last_axis(body));
    return V.v + V.w.cross(p_G);
  }

  /// Velocity of the point of a body at p_G per unit rate of axis a. @pre a is among the axes to
  /// the body.
  Vector3 point_derivative(int axis, const Vector3& p_G) const {
    const AxisNow& now = axes()[static_cast<std::size_t>(axis)];
    if (!now.rotational) return now.direction;
    return now.direction.cross(Vector3(p_G - now.point));
  }

 private:
  void require(const char* what, const Eigen::Ref<const Eigen::VectorXd>& given) const;
  void follow_couplings();
  void place();
  void move();

  const Model* model_;
  Eigen::VectorXd q_, qd_, qdd_;
  std::vector<CoordinateNow> follows_;
  std::vector<AxisNow> axes_;
  std::vector<TermNow> terms_;
  std::vector<int> first_term_;
  std::vector<RigidTransform> X_GA_;   // frame after each axis
  std::vector<RigidTransform> X_GB_;   // ground first
  std::vector<Twist> twists_, rates_;  // of frames after axes; ground first
};

}  // namespace condyle::model
