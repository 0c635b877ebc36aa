// SPDX-License-Identifier: Apache-2.0
// Exact evaluation of the contact integral: see make_exact_evaluation in face_evaluation.hpp.
#include <Eigen/Geometry>
#include <algorithm>

#include "condyle/contact/face_evaluation.hpp"
#include "condyle/contact/load_sum.hpp"
#include "condyle/geometry/signed_distance.hpp"

namespace condyle::contact {
namespace {

class ExactEvaluation final : public FaceEvaluation {
 public:
  ExactEvaluation(const geometry::TriangleMesh& femur, const Compartments& compartments,
                  const ContactLaw& law)
      : distance_(femur), compartments_(compartments), law_(law) {}

  SideLoads evaluate(const Pose& pose, Side side, Derivatives derivatives) const override {
    SideLoads loads;
    LoadSum sum;
    const RigidTransform X_TF = transform_TF(pose);
    for_each_overlap(X_TF, side, [&](Eigen::Index f, const geometry::SurfaceQuery& query) {
      const CompartmentFaces& faces = compartments_[side];
      const double area = faces.areas[f];
      if (query.on_border) {
        loads.border_area += area;
        return;
      }
      const double depth = -query.distance;
      const LawValue value = law_.at(depth);
      const Vector3 centroid = faces.centroids.row(f);
      const Vector3 gradient = X_TF.R * query.gradient;
      const LoadedPoint point{centroid - X_TF.p, gradient, area, value.pressure,
                              value.pressure_rate};
      if (derivatives == Derivatives::kStiffness) {
        sum.add(point, X_TF.R * query.hessian() * X_TF.R.transpose());
      } else {
        sum.add_wrench(point);
      }
      const double force = area * value.pressure;
      loads.energy += area * value.energy;
      loads.volume += area * depth;
      loads.area += area;
      loads.max_depth = std::max(loads.max_depth, depth);
      loads.peak_pressure = std::max(loads.peak_pressure, value.pressure);
      loads.pressure_sum += force;
      loads.pressure_moment += force * centroid;
      loads.back_face |= gradient.dot(faces.normals.row(f).transpose()) > kBackFaceCosine;
    });
    loads.wrench = sum.wrench();
    if (derivatives == Derivatives::kStiffness) loads.stiffness = sum.stiffness(pose);
    return loads;
  }

  FacePressure face_pressure(const Pose& pose, Side side) const override {
    const auto count = compartments_[side].count();
    FacePressure result{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
    for_each_overlap(transform_TF(pose), side,
                     [&](Eigen::Index f, const geometry::SurfaceQuery& query) {
                       if (query.on_border) return;
                       result.depth[f] = -query.distance;
                       result.pressure[f] = law_.at(-query.distance).pressure;
                     });
    return result;
  }

 private:
  // Calls visit(face, query) for the faces whose centroid is inside the femur, in face order, so
  // that sums have one order.
  template <typename Visit>
  void for_each_overlap(const RigidTransform& X_TF, Side side, Visit visit) const {
    const RigidTransform X_FT = X_TF.inverse();
    const CompartmentFaces& faces = compartments_[side];
    geometry::SurfaceQuery query;
    for (Eigen::Index f = 0; f < faces.count(); ++f) {
      const Vector3 centroid_F = X_FT * Vector3(faces.centroids.row(f));
      if (distance_.penetrates(centroid_F, query)) visit(f, query);
    }
  }

  geometry::SignedDistance distance_;
  Compartments compartments_;
  ContactLaw law_;
};

}  // namespace

CompartmentFaces compartment_faces(const geometry::TriangleMesh& mesh) {
  CompartmentFaces faces{geometry::face_centroids(mesh), geometry::face_areas(mesh),
                         geometry::VertexArray::Zero(mesh.face_count(), 3)};
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    const Vector3 a = mesh.vertices.row(mesh.faces(f, 0));
    const Vector3 b = mesh.vertices.row(mesh.faces(f, 1));
    const Vector3 c = mesh.vertices.row(mesh.faces(f, 2));
    if (faces.areas[f] > 0.0) faces.normals.row(f) = (b - a).cross(c - a) / (2.0 * faces.areas[f]);
  }
  return faces;
}

std::unique_ptr<FaceEvaluation> make_exact_evaluation(const geometry::TriangleMesh& femur,
                                                      const Compartments& compartments,
                                                      const ContactLaw& law) {
  return std::make_unique<ExactEvaluation>(femur, compartments, law);
}

}  // namespace condyle::contact
