// SPDX-License-Identifier: Apache-2.0
// What a musculoskeletal model is, as plain data: the content of a model file, field for field.
//
//   bodies     rigid, in a tree of joints that begins at "ground"
//   joints     parent frame → child frame, OpenSim's SpatialTransform: first three translations along fixed axes of the
//              parent frame, then three body-fixed rotations; each of the six a sum of functions of one coordinate each
//   muscles, ligaments   a path over bodies (via points, wrapping surfaces) and a force law
//
// Units: m, kg, s, rad, N, Nm. Names are unique within their list. `Model` (model.hpp) checks a description and compiles it.
// Source of the joint's semantics: Seth et al. 2010, Multibody Syst Dyn 23:295–318 ("Minimal formulation of joint motion").
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "condyle/common/side.hpp"
#include "condyle/common/types.hpp"
#include "condyle/model/function.hpp"

namespace condyle::model {

/// Name of the body that does not move; it is not in the list of bodies.
inline constexpr const char* kGround = "ground";

struct BodyDescription {
  std::string name;
  double mass = 0.0;                       ///< [kg] ≥ 0
  Vector3 mass_centre = Vector3::Zero();   ///< p_BoBcm_B [m]
  Vector6 inertia = Vector6::Zero();       ///< about the mass centre, in B: xx yy zz xy xz yz [kg m²]
  std::vector<std::string> meshes;         ///< files to draw, relative to the model file
};

/// A frame fixed to a body: origin and body-fixed x-y-z angles (R = Rx·Ry·Rz) in the body's frame.
struct FrameDescription {
  std::string body = kGround;
  Vector3 translation = Vector3::Zero();      ///< [m]
  Vector3 orientation_xyz = Vector3::Zero();  ///< [rad]
};

/// One summand of a joint's axis: function(coordinate).
struct TermDescription {
  std::string coordinate;
  Function function;
};

/// One of the six axes of a joint. Its amount is constant + Σ function(coordinate), in rad or m.
struct AxisDescription {
  Vector3 axis = Vector3::Zero();  ///< made a unit vector when compiled
  double constant = 0.0;
  std::vector<TermDescription> terms;
};

struct JointDescription {
  std::string name;
  FrameDescription parent, child;
  std::array<AxisDescription, 3> rotations;     ///< body-fixed, in this order
  std::array<AxisDescription, 3> translations;  ///< along axes of the parent frame, before the rotations
};

enum class CoordinateRole { kDriven, kForceDependent };
/// Who carries a coordinate's load: muscles (recruitment), or whatever drives it (a reaction, not asked about further).
enum class CoordinateBalance { kMuscles, kReaction };

struct CoordinateDescription {
  std::string name;
  bool rotational = true;  ///< rad, or m
  double default_value = 0.0;
  double range_min = 0.0, range_max = 0.0;  ///< for messages and pictures; not enforced
  bool locked = false;                      ///< stays at its default where a trial says nothing
  CoordinateRole role = CoordinateRole::kDriven;
  CoordinateBalance balance = CoordinateBalance::kReaction;
};

/// dependent = function(independent); the dependent coordinate's load goes to the independent one.
struct CouplingDescription {
  std::string dependent, independent;
  Function function;
};

/// Generalised force −stiffness·(q − rest) − viscosity·q̇ on a coordinate.
struct SpringDescription {
  std::string coordinate;
  double stiffness = 0.0, rest = 0.0, viscosity = 0.0;
};

enum class WrapKind { kCylinder, kEllipsoid, kSphere, kTorus };

/// A surface that paths go around. Its frame: z is a cylinder's axis.
struct WrapDescription {
  std::string name;
  WrapKind kind = WrapKind::kCylinder;
  FrameDescription frame;
  Vector3 dimensions = Vector3::Zero();  ///< cylinder: radius, length, –; ellipsoid: semi-axes; sphere: radius; torus: radii
  std::string quadrant = "all";          ///< all, x, -x, y, -y, z, -z: the half of the surface that paths take
  bool active = true;
};

/// A point of a path, fixed to a body, or moving in it with coordinates, or present over a coordinate's range only.
struct PathPointDescription {
  std::string body;
  Vector3 location = Vector3::Zero();                  ///< [m], in the body's frame
  std::array<std::vector<TermDescription>, 3> moving;  ///< added to location's components
  std::optional<std::string> condition_coordinate;     ///< present while condition_min ≤ q ≤ condition_max
  double condition_min = 0.0, condition_max = 0.0;
};

/// A wrapping surface that a path may touch between two of its points.
struct PathWrapDescription {
  std::string wrap;
  std::string method = "hybrid";        ///< OpenSim's name, for ellipsoids: hybrid, midpoint, axial
  int first_point = -1, last_point = -1;  ///< 0-based range of points in which it may act; −1: first, last
};

struct PathDescription {
  std::vector<PathPointDescription> points;  ///< at least two
  std::vector<PathWrapDescription> wraps;
};

/// Parameters of a Hill-type muscle with a rigid tendon (muscle.hpp).
struct MuscleDescription {
  std::string name;
  double max_isometric_force = 0.0;       ///< [N]
  double optimal_fibre_length = 0.0;      ///< [m]
  double tendon_slack_length = 0.0;       ///< [m]
  double pennation_at_optimal = 0.0;      ///< [rad]
  double max_contraction_velocity = 10.0;  ///< [optimal fibre lengths/s]
  PathDescription path;
};

enum class LigamentLaw { kBlankevoort, kLinear };

struct LigamentDescription {
  std::string name;
  LigamentLaw law = LigamentLaw::kBlankevoort;
  double stiffness = 0.0;           ///< Blankevoort: N per unit strain; linear: N/m
  double slack_length = 0.0;        ///< [m]
  double transition_strain = 0.06;  ///< Blankevoort: where it turns linear, 2 ε₀
  double damping = 0.0;             ///< Blankevoort's, as OpenSim has it: force c·dε/dt while stretched and lengthening [N s]
  PathDescription path;
};

struct MarkerDescription {
  std::string name, body;
  Vector3 location = Vector3::Zero();  ///< [m]
};

/// A surface of an implant on a body.
struct ContactSurfaceDescription {
  std::string name;
  FrameDescription frame;  ///< of the mesh's coordinates
  std::string mesh;        ///< file, relative to the model file
};

/// Two surfaces that touch.
struct ContactPairDescription {
  std::string name;
  std::string first, second;  ///< names of surfaces; OpenSim-JAM: target and casting mesh
  double youngs_modulus = 0.0, poissons_ratio = 0.0, thickness = 0.0;  ///< as found [Pa, –, m]; 0: not given
};

struct ModelDescription {
  std::string name;
  std::string source;      ///< the file it was read from, for messages; not written
  std::string provenance;  ///< what it was made from, in words (a model file's "source")
  Vector3 gravity{0.0, -9.80665, 0.0};
  std::vector<BodyDescription> bodies;
  std::vector<JointDescription> joints;
  std::vector<CoordinateDescription> coordinates;
  std::vector<CouplingDescription> couplings;
  std::vector<SpringDescription> springs;
  std::vector<WrapDescription> wraps;
  std::vector<MuscleDescription> muscles;
  std::vector<LigamentDescription> ligaments;
  std::vector<MarkerDescription> markers;
  std::vector<ContactSurfaceDescription> contact_surfaces;
  std::vector<ContactPairDescription> contact_pairs;
  std::vector<std::string> not_supported;  ///< what an importer found and left out, in words
};

}  // namespace condyle::model
