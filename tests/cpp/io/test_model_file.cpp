// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <iterator>
#include <limits>
#include <stdexcept>

#include "condyle/io/model_file.hpp"
#include "io/scratch_file.hpp"

using namespace condyle::model;
using condyle::Vector3;
using condyle::io::model_text;
using condyle::io::parse_model;
using condyle::io::read_model_file;
using condyle::io::write_model_file;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

FrameDescription frame(const char* body, double shift) {
  return {body, {shift, -0.31, 1.0 / 3.0}, {0.1, shift, -0.2}};
}

PathDescription path() {
  PathPointDescription first, second;
  first.body = "ground";
  first.location = {0.1, 0.2, 0.3};
  second.body = "shank";
  second.location = {-0.1, 1e-17, 0.7};
  second.moving[1] = {{"knee", Function::spline(FunctionKind::kPiecewiseLinear, {0, 0.5, 2}, {1e-3, 2e-3, -1e-3})}};
  second.condition_coordinate = "knee";
  second.condition_min = -0.25;
  second.condition_max = 2.125;
  return {{first, second}, {{"roller", "midpoint", 0, 1}, {"ball", "hybrid", -1, -1}}};
}

/// One of everything, with no value that is a default.
ModelDescription everything() {
  ModelDescription model;
  model.name = "all \"kinds\"";
  model.provenance = "a test";
  model.gravity = {0.25, -1.62, 0.125};
  model.bodies = {{"shank", 3.7, {0.01, -0.2, 0.003}, {0, 0, 0, 0, 0, 0}, {"a.stl", "b/c.obj"}}};
  model.bodies[0].inertia << 0.05, 0.004, 0.06, 1e-4, -2e-4, 3e-5;
  JointDescription joint;
  joint.name = "knee_joint";
  joint.parent = frame("ground", 0.4);
  joint.child = frame("shank", -0.6);
  for (std::size_t i = 0; i < 3; ++i) {
    joint.rotations[i].axis = Vector3(0.2, 0.3, 0.4 + 0.1 * static_cast<double>(i));
    joint.translations[i].axis = Vector3(-0.7, 0.3, 0.1 * static_cast<double>(i));
    joint.rotations[i].constant = -0.37;
  }
  joint.rotations[0].terms = {{"knee", Function::linear(-1.25, 0.5)},
                              {"slide", Function::polynomial({0.1, -0.2, 0.3})}};
  joint.translations[2].terms = {
      {"knee", Function::spline(FunctionKind::kSimmSpline, {-1, 0.2, 1.7, 2.1}, {0.3, 0.1, 0.7, 0.2})}};
  model.joints = {joint};
  model.coordinates = {
      {"knee", true, 0.3, -0.2, 2.2, true, CoordinateRole::kForceDependent, CoordinateBalance::kMuscles},
      {"slide", false, 0.01, -0.02, 0.03, false, CoordinateRole::kDriven, CoordinateBalance::kReaction}};
  model.couplings = {{"slide", "knee",
                      Function::spline(FunctionKind::kNaturalCubicSpline, {0, 1, 2}, {0.01, 0.02, 0.04})}};
  model.springs = {{"knee", 12.5, 0.25, 0.75}};
  model.wraps = {{"roller", WrapKind::kCylinder, frame("shank", 0.1), {0.02, 0.3, 0}, "-y", false},
                 {"egg", WrapKind::kEllipsoid, frame("shank", 0.2), {0.02, 0.03, 0.04}, "x", true},
                 {"ball", WrapKind::kSphere, frame("ground", 0.3), {0.05, 0, 0}, "all", true},
                 {"ring", WrapKind::kTorus, frame("ground", 0.4), {0.01, 0.06, 0}, "-z", true}};
  model.muscles = {{"vas", 1234.5, 0.083, 0.117, 0.17, 11.5, path()}};
  model.ligaments = {{"mcl", LigamentLaw::kBlankevoort, 2750, 0.091, 0.07, 0.003, path()},
                     {"pl", LigamentLaw::kLinear, 1187e3, 0.051, 0.06, 0, path()}};
  model.markers = {{"heel", "shank", {0.3, 0.2, -0.1}}};
  model.contact_surfaces = {{"tray", frame("shank", 0.7), "tray.stl"}, {"button", frame("ground", 0.8), "b.stl"}};
  model.contact_pairs = {{"tf", "button", "tray", 463e6, 0.46, 0.009}};
  model.not_supported = {"a bushing 'x'"};
  return model;
}

std::string minimal(const std::string& lists) {
  return R"({"format": "condyle-model", "version": 1, "name": "m", )" + lists + "}";
}

std::string refusal(const std::string& json) {
  return message_of<std::invalid_argument>([&] { parse_model(json, "m.json"); });
}

const std::string kEmpty = R"("bodies": [], "joints": [], "coordinates": [])";

/// A model whose one joint has this first rotation.
std::string with_rotation(const std::string& rotation) {
  return minimal(R"("bodies": [{"name": "b", "mass": 1}], "coordinates": [], "joints": [{"name": "hip_r",
    "parent": {"body": "ground"}, "child": {"body": "b"},
    "rotations": [)" + rotation + R"(, {"axis": [0, 1, 0]}, {"axis": [0, 0, 1]}]}])");
}

}  // namespace

TEST_CASE("a model reads back field for field [property]") {
  const ModelDescription model = everything();
  const ScratchFile file("everything.json");
  write_model_file(model, file.path());
  const ModelDescription back = read_model_file(file.path());
  CHECK(back.source == file.name());
  // The text holds every field (checked one by one below), so equal texts are equal models.
  CHECK(model_text(back) == model_text(model));
  CHECK(back.name == model.name);
  CHECK(back.provenance == "a test");
  CHECK(back.gravity == model.gravity);
  CHECK(back.bodies[0].inertia == model.bodies[0].inertia);
  CHECK(back.bodies[0].mass_centre == model.bodies[0].mass_centre);
  CHECK(back.bodies[0].meshes == model.bodies[0].meshes);
  const JointDescription& joint = back.joints[0];
  CHECK(joint.parent.translation == model.joints[0].parent.translation);
  CHECK(joint.child.orientation_xyz == model.joints[0].child.orientation_xyz);
  CHECK(joint.child.body == "shank");
  CHECK(joint.rotations[2].axis == model.joints[0].rotations[2].axis);
  CHECK(joint.rotations[1].constant == -0.37);
  REQUIRE(joint.rotations[0].terms.size() == 2);
  CHECK(joint.rotations[0].terms[0].function.coefficients() == std::vector<double>{0.5, -1.25});
  CHECK(joint.rotations[0].terms[1].coordinate == "slide");
  CHECK(joint.rotations[0].terms[1].function.coefficients() == std::vector<double>{0.1, -0.2, 0.3});
  CHECK(joint.translations[2].terms[0].function.kind() == FunctionKind::kSimmSpline);
  CHECK(joint.translations[2].terms[0].function.y() == std::vector<double>{0.3, 0.1, 0.7, 0.2});
  CHECK(back.couplings[0].function.kind() == FunctionKind::kNaturalCubicSpline);
  CHECK(back.couplings[0].dependent == "slide");
  CHECK(back.couplings[0].independent == "knee");
}

TEST_CASE("coordinates, springs, wraps and forces read back field for field [property]") {
  const ModelDescription back = parse_model(model_text(everything()), "text");
  const CoordinateDescription& knee = back.coordinates[0];
  CHECK((knee.rotational && knee.locked && knee.default_value == 0.3));
  CHECK((knee.range_min == -0.2 && knee.range_max == 2.2));
  CHECK((knee.role == CoordinateRole::kForceDependent && knee.balance == CoordinateBalance::kMuscles));
  const CoordinateDescription& slide = back.coordinates[1];
  CHECK((!slide.rotational && !slide.locked && slide.role == CoordinateRole::kDriven));
  CHECK(slide.balance == CoordinateBalance::kReaction);
  const SpringDescription& spring = back.springs[0];
  CHECK((spring.stiffness == 12.5 && spring.rest == 0.25 && spring.viscosity == 0.75));
  const ModelDescription model = everything();
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(back.wraps[i].kind == model.wraps[i].kind);
    CHECK(back.wraps[i].dimensions == model.wraps[i].dimensions);
    CHECK(back.wraps[i].quadrant == model.wraps[i].quadrant);
    CHECK(back.wraps[i].active == model.wraps[i].active);
    CHECK(back.wraps[i].frame.translation == model.wraps[i].frame.translation);
  }
  const MuscleDescription& muscle = back.muscles[0];
  CHECK((muscle.max_isometric_force == 1234.5 && muscle.optimal_fibre_length == 0.083));
  CHECK((muscle.tendon_slack_length == 0.117 && muscle.pennation_at_optimal == 0.17));
  CHECK(muscle.max_contraction_velocity == 11.5);
  const PathPointDescription& point = muscle.path.points[1];
  CHECK(point.location == Vector3(-0.1, 1e-17, 0.7));
  CHECK((point.moving[0].empty() && point.moving[1].size() == 1 && point.moving[2].empty()));
  CHECK(point.condition_coordinate == "knee");
  CHECK((point.condition_min == -0.25 && point.condition_max == 2.125));
  CHECK(!muscle.path.points[0].condition_coordinate);
  CHECK(muscle.path.wraps[0].method == "midpoint");
  CHECK((muscle.path.wraps[0].first_point == 0 && muscle.path.wraps[0].last_point == 1));
  CHECK(muscle.path.wraps[1].last_point == -1);
  CHECK(back.ligaments[0].transition_strain == 0.07);
  CHECK(back.ligaments[0].damping == 0.003);
  CHECK(back.ligaments[1].law == LigamentLaw::kLinear);
  CHECK((back.ligaments[1].stiffness == 1187e3 && back.ligaments[1].slack_length == 0.051));
  CHECK(back.markers[0].location == Vector3(0.3, 0.2, -0.1));
  CHECK(back.contact_surfaces[0].mesh == "tray.stl");
  CHECK(back.contact_pairs[0].first == "button");
  CHECK(back.contact_pairs[0].youngs_modulus == 463e6);
  CHECK((back.contact_pairs[0].poissons_ratio == 0.46 && back.contact_pairs[0].thickness == 0.009));
  CHECK(back.not_supported == model.not_supported);
}

TEST_CASE("what a file leaves out is the structs' default [property]") {
  const ModelDescription model = parse_model(
      minimal(R"("bodies": [{"name": "b", "mass": 2}], "joints": [{"name": "j", "parent": {"body": "ground"},
        "child": {"body": "b"}}], "coordinates": [{"name": "c", "motion": "rotational"}])"), "m.json");
  CHECK(model.gravity == ModelDescription{}.gravity);
  CHECK(model.bodies[0].inertia.isZero(0.0));
  // Axes that nothing moves along: x, y, z.
  CHECK(model.joints[0].rotations[1].axis == Vector3::UnitY());
  CHECK(model.joints[0].translations[2].axis == Vector3::UnitZ());
  CHECK(model.coordinates[0].role == CoordinateDescription{}.role);
  CHECK(model.coordinates[0].balance == CoordinateDescription{}.balance);
}

TEST_CASE("a fault is named by file, item, key and value [error]") {
  CHECK(refusal(minimal(kEmpty)) == "nothing thrown");
  CHECK(refusal(with_rotation(R"({"axis": [1, 0, 0], "terms": [{"coordinate": "q",
                                  "function": {"kind": "spline"}}]})")) ==
        R"(m.json: joints[0] "hip_r": rotations[0].terms[0].function.kind: "spline" (allowed: linear, )"
        "polynomial, simm_spline, natural_cubic_spline, piecewise_linear)");
  CHECK(refusal(with_rotation(R"({"axis": [1, 0, 0], "terms": [{"coordinate": "q",
                                  "function": {"kind": "simm_spline", "x": [0, 1], "y": [2]}}]})")) ==
        R"(m.json: joints[0] "hip_r": rotations[0].terms[0].function.y: a list of 1: must have at least 2)");
  CHECK(refusal(with_rotation(R"({"axis": [1, 0, 0], "terms": [{"coordinate": "q",
                                  "function": {"kind": "simm_spline", "x": [0, 1, 2], "y": [2, 3]}}]})")) ==
        R"(m.json: joints[0] "hip_r": rotations[0].terms[0].function: x has 3 numbers, y 2: must be as many)");
  CHECK(refusal(with_rotation(R"({"axis": [1, 0, 0], "terms": [{"coordinate": "q",
                                  "function": {"kind": "piecewise_linear", "x": [1, 0], "y": [2, 3]}}]})"))
            .starts_with(R"(m.json: joints[0] "hip_r": rotations[0].terms[0].function: )"));
  CHECK(refusal(with_rotation(R"({"axis": [1, 0]})")) ==
        R"(m.json: joints[0] "hip_r": rotations[0].axis: a list of 2: must be a list of three numbers)");
  CHECK(refusal(with_rotation(R"({"axis": [1, 0, 0], "constnat": 1})")) ==
        R"(m.json: joints[0] "hip_r": rotations[0]: unknown key 'constnat', did you mean 'constant'? )"
        "(known: axis, constant, terms)");
  CHECK(refusal(minimal(R"("bodies": [], "joints": [])")) == "m.json: no key 'coordinates'");
  CHECK(refusal(minimal(R"("bodies": [{"name": "b"}], "joints": [], "coordinates": [])")) ==
        R"(m.json: bodies[0] "b": no key 'mass')");
  CHECK(refusal(minimal(kEmpty + R"(, "wraps": [{"name": "w", "kind": "sphere", "frame": {"body": "b"},
                                     "radius": 1, "length": 2}])")) ==
        R"(m.json: wraps[0] "w": unknown key 'length' (known: name, kind, frame, radius, quadrant, active))");
  CHECK(refusal(R"({"format": "condyle-model", "version": 2})") ==
        "m.json: version: 2: this program reads version 1");
}

TEST_CASE("a number that is not finite is not written [error]") {
  ModelDescription model = everything();
  model.springs[0].rest = std::numeric_limits<double>::quiet_NaN();
  CHECK(message_of<std::invalid_argument>([&] { model_text(model); }) ==
        "springs[0]: rest: nan cannot be written to JSON");
}
