// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "condyle/io/json_text.hpp"
#include "condyle/io/model_file.hpp"

namespace condyle::io {
namespace {

using namespace condyle::model;

/// Texts of a list's items; a number that is not finite is refused with the item's place.
template <typename Item, typename Text>
std::vector<std::string> texts(const std::vector<Item>& items, std::string_view list, Text text) {
  std::vector<std::string> result;
  for (const Item& item : items) {
    try {
      result.push_back(text(item));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string(list) + "[" + std::to_string(result.size()) +
                                  "]: " + error.what());
    }
  }
  return result;
}

std::string function_text(const Function& function) {
  JsonObject object;
  const auto& coefficients = function.coefficients();
  switch (function.kind()) {
    case FunctionKind::kLinear:
      object.add_string("kind", "linear");
      object.add_number("slope", coefficients.size() > 1 ? coefficients[1] : 0.0);
      object.add_number("intercept", coefficients.empty() ? 0.0 : coefficients[0]);
      return object.text();
    case FunctionKind::kPolynomial:
      object.add_string("kind", "polynomial");
      object.add("coefficients", json_numbers(coefficients));
      return object.text();
    case FunctionKind::kNaturalCubicSpline:
      object.add_string("kind", "natural_cubic_spline");
      break;
    case FunctionKind::kSimmSpline:
      object.add_string("kind", "simm_spline");
      break;
    case FunctionKind::kPiecewiseLinear:
      object.add_string("kind", "piecewise_linear");
      break;
  }
  object.add("x", json_numbers(function.x()));
  object.add("y", json_numbers(function.y()));
  return object.text();
}

std::string term_text(const TermDescription& term) {
  JsonObject object;
  object.add_string("coordinate", term.coordinate);
  object.add("function", function_text(term.function));
  return object.text();
}

std::string frame_text(const FrameDescription& frame) {
  JsonObject object;
  object.add_string("body", frame.body);
  object.add("translation", json_vector(frame.translation));
  object.add("orientation_xyz", json_vector(frame.orientation_xyz));
  return object.text();
}

std::string body_text(const BodyDescription& body) {
  JsonObject object;
  object.add_string("name", body.name);
  object.add_number("mass", body.mass);
  object.add("mass_centre", json_vector(body.mass_centre));
  object.add("inertia", json_numbers({body.inertia.data(), 6}));
  object.add_list("meshes", texts(body.meshes, "meshes", json_string));
  return object.text();
}

std::string axis_text(const AxisDescription& axis) {
  JsonObject object;
  object.add("axis", json_vector(axis.axis));
  if (axis.constant != 0.0) object.add_number("constant", axis.constant);
  object.add_list("terms", texts(axis.terms, "terms", term_text));
  return object.text();
}

std::string joint_text(const JointDescription& joint) {
  const auto axes = [](const std::array<AxisDescription, 3>& three, const char* list) {
    return texts(std::vector<AxisDescription>(three.begin(), three.end()), list, axis_text);
  };
  JsonObject object;
  object.add_string("name", joint.name);
  object.add("parent", frame_text(joint.parent));
  object.add("child", frame_text(joint.child));
  object.add_list("rotations", axes(joint.rotations, "rotations"));
  object.add_list("translations", axes(joint.translations, "translations"));
  return object.text();
}

std::string coordinate_text(const CoordinateDescription& coordinate) {
  JsonObject object;
  object.add_string("name", coordinate.name);
  object.add_string("motion", coordinate.rotational ? "rotational" : "translational");
  object.add_number("default", coordinate.default_value);
  const double range[] = {coordinate.range_min, coordinate.range_max};
  object.add("range", json_numbers(range));
  object.add("locked", coordinate.locked ? "true" : "false");
  const bool driven = coordinate.role == CoordinateRole::kDriven;
  object.add_string("role", driven ? "driven" : "force_dependent");
  const bool muscles = coordinate.balance == CoordinateBalance::kMuscles;
  object.add_string("balanced_by", muscles ? "muscles" : "reaction");
  return object.text();
}

std::string coupling_text(const CouplingDescription& coupling) {
  JsonObject object;
  object.add_string("dependent", coupling.dependent);
  object.add_string("independent", coupling.independent);
  object.add("function", function_text(coupling.function));
  return object.text();
}

std::string spring_text(const SpringDescription& spring) {
  JsonObject object;
  object.add_string("coordinate", spring.coordinate);
  object.add_number("stiffness", spring.stiffness);
  object.add_number("rest", spring.rest);
  object.add_number("viscosity", spring.viscosity);
  return object.text();
}

std::string wrap_text(const WrapDescription& wrap) {
  constexpr const char* kKinds[] = {"cylinder", "ellipsoid", "sphere", "torus"};
  const Vector3& size = wrap.dimensions;
  JsonObject object;
  object.add_string("name", wrap.name);
  object.add_string("kind", kKinds[static_cast<std::size_t>(wrap.kind)]);
  object.add("frame", frame_text(wrap.frame));
  if (wrap.kind == WrapKind::kEllipsoid) {
    object.add("semi_axes", json_vector(size));
  } else if (wrap.kind == WrapKind::kTorus) {
    object.add_number("inner_radius", size[0]);
    object.add_number("outer_radius", size[1]);
  } else {
    object.add_number("radius", size[0]);
    if (wrap.kind == WrapKind::kCylinder) object.add_number("length", size[1]);
  }
  object.add_string("quadrant", wrap.quadrant);
  object.add("active", wrap.active ? "true" : "false");
  return object.text();
}

std::string point_text(const PathPointDescription& point) {
  constexpr const char* kComponents[] = {"x", "y", "z"};
  JsonObject object, moving;
  bool moves = false;
  object.add_string("body", point.body);
  object.add("location", json_vector(point.location));
  for (std::size_t i = 0; i < 3; ++i) {
    moves = moves || !point.moving[i].empty();
    moving.add_list(kComponents[i], texts(point.moving[i], kComponents[i], term_text));
  }
  if (moves) object.add("moving", moving.text());
  if (point.condition_coordinate) {
    JsonObject condition;
    condition.add_string("coordinate", *point.condition_coordinate);
    condition.add_number("min", point.condition_min);
    condition.add_number("max", point.condition_max);
    object.add("condition", condition.text());
  }
  return object.text();
}

std::string path_text(const PathDescription& path) {
  JsonObject object;
  object.add("points", json_list(texts(path.points, "points", point_text)));
  object.add_list("wraps", texts(path.wraps, "wraps", [](const PathWrapDescription& wrap) {
                    JsonObject item;
                    item.add_string("wrap", wrap.wrap);
                    item.add_string("method", wrap.method);
                    item.add("first_point", std::to_string(wrap.first_point));
                    item.add("last_point", std::to_string(wrap.last_point));
                    return item.text();
                  }));
  return object.text();
}

std::string muscle_text(const MuscleDescription& muscle) {
  JsonObject object;
  object.add_string("name", muscle.name);
  object.add_number("max_isometric_force", muscle.max_isometric_force);
  object.add_number("optimal_fibre_length", muscle.optimal_fibre_length);
  object.add_number("tendon_slack_length", muscle.tendon_slack_length);
  object.add_number("pennation_at_optimal", muscle.pennation_at_optimal);
  object.add_number("max_contraction_velocity", muscle.max_contraction_velocity);
  object.add("path", path_text(muscle.path));
  return object.text();
}

std::string ligament_text(const LigamentDescription& ligament) {
  JsonObject object;
  object.add_string("name", ligament.name);
  object.add_string("law", ligament.law == LigamentLaw::kBlankevoort ? "blankevoort" : "linear");
  object.add_number("stiffness", ligament.stiffness);
  object.add_number("slack_length", ligament.slack_length);
  object.add_number("transition_strain", ligament.transition_strain);
  object.add_number("damping", ligament.damping);
  object.add("path", path_text(ligament.path));
  return object.text();
}

std::string marker_text(const MarkerDescription& marker) {
  JsonObject object;
  object.add_string("name", marker.name);
  object.add_string("body", marker.body);
  object.add("location", json_vector(marker.location));
  return object.text();
}

std::string surface_text(const ContactSurfaceDescription& surface) {
  JsonObject object;
  object.add_string("name", surface.name);
  object.add("frame", frame_text(surface.frame));
  object.add_string("mesh", surface.mesh);
  return object.text();
}

std::string pair_text(const ContactPairDescription& pair) {
  JsonObject object;
  object.add_string("name", pair.name);
  object.add_string("first", pair.first);
  object.add_string("second", pair.second);
  object.add_number("youngs_modulus", pair.youngs_modulus);
  object.add_number("poissons_ratio", pair.poissons_ratio);
  object.add_number("thickness", pair.thickness);
  return object.text();
}

}  // namespace

std::string model_text(const ModelDescription& model) {
  JsonObject object;
  const auto add = [&](const char* list, const auto& items, auto text) {
    object.add_list(list, texts(items, list, text));
  };
  object.add_string("format", kModelFormat);
  object.add("version", std::to_string(kModelVersion));
  object.add_string("name", model.name);
  if (!model.provenance.empty()) object.add_string("source", model.provenance);
  object.add("gravity", json_vector(model.gravity));
  // The lists that a file must have, even when they are empty.
  object.add("bodies", json_list(texts(model.bodies, "bodies", body_text)));
  object.add("joints", json_list(texts(model.joints, "joints", joint_text)));
  object.add("coordinates", json_list(texts(model.coordinates, "coordinates", coordinate_text)));
  add("couplings", model.couplings, coupling_text);
  add("springs", model.springs, spring_text);
  add("wraps", model.wraps, wrap_text);
  add("muscles", model.muscles, muscle_text);
  add("ligaments", model.ligaments, ligament_text);
  add("markers", model.markers, marker_text);
  add("contact_surfaces", model.contact_surfaces, surface_text);
  add("contact_pairs", model.contact_pairs, pair_text);
  add("not_supported", model.not_supported, json_string);
  return object.text() + '\n';
}

}  // namespace condyle::io
