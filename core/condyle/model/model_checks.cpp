// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/model_checks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace condyle::model {
namespace {

// A principal moment may be below 0 by the rounding of figures in files, of the largest moment.
// That the two smaller reach the largest is not asked for: widely used models break it (the toes of
// OpenSim's gait2392), and nothing here fails for it.
constexpr double kInertiaSlack = 1e-3;

std::string text(double value) {
  std::ostringstream out;
  out.precision(10);
  out << value;
  return out.str();
}

std::string text(const Vector3& v) {
  std::ostringstream out;
  out.precision(10);
  out << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
  return out.str();
}

// One item of a list, for messages: "source: body 'tibia_r': ".
class Item {
 public:
  Item(const std::string& source, const char* kind, const std::string& name)
      : prefix_(source + ": " + kind + " '" + name + "': ") {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::invalid_argument(prefix_ + what);
  }
  void finite(const std::string& field, double value, const char* unit) const {
    if (!std::isfinite(value)) refuse(field + " is " + text(value) + unit + "; it must be finite");
  }
  void finite(const std::string& field, const Vector3& value, const char* unit) const {
    if (!value.allFinite()) refuse(field + " is " + text(value) + unit + "; it must be finite");
  }
  void above_zero(const std::string& field, double value, const char* unit) const {
    finite(field, value, unit);
    if (!(value > 0.0)) refuse(field + " is " + text(value) + unit + "; it must be above 0");
  }
  void not_negative(const std::string& field, double value, const char* unit) const {
    finite(field, value, unit);
    if (value < 0.0) refuse(field + " is " + text(value) + unit + "; it must be at least 0");
  }
  void one_of(const std::string& field, const std::string& value,
              std::initializer_list<std::string_view> known) const {
    if (std::find(known.begin(), known.end(), value) != known.end()) return;
    std::string list;
    for (std::string_view k : known) list += (list.empty() ? "" : ", ") + std::string(k);
    refuse(field + " is '" + value + "'; it must be one of " + list);
  }

 private:
  std::string prefix_;
};

using Names = std::set<std::string>;

struct Checks {
  explicit Checks(const ModelDescription& description)
      : d(description), source(model_label(description)) {}

  const ModelDescription& d;
  std::string source;
  Names bodies, coordinates, wraps, surfaces;

  Item item(const char* kind, const std::string& name) const { return {source, kind, name}; }

  template <typename List>
  Names unique_names(const char* kind, const List& list) const {
    Names names;
    std::size_t number = 0;
    for (const auto& entry : list) {
      if (entry.name.empty()) {
        throw std::invalid_argument(source + ": " + kind + " number " + std::to_string(number) +
                                    ": name is empty");
      }
      if (!names.insert(entry.name).second) {
        item(kind, entry.name).refuse("name is given twice; names are unique in their list");
      }
      ++number;
    }
    return names;
  }

  void known(const Item& item, const std::string& field, const std::string& name,
             const Names& names, const char* what) const {
    if (!names.count(name))
      item.refuse(field + " is '" + name + "'; the model has no such " + what);
  }
  void known_body(const Item& item, const std::string& field, const std::string& name) const {
    if (name != kGround) known(item, field, name, bodies, "body");
  }
  void frame(const Item& item, const std::string& field, const FrameDescription& frame) const {
    known_body(item, field + ".body", frame.body);
    item.finite(field + ".translation", frame.translation, " m");
    item.finite(field + ".orientation_xyz", frame.orientation_xyz, " rad");
  }
  void terms(const Item& item, const std::string& field,
             const std::vector<TermDescription>& list) const {
    for (std::size_t k = 0; k < list.size(); ++k) {
      const std::string place = field + "[" + std::to_string(k) + "]";
      known(item, place + ".coordinate", list[k].coordinate, coordinates, "coordinate");
      function(item, place + ".function", list[k].function);
    }
  }
  // A spline checks its knots when it is made.
  void function(const Item& item, const std::string& field, const Function& f) const {
    for (double c : f.coefficients()) item.finite(field + ": coefficient", c, "");
  }

  void body(const BodyDescription& body) const;
  void joint(const JointDescription& joint) const;
  void coordinate(const CoordinateDescription& coordinate) const;
  void coupling(const CouplingDescription& coupling, Names& dependents) const;
  void spring(const SpringDescription& spring) const;
  void wrap(const WrapDescription& wrap) const;
  void path(const Item& item, const PathDescription& path) const;
  void muscle(const MuscleDescription& muscle) const;
  void ligament(const LigamentDescription& ligament) const;
  void contact_pair(const ContactPairDescription& pair) const;
};

void Checks::body(const BodyDescription& body) const {
  const Item it = item("body", body.name);
  if (body.name == kGround) it.refuse("name is taken by what does not move");
  it.not_negative("mass", body.mass, " kg");
  it.finite("mass_centre", body.mass_centre, " m");
  const Vector6& J = body.inertia;
  if (!J.allFinite()) it.refuse("inertia has a value that is not finite");
  Matrix3 inertia;
  inertia << J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2];
  const Vector3 principal =
      Eigen::SelfAdjointEigenSolver<Matrix3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  const double slack = kInertiaSlack * principal.cwiseAbs().maxCoeff();
  if (principal[0] < -slack) {
    it.refuse("inertia has principal moments " + text(principal) + " kg m²; none may be below 0");
  }
}

void Checks::joint(const JointDescription& joint) const {
  const Item it = item("joint", joint.name);
  frame(it, "parent", joint.parent);
  frame(it, "child", joint.child);
  if (joint.child.body == kGround) it.refuse("child.body is 'ground'; ground has no joint");
  const auto check = [&](const char* list, const auto& axes) {
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const std::string field = std::string(list) + "[" + std::to_string(k) + "]";
      it.finite(field + ".axis", axes[k].axis, "");
      it.finite(field + ".constant", axes[k].constant, "");
      terms(it, field + ".terms", axes[k].terms);
      const bool used = !axes[k].terms.empty() || axes[k].constant != 0.0;
      if (used && !(axes[k].axis.norm() > 0.0)) {
        it.refuse(field + ".axis is " + text(axes[k].axis) + "; its length must be above 0");
      }
    }
  };
  check("rotations", joint.rotations);
  check("translations", joint.translations);
}

void Checks::coordinate(const CoordinateDescription& coordinate) const {
  const Item it = item("coordinate", coordinate.name);
  const char* unit = coordinate.rotational ? " rad" : " m";
  it.finite("default", coordinate.default_value, unit);
  // An unbounded range is a fair range; only an order that cannot be meant is refused.
  if (!(coordinate.range_min <= coordinate.range_max)) {
    it.refuse("range is [" + text(coordinate.range_min) + ", " + text(coordinate.range_max) + "]" +
              unit + "; it must not descend");
  }
}

void Checks::coupling(const CouplingDescription& coupling, Names& dependents) const {
  const Item it = item("coupling", coupling.dependent);
  known(it, "dependent", coupling.dependent, coordinates, "coordinate");
  known(it, "independent", coupling.independent, coordinates, "coordinate");
  function(it, "function", coupling.function);
  if (!dependents.insert(coupling.dependent).second) {
    it.refuse("dependent is given twice; a coordinate follows one other");
  }
}

void Checks::spring(const SpringDescription& spring) const {
  const Item it = item("spring", spring.coordinate);
  known(it, "coordinate", spring.coordinate, coordinates, "coordinate");
  it.not_negative("stiffness", spring.stiffness, "");
  it.finite("rest", spring.rest, "");
  it.not_negative("viscosity", spring.viscosity, "");
}

void Checks::wrap(const WrapDescription& wrap) const {
  const Item it = item("wrap", wrap.name);
  frame(it, "frame", wrap.frame);
  it.one_of("quadrant", wrap.quadrant, {"all", "x", "-x", "y", "-y", "z", "-z"});
  switch (wrap.kind) {
    case WrapKind::kCylinder:
      it.above_zero("radius", wrap.dimensions[0], " m");
      it.above_zero("length", wrap.dimensions[1], " m");
      break;
    case WrapKind::kEllipsoid:
      for (int i = 0; i < 3; ++i) it.above_zero("semi_axes", wrap.dimensions[i], " m");
      break;
    case WrapKind::kSphere:
      it.above_zero("radius", wrap.dimensions[0], " m");
      break;
    case WrapKind::kTorus:
      it.above_zero("inner_radius", wrap.dimensions[0], " m");
      it.above_zero("outer_radius", wrap.dimensions[1], " m");
      break;
  }
}

void Checks::path(const Item& it, const PathDescription& path) const {
  const auto n = static_cast<int>(path.points.size());
  if (n < 2) it.refuse("path.points has " + std::to_string(n) + "; a path needs at least 2");
  for (int i = 0; i < n; ++i) {
    const PathPointDescription& point = path.points[static_cast<std::size_t>(i)];
    const std::string field = "path.points[" + std::to_string(i) + "]";
    known_body(it, field + ".body", point.body);
    it.finite(field + ".location", point.location, " m");
    for (std::size_t k = 0; k < 3; ++k) {
      terms(it, field + ".moving." + std::string(1, "xyz"[k]), point.moving[k]);
    }
    if (!point.condition_coordinate) continue;
    known(it, field + ".condition.coordinate", *point.condition_coordinate, coordinates,
          "coordinate");
    if (!(point.condition_min <= point.condition_max)) {
      it.refuse(field + ".condition is [" + text(point.condition_min) + ", " +
                text(point.condition_max) + "]; it must not descend");
    }
  }
  for (std::size_t k = 0; k < path.wraps.size(); ++k) {
    const PathWrapDescription& wrap = path.wraps[k];
    const std::string field = "path.wraps[" + std::to_string(k) + "]";
    known(it, field + ".wrap", wrap.wrap, wraps, "wrap");
    it.one_of(field + ".method", wrap.method, {"hybrid", "midpoint", "axial"});
    for (const auto& [name, index] :
         {std::pair{".first_point", wrap.first_point}, std::pair{".last_point", wrap.last_point}}) {
      if (index >= -1 && index < n) continue;
      it.refuse(field + name + " is " + std::to_string(index) + "; it must be -1 to " +
                std::to_string(n - 1) + ", the points of the path");
    }
  }
}

void Checks::muscle(const MuscleDescription& muscle) const {
  const Item it = item("muscle", muscle.name);
  it.above_zero("max_isometric_force", muscle.max_isometric_force, " N");
  it.above_zero("optimal_fibre_length", muscle.optimal_fibre_length, " m");
  it.not_negative("tendon_slack_length", muscle.tendon_slack_length, " m");
  it.not_negative("pennation_at_optimal", muscle.pennation_at_optimal, " rad");
  constexpr double kRightAngle = 1.5707963267948966;
  if (muscle.pennation_at_optimal >= kRightAngle) {
    it.refuse("pennation_at_optimal is " + text(muscle.pennation_at_optimal) +
              " rad; it must be below π/2");
  }
  it.above_zero("max_contraction_velocity", muscle.max_contraction_velocity,
                " optimal fibre lengths/s");
  path(it, muscle.path);
}

void Checks::ligament(const LigamentDescription& ligament) const {
  const Item it = item("ligament", ligament.name);
  const bool linear = ligament.law == LigamentLaw::kLinear;
  it.not_negative("stiffness", ligament.stiffness, linear ? " N/m" : " N per unit strain");
  it.above_zero("slack_length", ligament.slack_length, " m");
  if (!linear) it.above_zero("transition_strain", ligament.transition_strain, "");
  it.not_negative("damping", ligament.damping, " s");
  path(it, ligament.path);
}

void Checks::contact_pair(const ContactPairDescription& pair) const {
  const Item it = item("contact pair", pair.name);
  known(it, "first", pair.first, surfaces, "contact surface");
  known(it, "second", pair.second, surfaces, "contact surface");
  it.not_negative("youngs_modulus", pair.youngs_modulus, " Pa");
  it.not_negative("thickness", pair.thickness, " m");
  it.finite("poissons_ratio", pair.poissons_ratio, "");
}

}  // namespace

std::string model_label(const ModelDescription& description) {
  if (!description.source.empty()) return description.source;
  return description.name.empty() ? "model" : "model '" + description.name + "'";
}

void require_valid(const ModelDescription& d) {
  Checks checks(d);
  if (!d.gravity.allFinite()) {
    throw std::invalid_argument(checks.source + ": gravity is " + text(d.gravity) +
                                " m/s²; it must be finite");
  }
  checks.bodies = checks.unique_names("body", d.bodies);
  checks.coordinates = checks.unique_names("coordinate", d.coordinates);
  checks.wraps = checks.unique_names("wrap", d.wraps);
  checks.surfaces = checks.unique_names("contact surface", d.contact_surfaces);
  checks.unique_names("joint", d.joints);
  checks.unique_names("muscle", d.muscles);
  checks.unique_names("ligament", d.ligaments);
  checks.unique_names("marker", d.markers);
  checks.unique_names("contact pair", d.contact_pairs);
  for (const auto& entry : d.bodies) checks.body(entry);
  for (const auto& entry : d.joints) checks.joint(entry);
  for (const auto& entry : d.coordinates) checks.coordinate(entry);
  Names dependents;
  for (const auto& entry : d.couplings) checks.coupling(entry, dependents);
  for (const auto& entry : d.springs) checks.spring(entry);
  for (const auto& entry : d.wraps) checks.wrap(entry);
  for (const auto& entry : d.muscles) checks.muscle(entry);
  for (const auto& entry : d.ligaments) checks.ligament(entry);
  for (const auto& entry : d.markers) {
    const Item it = checks.item("marker", entry.name);
    checks.known_body(it, "body", entry.body);
    it.finite("location", entry.location, " m");
  }
  for (const auto& entry : d.contact_surfaces) {
    checks.frame(checks.item("contact surface", entry.name), "frame", entry.frame);
  }
  for (const auto& entry : d.contact_pairs) checks.contact_pair(entry);
}

}  // namespace condyle::model
