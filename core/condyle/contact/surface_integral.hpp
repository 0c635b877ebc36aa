// SPDX-License-Identifier: Apache-2.0
// The strategy behind the mesh contact: how the contact integral over one surface against the
// distance of another body is evaluated.
//
// Every strategy integrates the same thing: over the faces of a surface of body P, each at its
// centroid q with area A, d = max(0, −φ(q)), φ the signed distance of body D; energy Σ A W(d), force
// of a face A p(d) along −∇φ on D. A face whose closest point lies on D's open border does not
// count; its area goes to border_area. A strategy takes a whole surface at once, so that it may cull
// and vectorise as it likes.
#pragma once

#include <memory>

#include "condyle/common/pose.hpp"
#include "condyle/contact/contact_law.hpp"
#include "condyle/contact/contact_model.hpp"
#include "condyle/contact/contact_sums.hpp"
#include "condyle/contact/surface_faces.hpp"
#include "condyle/geometry/signed_distance.hpp"

namespace condyle::contact {

/// A loaded face whose normal n and gradient g of the other body's distance have g·n above this
/// points the same way as the surface it touches: the overlap has passed through to a back face. In
/// contact g·n is near −1, at an edge near 0; cos 60° is beyond what an edge of the insert does.
inline constexpr double kBackFaceCosine = 0.5;

/// A face this far from an open border, or this far below its continuation, is no overlap that the
/// border cuts off but elsewhere [m]: it does not go to border_area.
inline constexpr double kFarFromBorder = 10e-3, kDeepestAtBorder = 5e-3;

/// Depth and pressure of each face of a surface; zero where not loaded.
struct FacePressure {
  Eigen::VectorXd depth;     ///< m [m]
  Eigen::VectorXd pressure;  ///< m [Pa]
};

/// Evaluates the contact integral of one surface against one body's distance. Const and
/// thread-safe; the same placement gives the same bytes on every call.
class SurfaceIntegral {
 public:
  virtual ~SurfaceIntegral() = default;

  /// @param X_DP placement of P's frame in D's. @pre finite.
  virtual ContactSums sums(const RigidTransform& X_DP, Derivatives derivatives) const = 0;

  /// Face by face, in the order of the surface's faces. @pre X_DP is finite.
  virtual FacePressure face_pressure(const RigidTransform& X_DP) const = 0;
};

/// Distance to the triangles of D themselves: the truth that everything else is measured against.
/// Wrench and stiffness are those of the exact distance of the polyhedral surface: ∇φ jumps between
/// the regions of neighbouring features, so the stiffness is exact wherever φ is smooth at every
/// loaded centroid.
/// @param distance of D; shared: several surfaces may be integrated against one body.
/// @param faces of P, well formed.
std::unique_ptr<SurfaceIntegral> make_exact_integral(
    std::shared_ptr<const geometry::SignedDistance> distance, SurfaceFaces faces,
    const ContactLaw& law);

}  // namespace condyle::contact
