// SPDX-License-Identifier: Apache-2.0
// The strategy behind the mesh contact: how the contact integral over one side's insert faces is
// evaluated.
//
// Every strategy integrates the same thing: over the faces of one compartment, each at its centroid
// c with area A, d = max(0, −φ(c)), φ the signed distance to the femoral surface; energy Σ A W(d),
// force of a face A p(d) along −∇φ. A face whose closest femoral point lies on the femur's open
// border does not count; its area goes to border_area. A strategy takes a whole side at once, so
// that it may cull and vectorise as it likes.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"
#include "condyle/contact/contact_law.hpp"
#include "condyle/contact/contact_model.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

/// One compartment as points to integrate over, expressed in T.
struct CompartmentFaces {
  geometry::VertexArray centroids;  ///< m × 3 [m]
  Eigen::VectorXd areas;            ///< m [m²]
  geometry::VertexArray normals;  ///< m × 3, unit, out of the insert (zero for a face without area)

  Eigen::Index count() const { return centroids.rows(); }
};

/// Both compartments, indexed by condyle::Side.
using Compartments = std::array<CompartmentFaces, kSides>;

/// Centroids, areas and unit normals of a mesh's faces.
CompartmentFaces compartment_faces(const geometry::TriangleMesh& mesh);

/// A loaded face whose normal n and gradient g of the femur's distance have g·n above this points
/// the same way as the femoral surface it touches: the overlap has passed through to a back face.
/// In contact g·n is near −1, at an edge near 0; cos 60° is beyond what an edge of the insert does.
inline constexpr double kBackFaceCosine = 0.5;

/// What one side's contact adds up to at one pose. Zero out of contact.
struct SideLoads {
  Wrench wrench = Wrench::Zero();       ///< on the femur, at Fo, in T [N, Nm]
  Matrix6 stiffness = Matrix6::Zero();  ///< ∂wrench/∂pose; zero unless asked for
  double energy = 0.0;                  ///< U = Σ A W(d) [J]
  double volume = 0.0;                  ///< Σ A d [m³]
  double area = 0.0;                    ///< Σ A of loaded faces [m²]
  double border_area =
      0.0;  ///< Σ A of overlapping faces closest to the femur's open border: not counted above [m²]
  double max_depth = 0.0;      ///< of the loaded faces [m]
  double peak_pressure = 0.0;  ///< of the loaded faces [Pa]
  double pressure_sum = 0.0;   ///< Σ A p [N]; mean pressure is this / area
  Vector3 pressure_moment =
      Vector3::Zero();     ///< Σ A p c, in T [N m]; centre of pressure is this / pressure_sum
  bool back_face = false;  ///< a loaded face overlaps a back face (kBackFaceCosine)
};

/// Depth and pressure of each face of a compartment; zero where not loaded.
struct FacePressure {
  Eigen::VectorXd depth;     ///< m [m]
  Eigen::VectorXd pressure;  ///< m [Pa]
};

/// Evaluates the contact integral. Const and thread-safe; the same pose gives the same bytes on
/// every call.
class FaceEvaluation {
 public:
  virtual ~FaceEvaluation() = default;

  /// The whole of one side. @pre pose is finite.
  virtual SideLoads evaluate(const Pose& pose, Side side, Derivatives derivatives) const = 0;

  /// Face by face, in the order of the compartment's faces. @pre pose is finite.
  virtual FacePressure face_pressure(const Pose& pose, Side side) const = 0;
};

/// Distance to the femur's triangles themselves: the truth that everything else is measured
/// against. Wrench and stiffness are those of the exact distance of the polyhedral surface: ∇φ
/// jumps between the regions of neighbouring features, so the stiffness is exact wherever φ is
/// smooth at every loaded centroid.
/// @pre femur and compartments are well formed.
std::unique_ptr<FaceEvaluation> make_exact_evaluation(const geometry::TriangleMesh& femur,
                                                      const Compartments& compartments,
                                                      const ContactLaw& law);

}  // namespace condyle::contact
