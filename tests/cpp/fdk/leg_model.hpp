// SPDX-License-Identifier: Apache-2.0
// A right leg standing on one foot: thigh on a driven hip, shank on a knee of six coordinates of
// which flexion is driven and balanced by muscles and five are force-dependent; knee ligaments and
// an analytic contact between the two, a floor's reaction on the shank.
//
// Frames are turned and offset, one axis carries two functions and another a curved one: nothing is
// aligned or unit-valued.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "condyle/fdk/body_contact.hpp"
#include "condyle/fdk/force_dependent.hpp"
#include "condyle/model/ligament.hpp"
#include "condyle/model/model.hpp"
#include "fdk/analytic_contact.hpp"

namespace condyle::test {

inline constexpr int kHip = 0, kFlexion = 1;

/// F in the thigh and T in the shank; at α = 0 the knee is within a millimetre of touch.
inline RigidTransform thigh_F() {
  RigidTransform X;
  X.R = (Eigen::AngleAxisd(0.03, Vector3::UnitX()) * Eigen::AngleAxisd(-0.02, Vector3::UnitY()) *
         Eigen::AngleAxisd(0.05, Vector3::UnitZ()))
            .toRotationMatrix();
  X.p = {0.004, -0.396, 0.003};
  return X;
}
inline RigidTransform shank_T() {
  RigidTransform X;
  X.R = (Eigen::AngleAxisd(0.02, Vector3::UnitX()) * Eigen::AngleAxisd(0.01, Vector3::UnitY()) *
         Eigen::AngleAxisd(-0.03, Vector3::UnitZ()))
            .toRotationMatrix();
  X.p = {0.003, -0.0385, 0.001};
  return X;
}

namespace detail {

inline void add_leg_muscle(model::ModelDescription& d, const std::string& name, double strength,
                           double slack,
                           const std::vector<std::pair<std::string, Vector3>>& points) {
  model::MuscleDescription muscle;
  muscle.name = name;
  muscle.max_isometric_force = strength;
  muscle.optimal_fibre_length = 0.11;
  muscle.tendon_slack_length = slack;
  muscle.pennation_at_optimal = 0.15;
  for (const auto& [body, location] : points) {
    model::PathPointDescription point;
    point.body = body;
    point.location = location;
    muscle.path.points.push_back(point);
  }
  d.muscles.push_back(muscle);
}

inline void add_leg_body(model::ModelDescription& d, const std::string& name, double mass,
                         double length) {
  model::BodyDescription body;
  body.name = name;
  body.mass = mass;
  body.mass_centre = {0.011, -0.43 * length, 0.007};
  body.inertia << 0.11, 0.013, 0.12, 0.002, -0.001, 0.003;
  d.bodies.push_back(body);
}

inline void add_leg_coordinate(model::ModelDescription& d, const std::string& name, bool rotational,
                               model::CoordinateRole role) {
  model::CoordinateDescription coordinate;
  coordinate.name = name;
  coordinate.rotational = rotational;
  coordinate.range_min = -2.0;
  coordinate.range_max = 2.0;
  coordinate.role = role;
  d.coordinates.push_back(coordinate);
}

inline model::JointDescription leg_knee() {
  using model::Function;
  model::JointDescription knee;
  knee.name = "knee";
  knee.parent = {"thigh", {0.002, -0.4, 0.001}, {0.02, -0.01, 0.03}};
  knee.child = {"shank", {0.001, 0.002, -0.001}, {-0.01, 0.02, 0.01}};
  knee.rotations[0].axis = {0.02, -0.03, 1.0};
  knee.rotations[0].terms = {{"flexion", Function::linear(-1.0)}};
  knee.rotations[1].axis = {1.0, 0.04, -0.02};
  knee.rotations[1].terms = {{"adduction", Function::polynomial({0.0, 1.1, 0.2})}};
  knee.rotations[2].axis = {-0.03, 1.0, 0.05};
  knee.rotations[2].terms = {{"rotation", Function::linear(0.9)},
                             {"flexion", Function::polynomial({0.0, 0.05, 0.02})}};
  knee.translations[0].axis = {1.0, 0.02, 0.01};
  knee.translations[0].terms = {{"tx", Function::linear(1.0)}};
  knee.translations[1].axis = {0.01, 1.0, -0.03};
  knee.translations[1].terms = {{"ty", Function::polynomial({0.0, 1.2, 0.7})},
                                {"flexion", Function::linear(-0.001)}};
  knee.translations[2].axis = {0.02, -0.01, 1.0};
  knee.translations[2].terms = {{"tz", Function::linear(1.0)}};
  return knee;
}

}  // namespace detail

inline model::ModelDescription leg_model_description() {
  using model::CoordinateRole;
  model::ModelDescription d;
  d.name = "leg";
  detail::add_leg_body(d, "thigh", 7.3, 0.4);
  detail::add_leg_body(d, "shank", 4.1, 0.42);
  detail::add_leg_coordinate(d, "hip", true, CoordinateRole::kDriven);
  detail::add_leg_coordinate(d, "flexion", true, CoordinateRole::kDriven);
  d.coordinates.back().balance = model::CoordinateBalance::kMuscles;
  for (const char* name : {"adduction", "rotation"}) {
    detail::add_leg_coordinate(d, name, true, CoordinateRole::kForceDependent);
  }
  for (const char* name : {"tx", "ty", "tz"}) {
    detail::add_leg_coordinate(d, name, false, CoordinateRole::kForceDependent);
  }
  model::JointDescription hip;
  hip.name = "hip";
  hip.parent = {model::kGround, {0.1, 0.9, 0.08}, {0.05, 0.1, 0.02}};
  hip.child.body = "thigh";
  hip.rotations[0].axis = {0.05, 0.02, 1.0};
  hip.rotations[0].terms = {{"hip", model::Function::linear(1.0)}};
  d.joints = {hip, detail::leg_knee()};
  d.springs.push_back({"rotation", 4.0, 0.02, 0.3});
  detail::add_leg_muscle(d, "quadriceps_medial", 2100.0, 0.26,
                         {{"thigh", {0.03, -0.12, -0.01}},
                          {"thigh", {0.052, -0.39, -0.006}},
                          {"shank", {0.042, -0.07, 0.002}}});
  detail::add_leg_muscle(d, "quadriceps_lateral", 2600.0, 0.26,
                         {{"thigh", {0.03, -0.11, 0.02}},
                          {"thigh", {0.051, -0.39, 0.012}},
                          {"shank", {0.042, -0.07, 0.004}}});
  detail::add_leg_muscle(d, "hamstring_medial", 1300.0, 0.30,
                         {{"thigh", {-0.04, -0.03, -0.02}}, {"shank", {-0.025, -0.05, -0.025}}});
  detail::add_leg_muscle(d, "hamstring_lateral", 1100.0, 0.30,
                         {{"thigh", {-0.04, -0.03, 0.02}}, {"shank", {-0.02, -0.04, 0.035}}});
  const RigidTransform X_BF = thigh_F(), X_BT = shank_T();
  Pose reference = Pose::Zero();
  reference[kY] = 0.042;
  for (const model::Ligament& bundle : model::default_ligaments(SideOfBody::kRight, reference)) {
    model::LigamentDescription ligament;
    ligament.name = bundle.name;
    ligament.stiffness = bundle.stiffness;
    ligament.slack_length = bundle.slack_length;
    ligament.transition_strain = bundle.transition;
    ligament.path.points.resize(2);
    ligament.path.points[0].body = "thigh";
    ligament.path.points[0].location = X_BF * bundle.p_FoA_F;
    ligament.path.points[1].body = "shank";
    ligament.path.points[1].location = X_BT * bundle.p_ToB_T;
    d.ligaments.push_back(ligament);
  }
  return d;
}

/// The same leg with a patella that floats: on springs across the thigh, between quadriceps and a
/// patellar ligament; the quadriceps end on it and have no moment arm on flexion.
inline model::ModelDescription patella_model_description() {
  model::ModelDescription d = leg_model_description();
  detail::add_leg_body(d, "patella", 0.1, 0.04);
  for (const char* name : {"patella_x", "patella_y"}) {
    detail::add_leg_coordinate(d, name, false, model::CoordinateRole::kForceDependent);
  }
  model::JointDescription joint;
  joint.name = "patella";
  joint.parent = {"thigh", {0.053, -0.39, 0.003}, {0.01, 0.02, -0.03}};
  joint.child.body = "patella";
  joint.translations[0].axis = Vector3::UnitX();
  joint.translations[0].terms = {{"patella_x", model::Function::linear(1.0)}};
  joint.translations[1].axis = Vector3::UnitY();
  joint.translations[1].terms = {{"patella_y", model::Function::linear(1.0)}};
  d.joints.push_back(joint);
  d.springs.push_back({"patella_x", 2.0e5, 0.0, 0.0});
  d.springs.push_back({"patella_y", 4.0e2, 0.0, 0.0});
  model::PathPointDescription patella, tuberosity;
  patella.body = "patella";
  tuberosity.body = "shank";
  tuberosity.location = {0.042, -0.07, 0.003};
  for (std::size_t i : {0, 1}) d.muscles[i].path.points = {d.muscles[i].path.points[0], patella};
  for (std::size_t i : {0, 1}) d.muscles[i].tendon_slack_length = 0.17;
  model::LigamentDescription ligament;
  ligament.name = "patellar";
  ligament.law = model::LigamentLaw::kLinear;
  ligament.stiffness = 4.0e5;
  ligament.slack_length = 0.08;
  ligament.path.points = {patella, tuberosity};
  d.ligaments.push_back(ligament);
  return d;
}

inline fdk::BodyContactDescription leg_contact(const contact::ContactModel& model) {
  return {"tibiofemoral", &model, "thigh", "shank", thigh_F(), shank_T(), SideOfBody::kRight};
}

/// Standing at a knee's flexion, in motion; the floor pushes `reaction` up 2 cm behind the knee.
inline fdk::FrameInstant leg_instant(const model::Model& model, double flexion,
                                     double reaction = 650.0, double behind = 0.02) {
  fdk::FrameInstant instant;
  instant.q.setZero(model.n_coordinates());
  instant.qd = instant.qdd = instant.q;
  instant.q[kHip] = 0.5 * flexion;
  instant.q[kFlexion] = flexion;
  instant.qd[kHip] = 0.4;
  instant.qd[kFlexion] = 0.9;
  instant.qdd[kHip] = 1.3;
  instant.qdd[kFlexion] = -2.1;
  model::Kinematics kinematics(model);
  kinematics.set(instant.q);
  const Vector3 knee = kinematics.X_GB(model.body("shank")).p;
  instant.loads.push_back({model.body("shank"),
                           {0.05 * reaction, reaction, 0.02 * reaction},
                           knee + Vector3(-behind, -0.42, -0.004),
                           {0.3, 1.1, -0.2}});
  return instant;
}

}  // namespace condyle::test
