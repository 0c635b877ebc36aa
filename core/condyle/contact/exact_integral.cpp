// SPDX-License-Identifier: Apache-2.0
// The exact contact integral: see make_exact_integral in surface_integral.hpp.
#include <utility>

#include "condyle/contact/surface_integral.hpp"

namespace condyle::contact {
namespace {

class ExactIntegral final : public SurfaceIntegral {
 public:
  ExactIntegral(std::shared_ptr<const geometry::SignedDistance> distance, SurfaceFaces faces,
                const ContactLaw& law)
      : distance_(std::move(distance)), faces_(std::move(faces)), law_(law) {}

  ContactSums sums(const RigidTransform& X_DP, Derivatives derivatives) const override {
    ContactSums sums;
    for_each_overlap(X_DP, [&](Eigen::Index f, const Vector3& q,
                               const geometry::SurfaceQuery& query) {
      if (query.on_border) {
        const double depth = -query.continuation;
        const bool cut_off = depth > 0.0 && depth < kDeepestAtBorder &&
                             -query.distance < kFarFromBorder;
        if (cut_off) sums.border_area += faces_.areas[f];
        return;
      }
      const double depth = -query.distance;
      const LawValue value = law_at(f, depth);
      const LoadedPoint point{q,     query.gradient, faces_.areas[f],    depth,
                              value.energy, value.pressure, value.pressure_rate};
      sums.add(point);
      if (derivatives == Derivatives::kStiffness) sums.add_stiffness(point, query.hessian());
      const Vector3 normal = X_DP.R * faces_.normals.row(f).transpose();
      sums.back_face |= query.gradient.dot(normal) > kBackFaceCosine;
    });
    return sums;
  }

  FacePressure face_pressure(const RigidTransform& X_DP) const override {
    FacePressure result{Eigen::VectorXd::Zero(faces_.count()),
                        Eigen::VectorXd::Zero(faces_.count())};
    for_each_overlap(X_DP, [&](Eigen::Index f, const Vector3&, const geometry::SurfaceQuery& query) {
      if (query.on_border) return;
      result.depth[f] = -query.distance;
      result.pressure[f] = law_at(f, -query.distance).pressure;
    });
    return result;
  }

 private:
  LawValue law_at(Eigen::Index f, double depth) const {
    return faces_.layers.empty() ? law_.at(depth)
                                 : law_.at(depth, faces_.layers[static_cast<std::size_t>(f)]);
  }

  // Calls visit(face, q, query) for the faces whose centroid is inside D, in face order, so that
  // sums have one order.
  template <typename Visit>
  void for_each_overlap(const RigidTransform& X_DP, Visit visit) const {
    geometry::SurfaceQuery query;
    for (Eigen::Index f = 0; f < faces_.count(); ++f) {
      const Vector3 q = X_DP * Vector3(faces_.centroids.row(f));
      if (distance_->penetrates(q, query)) visit(f, q, query);
    }
  }

  std::shared_ptr<const geometry::SignedDistance> distance_;
  SurfaceFaces faces_;
  ContactLaw law_;
};

}  // namespace

std::unique_ptr<SurfaceIntegral> make_exact_integral(
    std::shared_ptr<const geometry::SignedDistance> distance, SurfaceFaces faces,
    const ContactLaw& law) {
  return std::make_unique<ExactIntegral>(std::move(distance), std::move(faces), law);
}

}  // namespace condyle::contact
