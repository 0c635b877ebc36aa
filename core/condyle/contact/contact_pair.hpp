// SPDX-License-Identifier: Apache-2.0
// Two bodies pressed into each other: a moving surface (frame F) and the compartments of a fixed one
// (frame T). Femur and insert are such a pair; so are a patellar button and the trochlea.
//
//   U(pose) = Σ_faces A·W(d),   d = max(0, −φ(c)),   wrench = −∂U/∂(displacement of F)
//
// over the faces of one body, c a face's centroid and φ the signed distance to the other. Frictionless,
// elastic, path-independent. The force of a face acts along −∇φ, not along the face's own normal
// (which differs by about 1 % on a real pair): only so is the force the derivative of the energy.
//
// Which body's faces are integrated is a choice of quadrature: the fixed one's (the insert's, as in
// Marra et al.), the moving one's, or the mean of both, which alone does not change when the bodies
// change roles.
//
// Limits: rigid bodies under a surface layer, quasi-static. Faces are points: the wrench is
// continuous, its derivative has a small jump where a face's centroid enters. A face whose closest
// point is on the other surface's open border does not count, and energy is conserved only where
// `border_area` is 0.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "condyle/contact/surface_integral.hpp"
#include "condyle/geometry/distance_field.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

/// How distances are evaluated: to triangles, or through a smooth field of them.
enum class Evaluation { kExact, kFast };

/// Whose faces are integrated.
enum class Integration { kFixed, kMoving, kBoth };

/// Reads "exact" or "fast". @throws std::invalid_argument for anything else, naming the text.
Evaluation evaluation_from_name(std::string_view text);
std::string_view name(Evaluation evaluation);

/// Reads "fixed", "moving" or "both", of a knee also "insert" or "femur".
/// @throws std::invalid_argument for anything else, naming the text.
Integration integration_from_name(std::string_view text);
std::string_view name(Integration integration);

struct PairSettings {
  Evaluation evaluation = Evaluation::kExact;
  Integration integration = Integration::kFixed;
  /// Of the fast evaluation; exact needs none.
  geometry::DistanceFieldSettings field;
  /// Folder that keeps the fast evaluation's distance fields, by content; empty: none is kept.
  std::filesystem::path cache_directory;
  int threads = 0;  ///< of building distance fields; 0: all
};

/// Elastic layers by face, for laws that have one. Empty: the law's own.
struct PairLayers {
  std::vector<Layer> moving;               ///< of the moving surface's faces
  std::vector<std::vector<Layer>> fixed;   ///< of each compartment's faces
};

/// The contact of a pair. Const and thread-safe; the same pose gives the same bytes on every call.
class ContactPair {
 public:
  /// One compartment's integrals: over its own faces in the moving body's distance, and over the
  /// moving body's faces in its distance. At least one; with both, loads are their mean.
  struct Compartment {
    std::shared_ptr<const SurfaceIntegral> over_fixed;
    std::shared_ptr<const SurfaceIntegral> over_moving;
  };

  /// @throws std::invalid_argument if there is no compartment, or one without an integral.
  explicit ContactPair(std::vector<Compartment> compartments);

  std::size_t compartments() const { return compartments_.size(); }

  /// The whole of one compartment. @pre pose is finite, compartment < compartments().
  CompartmentLoads evaluate(const Pose& pose, std::size_t compartment,
                            Derivatives derivatives) const;

  /// Depth and pressure of each of the compartment's faces; of the moving body's where only those
  /// are integrated. @pre as evaluate().
  FacePressure face_pressure(const Pose& pose, std::size_t compartment) const;

 private:
  std::vector<Compartment> compartments_;
};

/// A pair from its surfaces.
/// @param moving surface of the moving body in F [m], normals out of it. Open or closed.
/// @param fixed the compartments' surfaces in T [m], normals out of the fixed body.
/// @throws std::invalid_argument naming the mesh that is not well formed, or layers that do not
/// match: another number than faces, a value that is not finite and above 0, a law that has none.
ContactPair make_contact_pair(const geometry::TriangleMesh& moving,
                              const std::vector<geometry::TriangleMesh>& fixed,
                              const ContactLaw& law = {}, const PairSettings& settings = {},
                              const PairLayers& layers = {});

}  // namespace condyle::contact
