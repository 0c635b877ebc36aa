// SPDX-License-Identifier: Apache-2.0
// A tree in a general pose for tests of paths: pelvis – thigh – shank, a patella on the thigh,
// wraps to be added.
//
// Frames are turned and moved, axes are oblique, the knee's slides are splines and polynomials of
// its flexion, and one coordinate follows another.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "condyle/model/kinematics.hpp"
#include "condyle/model/model.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

namespace detail {

inline model::FrameDescription frame(const std::string& body, Draw& draw, double reach = 0.05) {
  return {body,
          {draw(-reach, reach), draw(-reach, reach), draw(-reach, reach)},
          {draw(-0.6, 0.6), draw(-0.6, 0.6), draw(-0.6, 0.6)}};
}

inline model::AxisDescription axis(Draw& draw, int main_axis, const std::string& coordinate) {
  model::AxisDescription a;
  a.axis = Vector3(draw(-0.3, 0.3), draw(-0.3, 0.3), draw(-0.3, 0.3));
  a.axis[main_axis] = 1.3;
  if (!coordinate.empty()) a.terms = {{coordinate, model::Function::linear(1.0)}};
  return a;
}

/// Six axes, x-y-z turns and slides; an empty name: a constant axis.
inline model::JointDescription joint(const std::string& name, const std::string& parent,
                                     const std::string& child,
                                     const std::array<std::string, 6>& coordinates, Draw& draw) {
  model::JointDescription j;
  j.name = name;
  j.parent = frame(parent, draw, 0.2);
  j.child = frame(child, draw);
  for (std::size_t k = 0; k < 3; ++k) {
    j.rotations[k] = axis(draw, static_cast<int>(k), coordinates[k]);
    j.translations[k] = axis(draw, static_cast<int>(k), coordinates[k + 3]);
    if (coordinates[k].empty()) j.rotations[k].constant = draw(-0.2, 0.2);
    if (coordinates[k + 3].empty()) j.translations[k].constant = draw(-0.02, 0.02);
  }
  return j;
}

}  // namespace detail

inline model::ModelDescription path_model_description() {
  using model::Function;
  using model::FunctionKind;
  Draw draw(271);
  model::ModelDescription m;
  m.name = "path test";
  for (const char* name : {"pelvis", "thigh", "shank", "patella"}) {
    model::BodyDescription body;
    body.name = name;
    body.mass = 3.1;
    body.inertia << 0.021, 0.019, 0.025, 0.001, -0.002, 0.0015;
    m.bodies.push_back(body);
  }
  m.joints.push_back(
      detail::joint("root", "ground", "pelvis", {"list", "turn", "tilt", "px", "py", "pz"}, draw));
  m.joints.push_back(
      detail::joint("hip", "pelvis", "thigh", {"hip_x", "", "hip_z", "", "", ""}, draw));
  m.joints.push_back(detail::joint("knee", "thigh", "shank",
                                   {"adduction", "rotation", "flexion", "", "ty", "tz"}, draw));
  m.joints.push_back(detail::joint("patellofemoral", "thigh", "patella",
                                   {"", "", "pat_flexion", "pat_x", "", ""}, draw));
  // The knee: its first slide is a spline of flexion, the second has a spline beside its own
  // coordinate.
  model::JointDescription& knee = m.joints[2];
  knee.translations[0].terms = {
      {"flexion", Function::spline(FunctionKind::kNaturalCubicSpline, {-1.3, -0.4, 0.35, 1.2},
                                   {0.012, 0.003, -0.007, 0.004})}};
  knee.translations[1].terms.push_back(
      {"flexion", Function::polynomial({0.01, -0.013, 0.007, 0.0031})});
  knee.rotations[1].terms.push_back({"flexion", Function::polynomial({0.0, 0.11, -0.05})});
  knee.parent.translation = Vector3(0.013, -0.4, 0.021);
  for (const char* name : {"list", "turn", "tilt", "px", "py", "pz", "hip_x", "hip_z", "adduction",
                           "rotation", "flexion", "ty", "tz", "pat_flexion", "pat_x"}) {
    model::CoordinateDescription c;
    c.name = name;
    c.range_min = -1.5;
    c.range_max = 1.5;
    m.coordinates.push_back(c);
  }
  m.couplings = {{"pat_flexion", "flexion", Function::polynomial({0.05, -0.61, 0.17})}};
  return m;
}

inline model::WrapDescription cylinder(const std::string& name, const std::string& body,
                                       const Vector3& centre, const Vector3& angles, double radius,
                                       double length = 0.9, const std::string& quadrant = "all") {
  model::WrapDescription w;
  w.name = name;
  w.frame = {body, centre, angles};
  w.dimensions = Vector3(radius, length, 0.0);
  w.quadrant = quadrant;
  return w;
}

inline model::PathPointDescription point(const std::string& body, const Vector3& location) {
  model::PathPointDescription p;
  p.body = body;
  p.location = location;
  return p;
}

/// A cylinder on `body` that the segment p → q of a pose (points of bodies) pierces: its axis is
/// oblique to the segment and passes it at 0.35 of the radius, at a fraction of its length.
inline model::WrapDescription piercing_cylinder(const std::string& name,
                                                const model::Kinematics& at,
                                                const model::PathPointDescription& p,
                                                const model::PathPointDescription& q,
                                                const std::string& body, double fraction,
                                                double radius, Draw& draw) {
  const model::Model& m = at.model();
  const Vector3 a = at.X_GB(m.body(p.body)) * p.location, b = at.X_GB(m.body(q.body)) * q.location;
  const Vector3 along = (b - a).normalized();
  const Vector3 other(draw(-1.0, 1.0), draw(-1.0, 1.0), draw(-1.0, 1.0));
  const Vector3 across = along.cross(other).normalized();
  RigidTransform X_GC;
  X_GC.R.col(2) = (across + draw(-0.4, 0.4) * along).normalized();
  X_GC.R.col(0) = X_GC.R.col(2).cross(along).normalized();
  X_GC.R.col(1) = X_GC.R.col(2).cross(X_GC.R.col(0));
  X_GC.p =
      a + fraction * (b - a) - 0.35 * radius * X_GC.R.col(0) + draw(-0.02, 0.02) * X_GC.R.col(2);
  const RigidTransform X_BC = at.X_GB(m.body(body)).inverse() * X_GC;
  const Matrix3& R = X_BC.R;
  const Vector3 angles(std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)),
                       std::atan2(-R(0, 1), R(0, 0)));
  return cylinder(name, body, X_BC.p, angles, radius);
}

/// Angles within ±0.6, slides within ±2 cm.
inline Eigen::VectorXd general_q(const model::Model& m, Draw& draw) {
  Eigen::VectorXd q(m.n_coordinates());
  for (int c = 0; c < m.n_coordinates(); ++c) {
    const std::string& name = m.description().coordinates[static_cast<std::size_t>(c)].name;
    const bool slide =
        name[0] == 'p' ? name.size() < 3 || name == "pat_x" : name == "ty" || name == "tz";
    q[c] = slide ? draw(-0.02, 0.02) : draw(-0.6, 0.6);
  }
  return q;
}

}  // namespace condyle::test
