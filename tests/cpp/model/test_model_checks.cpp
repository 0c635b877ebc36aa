// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "condyle/model/model_checks.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

FrameDescription frame(const char* body) {
  FrameDescription f;
  f.body = body;
  return f;
}

// A model with one of everything that a description can hold.
ModelDescription description() {
  ModelDescription d = test::random_model(4);
  d.source = "walker.json";
  d.springs.push_back({"q6", 3.0, 0.1, 0.2});
  WrapDescription wrap;
  wrap.name = "condyles";
  wrap.frame.body = "thigh";
  wrap.dimensions = {0.03, 0.11, 0.0};
  d.wraps.push_back(wrap);
  PathDescription path;
  path.points.resize(2);
  path.points[0].body = "thigh";
  path.points[1].body = "shank";
  path.points[1].location = {0.01, -0.2, 0.03};
  path.points[1].moving[1].push_back({"q6", Function::linear(0.1)});
  path.wraps.push_back({"condyles"});
  d.muscles.push_back({"vastus", 900.0, 0.09, 0.2, 0.1, 10.0, path});
  LigamentDescription ligament;
  ligament.name = "mcl";
  ligament.stiffness = 2000.0;
  ligament.slack_length = 0.09;
  ligament.path = path;
  d.ligaments.push_back(ligament);
  d.markers.push_back({"heel", "foot", {0.0, 0.1, 0.2}});
  d.contact_surfaces.push_back({"insert", frame("shank"), "insert.stl"});
  d.contact_surfaces.push_back({"femur", frame("thigh"), "femur.stl"});
  d.contact_pairs.push_back({"knee", "insert", "femur", 463e6, 0.46, 0.01});
  return d;
}

struct Fault {
  const char* message;
  std::function<void(ModelDescription&)> spoil;
};

}  // namespace

TEST_CASE("a sound description passes; gravity may be absent and ranges endless [property]") {
  ModelDescription d = description();
  CHECK_NOTHROW(require_valid(d));
  d.gravity.setZero();
  d.coordinates[0].range_min = -INFINITY;
  d.coordinates[0].range_max = INFINITY;
  d.bodies[1].mass = 0.0;
  d.bodies[1].inertia.setZero();
  CHECK_NOTHROW(require_valid(d));
}

TEST_CASE("each fault is named with source, list, item, field, value and limit [error]") {
  const Fault faults[] = {
      {"walker.json: body 'foot': mass is -0.5 kg; it must be at least 0",
       [](auto& d) { d.bodies[0].mass = -0.5; }},
      {"walker.json: body 'foot': inertia has principal moments (-0.1, 0.2, 0.4) kg m²; none may be "
       "below 0",
       [](auto& d) { d.bodies[0].inertia << 0.4, -0.1, 0.2, 0, 0, 0; }},
      {"walker.json: body 'foot': mass_centre is (0, nan, 0) m; it must be finite",
       [](auto& d) {
         d.bodies[0].mass_centre = {0, NAN, 0};
       }},
      {"walker.json: body 'boot': name is given twice; names are unique in their list",
       [](auto& d) { d.bodies[0].name = "boot"; }},
      {"walker.json: body 'ground': name is taken by what does not move",
       [](auto& d) { d.bodies[0].name = "ground"; }},
      {"walker.json: coordinate number 2: name is empty",
       [](auto& d) { d.coordinates[2].name.clear(); }},
      {"walker.json: coordinate 'q1': range is [0.3, 0.2] rad; it must not descend",
       [](auto& d) { d.coordinates[1].range_min = 0.3, d.coordinates[1].range_max = 0.2; }},
      {"walker.json: joint 'to_arm': parent.body is 'tibia_r'; the model has no such body",
       [](auto& d) { d.joints[0].parent.body = "tibia_r"; }},
      {"walker.json: joint 'to_arm': child.body is 'ground'; ground has no joint",
       [](auto& d) { d.joints[0].child.body = "ground"; }},
      {"walker.json: joint 'to_arm': rotations[1].axis is (0, 0, 0); its length must be above 0",
       [](auto& d) { d.joints[0].rotations[1].axis.setZero(); }},
      {"walker.json: joint 'to_arm': translations[0].terms[0].coordinate is 'knee'; the model has "
       "no "
       "such coordinate",
       [](auto& d) {
         d.joints[0].translations[0].terms = {{"knee", Function::linear(1.3)}};
       }},
      {"walker.json: coupling 'q9': dependent is given twice; a coordinate follows one other",
       [](auto& d) { d.couplings[0].dependent = "q9"; }},
      {"walker.json: coupling 'q10': function: coefficient is nan; it must be finite",
       [](auto& d) { d.couplings[0].function = Function::linear(NAN); }},
      {"walker.json: spring 'q6': stiffness is -3; it must be at least 0",
       [](auto& d) { d.springs[0].stiffness = -3.0; }},
      {"walker.json: wrap 'condyles': radius is 0 m; it must be above 0",
       [](auto& d) { d.wraps[0].dimensions[0] = 0.0; }},
      {"walker.json: wrap 'condyles': quadrant is 'up'; it must be one of all, x, -x, y, -y, z, -z",
       [](auto& d) { d.wraps[0].quadrant = "up"; }},
      {"walker.json: muscle 'vastus': max_isometric_force is 0 N; it must be above 0",
       [](auto& d) { d.muscles[0].max_isometric_force = 0.0; }},
      {"walker.json: muscle 'vastus': path.points has 1; a path needs at least 2",
       [](auto& d) { d.muscles[0].path.points.pop_back(); }},
      {"walker.json: muscle 'vastus': path.points[1].body is 'fibula'; the model has no such body",
       [](auto& d) { d.muscles[0].path.points[1].body = "fibula"; }},
      {"walker.json: muscle 'vastus': path.points[1].moving.y[0].coordinate is 'knee'; the model "
       "has "
       "no such coordinate",
       [](auto& d) { d.muscles[0].path.points[1].moving[1][0].coordinate = "knee"; }},
      {"walker.json: muscle 'vastus': path.wraps[0].wrap is 'patella'; the model has no such wrap",
       [](auto& d) { d.muscles[0].path.wraps[0].wrap = "patella"; }},
      {"walker.json: muscle 'vastus': path.wraps[0].last_point is 2; it must be -1 to 1, the "
       "points "
       "of the path",
       [](auto& d) { d.muscles[0].path.wraps[0].last_point = 2; }},
      {"walker.json: ligament 'mcl': slack_length is 0 m; it must be above 0",
       [](auto& d) { d.ligaments[0].slack_length = 0.0; }},
      {"walker.json: marker 'heel': body is 'fibula'; the model has no such body",
       [](auto& d) { d.markers[0].body = "fibula"; }},
      {"walker.json: contact surface 'insert': frame.body is 'fibula'; the model has no such body",
       [](auto& d) { d.contact_surfaces[0].frame.body = "fibula"; }},
      {"walker.json: contact pair 'knee': second is 'button'; the model has no such contact "
       "surface",
       [](auto& d) { d.contact_pairs[0].second = "button"; }},
      {"walker.json: gravity is (0, inf, 0) m/s²; it must be finite",
       [](auto& d) {
         d.gravity = {0, INFINITY, 0};
       }},
  };
  for (const Fault& fault : faults) {
    ModelDescription d = description();
    fault.spoil(d);
    CHECK_THROWS_WITH_AS(require_valid(d), fault.message, std::invalid_argument);
  }
}
