// SPDX-License-Identifier: Apache-2.0
// A tree of bodies in which nothing is aligned, unit-valued or in order, for laws of multibody
// mechanics.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "condyle/model/model_description.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

/// Names of a random model's coordinates: q0, q1, …
inline std::string coordinate_name(int number) {
  std::string name = "q";
  name += std::to_string(number);
  return name;
}

inline Vector3 random_vector(Draw& draw, double size) {
  return {draw(-size, size), draw(-size, size), draw(-size, size)};
}

inline model::FrameDescription random_frame(Draw& draw, const std::string& body) {
  return {body, random_vector(draw, 0.3), random_vector(draw, 1.5)};
}

/// Mass centre and inertia of a cloud of points: always that of a body.
inline model::BodyDescription random_body(Draw& draw, const std::string& name) {
  model::BodyDescription body;
  body.name = name;
  body.mass = draw(0.5, 4.0);
  body.mass_centre = random_vector(draw, 0.2);
  Matrix3 J = Matrix3::Zero();
  for (int i = 0; i < 5; ++i) {
    const Vector3 r = random_vector(draw, 0.2);
    J += body.mass / 5.0 * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  }
  body.inertia << J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(0, 2), J(1, 2);
  return body;
}

/// Linear, polynomial or SIMM spline by turns, of slopes about 1 and visible curvature over [−2,
/// 2].
inline model::Function random_function(Draw& draw, int kind) {
  if (kind % 3 == 0) return model::Function::linear(draw(0.4, 1.3), draw(-0.2, 0.2));
  if (kind % 3 == 1) {
    return model::Function::polynomial(
        {draw(-0.2, 0.2), draw(-0.9, 0.9), draw(-0.4, 0.4), draw(-0.1, 0.1)});
  }
  std::vector<double> x, y;
  for (double knot = -2.0; knot < 2.2; knot += draw(0.5, 0.8)) {
    x.push_back(knot);
    y.push_back(0.5 * knot + draw(-0.2, 0.2));
  }
  return model::Function::spline(model::FunctionKind::kSimmSpline, x, y);
}

/// Seven bodies: a trunk on a joint of six axes, branches, two bodies welded on; eleven
/// coordinates, several of which move more than one axis; bodies and joints listed in no order.
/// `couplings`: two coordinates follow, in a chain.
inline model::ModelDescription random_model(std::uint64_t seed, bool couplings = true) {
  Draw draw(seed);
  model::ModelDescription d;
  d.name = "random";
  d.gravity = {1.1, -9.3, 2.7};
  for (int c = 0; c < 11; ++c) {
    model::CoordinateDescription coordinate;
    coordinate.name = coordinate_name(c);
    coordinate.range_min = -2.0;
    coordinate.range_max = 2.0;
    d.coordinates.push_back(coordinate);
  }
  const std::vector<std::pair<std::string, std::string>> tree{
      {"trunk", "ground"}, {"thigh", "trunk"}, {"patella", "thigh"}, {"shank", "thigh"},
      {"foot", "shank"},   {"boot", "foot"},   {"arm", "trunk"}};
  int axis_number = 0;
  for (const auto& [child, parent] : tree) {
    d.bodies.push_back(random_body(draw, child));
    model::JointDescription joint;
    joint.name = "to_" + child;
    joint.parent = random_frame(draw, parent);
    joint.child = random_frame(draw, child);
    const auto fill = [&](std::array<model::AxisDescription, 3>& axes) {
      for (model::AxisDescription& axis : axes) {
        axis.axis = random_vector(draw, 1.0);
        axis.constant = draw(-0.3, 0.3);
        ++axis_number;
        if (child == "boot" || (child != "trunk" && axis_number % 7 == 0)) continue;
        // Trunk: q0 … q5, one each. Elsewhere q6 … q10 come back again and again.
        const int c = child == "trunk" ? axis_number - 1 : 6 + axis_number % 5;
        axis.terms.push_back({coordinate_name(c), random_function(draw, axis_number)});
        if (axis_number % 4 == 0) {
          axis.terms.push_back({coordinate_name(c == 7 ? 9 : 7), random_function(draw, 2)});
        }
      }
    };
    fill(joint.rotations);
    fill(joint.translations);
    d.joints.push_back(joint);
  }
  std::rotate(d.bodies.begin(), d.bodies.begin() + 4, d.bodies.end());
  std::reverse(d.joints.begin(), d.joints.end());
  if (couplings) {
    // q10 follows q9, which follows q3: listed so that the chain is not in order.
    d.couplings.push_back({"q10", "q9", random_function(draw, 2)});
    d.couplings.push_back({"q9", "q3", random_function(draw, 1)});
  }
  return d;
}

/// A smooth motion: q(t) with amplitudes about 1, and its derivatives.
struct Motion {
  Eigen::VectorXd middle, amplitude, frequency, phase;
  Motion(Draw& draw, int n) : middle(n), amplitude(n), frequency(n), phase(n) {
    for (int c = 0; c < n; ++c) {
      middle[c] = draw(-0.4, 0.4);
      amplitude[c] = draw(0.3, 0.8);
      frequency[c] = draw(1.0, 3.0);
      phase[c] = draw(-3.0, 3.0);
    }
  }
  Eigen::VectorXd q(double t) const { return at(t, 0); }
  Eigen::VectorXd qd(double t) const { return at(t, 1); }
  Eigen::VectorXd qdd(double t) const { return at(t, 2); }

 private:
  Eigen::VectorXd at(double t, int order) const {
    Eigen::VectorXd value(middle.size());
    for (int c = 0; c < value.size(); ++c) {
      const double w = frequency[c], a = w * t + phase[c];
      value[c] = order == 0   ? middle[c] + amplitude[c] * std::sin(a)
                 : order == 1 ? amplitude[c] * w * std::cos(a)
                              : -amplitude[c] * w * w * std::sin(a);
    }
    return value;
  }
};

}  // namespace condyle::test
