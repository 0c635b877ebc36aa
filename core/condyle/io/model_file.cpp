// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/model_file.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "condyle/io/json_node.hpp"
#include "condyle/io/table.hpp"

namespace condyle::io {
namespace {

using namespace condyle::model;

/// A list under a key that may be missing, item by item.
template <typename Item, typename Read>
void read_list(const JsonNode& parent, std::string_view key, std::vector<Item>& into, Read read) {
  const auto list = parent.find(key);
  if (!list) return;
  for (const JsonNode& item : list->items()) into.push_back(read(item));
}

/// Likewise of items with names, which must differ.
template <typename Item, typename Read>
void read_named(const JsonNode& parent, std::string_view key, std::vector<Item>& into, Read read) {
  const auto list = parent.find(key);
  if (!list) return;
  for (const JsonNode& item : list->named_items()) into.push_back(read(item));
}

void set_number(const JsonNode& node, std::string_view key, double& value) {
  if (const auto found = node.find(key)) value = found->number();
}
void set_vector(const JsonNode& node, std::string_view key, Vector3& value) {
  if (const auto found = node.find(key)) value = found->vector3();
}
void set_boolean(const JsonNode& node, std::string_view key, bool& value) {
  if (const auto found = node.find(key)) value = found->boolean();
}

Function read_function(const JsonNode& node) {
  const std::size_t kind = node.at("kind").one_of(
      {"linear", "polynomial", "simm_spline", "natural_cubic_spline", "piecewise_linear"});
  if (kind == 0) {
    node.require_keys({"kind", "slope", "intercept"});
    double intercept = 0.0;
    set_number(node, "intercept", intercept);
    return Function::linear(node.at("slope").number(), intercept);
  }
  if (kind == 1) {
    node.require_keys({"kind", "coefficients"});
    return Function::polynomial(node.at("coefficients").numbers(1));
  }
  node.require_keys({"kind", "x", "y"});
  const JsonNode x = node.at("x"), y = node.at("y");
  constexpr FunctionKind kSplines[] = {FunctionKind::kSimmSpline, FunctionKind::kNaturalCubicSpline,
                                       FunctionKind::kPiecewiseLinear};
  const std::vector<double> knots = x.numbers(2), values = y.numbers(2);
  if (knots.size() != values.size()) {
    node.fail("x has " + std::to_string(knots.size()) + " numbers, y " +
              std::to_string(values.size()) + ": must be as many");
  }
  try {
    return Function::spline(kSplines[kind - 2], knots, values);
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
}

TermDescription read_term(const JsonNode& node) {
  node.require_keys({"coordinate", "function"});
  return {node.at("coordinate").name(), read_function(node.at("function"))};
}

FrameDescription read_frame(const JsonNode& node) {
  node.require_keys({"body", "translation", "orientation_xyz"});
  FrameDescription frame;
  frame.body = node.at("body").name();
  set_vector(node, "translation", frame.translation);
  set_vector(node, "orientation_xyz", frame.orientation_xyz);
  return frame;
}

BodyDescription read_body(const JsonNode& node) {
  node.require_keys({"name", "mass", "mass_centre", "inertia", "meshes"});
  BodyDescription body;
  body.name = node.at("name").name();
  body.mass = node.at("mass").number();
  set_vector(node, "mass_centre", body.mass_centre);
  if (const auto inertia = node.find("inertia")) {
    const auto items = inertia->items(6);
    for (std::size_t i = 0; i < 6; ++i) {
      body.inertia[static_cast<Eigen::Index>(i)] = items[i].number();
    }
  }
  read_list(node, "meshes", body.meshes, [](const JsonNode& mesh) { return mesh.name(); });
  return body;
}

AxisDescription read_axis(const JsonNode& node) {
  node.require_keys({"axis", "constant", "terms"});
  AxisDescription axis;
  axis.axis = node.at("axis").vector3();
  set_number(node, "constant", axis.constant);
  read_list(node, "terms", axis.terms, read_term);
  return axis;
}

/// Three axes; x, y and z at rest where a file says nothing.
std::array<AxisDescription, 3> read_axes(const JsonNode& joint, std::string_view key) {
  std::array<AxisDescription, 3> axes;
  const auto found = joint.find(key);
  for (std::size_t i = 0; i < 3; ++i) axes[i].axis = Vector3::Unit(static_cast<Eigen::Index>(i));
  if (!found) return axes;
  const auto items = found->items(3);
  for (std::size_t i = 0; i < 3; ++i) axes[i] = read_axis(items[i]);
  return axes;
}

JointDescription read_joint(const JsonNode& node) {
  node.require_keys({"name", "parent", "child", "rotations", "translations"});
  JointDescription joint;
  joint.name = node.at("name").name();
  joint.parent = read_frame(node.at("parent"));
  joint.child = read_frame(node.at("child"));
  joint.rotations = read_axes(node, "rotations");
  joint.translations = read_axes(node, "translations");
  return joint;
}

CoordinateDescription read_coordinate(const JsonNode& node) {
  node.require_keys({"name", "motion", "default", "range", "locked", "role", "balanced_by"});
  CoordinateDescription coordinate;
  coordinate.name = node.at("name").name();
  coordinate.rotational = node.at("motion").one_of({"rotational", "translational"}) == 0;
  set_number(node, "default", coordinate.default_value);
  if (const auto range = node.find("range")) {
    const auto ends = range->items(2);
    coordinate.range_min = ends[0].number();
    coordinate.range_max = ends[1].number();
  }
  set_boolean(node, "locked", coordinate.locked);
  if (const auto role = node.find("role")) {
    const bool driven = role->one_of({"driven", "force_dependent"}) == 0;
    coordinate.role = driven ? CoordinateRole::kDriven : CoordinateRole::kForceDependent;
  }
  if (const auto by = node.find("balanced_by")) {
    const bool muscles = by->one_of({"muscles", "reaction"}) == 0;
    coordinate.balance = muscles ? CoordinateBalance::kMuscles : CoordinateBalance::kReaction;
  }
  return coordinate;
}

CouplingDescription read_coupling(const JsonNode& node) {
  node.require_keys({"dependent", "independent", "function"});
  return {node.at("dependent").name(), node.at("independent").name(),
          read_function(node.at("function"))};
}

SpringDescription read_spring(const JsonNode& node) {
  node.require_keys({"coordinate", "stiffness", "rest", "viscosity"});
  SpringDescription spring;
  spring.coordinate = node.at("coordinate").name();
  set_number(node, "stiffness", spring.stiffness);
  set_number(node, "rest", spring.rest);
  set_number(node, "viscosity", spring.viscosity);
  return spring;
}

/// The keys that give a wrap's size, by its kind.
void read_dimensions(const JsonNode& node, WrapDescription& wrap) {
  Vector3& size = wrap.dimensions;
  switch (wrap.kind) {
    case WrapKind::kCylinder:
      node.require_keys({"name", "kind", "frame", "radius", "length", "quadrant", "active"});
      size = {node.at("radius").number(), node.at("length").number(), 0.0};
      return;
    case WrapKind::kEllipsoid:
      node.require_keys({"name", "kind", "frame", "semi_axes", "quadrant", "active"});
      size = node.at("semi_axes").vector3();
      return;
    case WrapKind::kSphere:
      node.require_keys({"name", "kind", "frame", "radius", "quadrant", "active"});
      size = {node.at("radius").number(), 0.0, 0.0};
      return;
    case WrapKind::kTorus:
      node.require_keys(
          {"name", "kind", "frame", "inner_radius", "outer_radius", "quadrant", "active"});
      size = {node.at("inner_radius").number(), node.at("outer_radius").number(), 0.0};
      return;
  }
}

WrapDescription read_wrap(const JsonNode& node) {
  constexpr WrapKind kKinds[] = {WrapKind::kCylinder, WrapKind::kEllipsoid, WrapKind::kSphere,
                                 WrapKind::kTorus};
  WrapDescription wrap;
  wrap.name = node.at("name").name();
  wrap.kind = kKinds[node.at("kind").one_of({"cylinder", "ellipsoid", "sphere", "torus"})];
  read_dimensions(node, wrap);
  wrap.frame = read_frame(node.at("frame"));
  if (const auto quadrant = node.find("quadrant")) {
    quadrant->one_of({"all", "x", "-x", "y", "-y", "z", "-z"});
    wrap.quadrant = quadrant->text();
  }
  set_boolean(node, "active", wrap.active);
  return wrap;
}

PathPointDescription read_point(const JsonNode& node) {
  node.require_keys({"body", "location", "moving", "condition"});
  PathPointDescription point;
  point.body = node.at("body").name();
  point.location = node.at("location").vector3();
  if (const auto moving = node.find("moving")) {
    moving->require_keys({"x", "y", "z"});
    constexpr const char* kComponents[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
      read_list(*moving, kComponents[i], point.moving[i], read_term);
    }
  }
  if (const auto condition = node.find("condition")) {
    condition->require_keys({"coordinate", "min", "max"});
    point.condition_coordinate = condition->at("coordinate").name();
    point.condition_min = condition->at("min").number();
    point.condition_max = condition->at("max").number();
  }
  return point;
}

PathWrapDescription read_path_wrap(const JsonNode& node) {
  node.require_keys({"wrap", "method", "first_point", "last_point"});
  constexpr int kMost = std::numeric_limits<int>::max();
  PathWrapDescription wrap;
  wrap.wrap = node.at("wrap").name();
  if (const auto method = node.find("method")) {
    method->one_of({"hybrid", "midpoint", "axial"});
    wrap.method = method->text();
  }
  if (const auto first = node.find("first_point")) wrap.first_point = first->integer(-1, kMost);
  if (const auto last = node.find("last_point")) wrap.last_point = last->integer(-1, kMost);
  return wrap;
}

PathDescription read_path(const JsonNode& node) {
  node.require_keys({"points", "wraps"});
  PathDescription path;
  for (const JsonNode& point : node.at("points").items()) path.points.push_back(read_point(point));
  read_list(node, "wraps", path.wraps, read_path_wrap);
  return path;
}

MuscleDescription read_muscle(const JsonNode& node) {
  node.require_keys({"name", "max_isometric_force", "optimal_fibre_length", "tendon_slack_length",
                     "pennation_at_optimal", "max_contraction_velocity", "path"});
  MuscleDescription muscle;
  muscle.name = node.at("name").name();
  muscle.max_isometric_force = node.at("max_isometric_force").number();
  muscle.optimal_fibre_length = node.at("optimal_fibre_length").number();
  muscle.tendon_slack_length = node.at("tendon_slack_length").number();
  set_number(node, "pennation_at_optimal", muscle.pennation_at_optimal);
  set_number(node, "max_contraction_velocity", muscle.max_contraction_velocity);
  muscle.path = read_path(node.at("path"));
  return muscle;
}

LigamentDescription read_ligament(const JsonNode& node) {
  node.require_keys(
      {"name", "law", "stiffness", "slack_length", "transition_strain", "damping", "path"});
  LigamentDescription ligament;
  ligament.name = node.at("name").name();
  if (const auto law = node.find("law")) {
    const bool blankevoort = law->one_of({"blankevoort", "linear"}) == 0;
    ligament.law = blankevoort ? LigamentLaw::kBlankevoort : LigamentLaw::kLinear;
  }
  ligament.stiffness = node.at("stiffness").number();
  ligament.slack_length = node.at("slack_length").number();
  set_number(node, "transition_strain", ligament.transition_strain);
  set_number(node, "damping", ligament.damping);
  ligament.path = read_path(node.at("path"));
  return ligament;
}

MarkerDescription read_marker(const JsonNode& node) {
  node.require_keys({"name", "body", "location"});
  return {node.at("name").name(), node.at("body").name(), node.at("location").vector3()};
}

ContactSurfaceDescription read_surface(const JsonNode& node) {
  node.require_keys({"name", "frame", "mesh"});
  return {node.at("name").name(), read_frame(node.at("frame")), node.at("mesh").name()};
}

ContactPairDescription read_pair(const JsonNode& node) {
  node.require_keys({"name", "first", "second", "youngs_modulus", "poissons_ratio", "thickness"});
  ContactPairDescription pair;
  pair.name = node.at("name").name();
  pair.first = node.at("first").name();
  pair.second = node.at("second").name();
  set_number(node, "youngs_modulus", pair.youngs_modulus);
  set_number(node, "poissons_ratio", pair.poissons_ratio);
  set_number(node, "thickness", pair.thickness);
  return pair;
}

ModelDescription read_model(const JsonNode& root) {
  root.require_format(kModelFormat, kModelVersion);
  root.require_keys({"format", "version", "name", "source", "gravity", "bodies", "joints",
                     "coordinates", "couplings", "springs", "wraps", "muscles", "ligaments",
                     "markers", "contact_surfaces", "contact_pairs", "not_supported"});
  for (const char* key : {"bodies", "joints", "coordinates"}) root.at(key);
  ModelDescription model;
  model.name = root.at("name").name();
  if (const auto source = root.find("source")) model.provenance = source->text();
  set_vector(root, "gravity", model.gravity);
  read_named(root, "bodies", model.bodies, read_body);
  read_named(root, "joints", model.joints, read_joint);
  read_named(root, "coordinates", model.coordinates, read_coordinate);
  read_list(root, "couplings", model.couplings, read_coupling);
  read_list(root, "springs", model.springs, read_spring);
  read_named(root, "wraps", model.wraps, read_wrap);
  read_named(root, "muscles", model.muscles, read_muscle);
  read_named(root, "ligaments", model.ligaments, read_ligament);
  read_named(root, "markers", model.markers, read_marker);
  read_named(root, "contact_surfaces", model.contact_surfaces, read_surface);
  read_named(root, "contact_pairs", model.contact_pairs, read_pair);
  read_list(root, "not_supported", model.not_supported,
            [](const JsonNode& line) { return line.text(); });
  return model;
}

}  // namespace

ModelDescription read_model_file(const std::filesystem::path& file) {
  ModelDescription model = read_model(JsonNode::read(file));
  model.source = file.string();
  return model;
}

ModelDescription parse_model(std::string_view json, std::string source) {
  ModelDescription model = read_model(JsonNode::parse(json, source));
  model.source = std::move(source);
  return model;
}

void write_model_file(const ModelDescription& description, const std::filesystem::path& file) {
  write_whole(file, model_text(description));
}

}  // namespace condyle::io
