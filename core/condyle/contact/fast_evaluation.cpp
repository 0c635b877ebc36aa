// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_evaluation.hpp"

#include <Eigen/Geometry>
#include <utility>
#include <variant>

#include "condyle/contact/fast_dispatch.hpp"
#include "condyle/contact/fast_faces.hpp"
#include "condyle/geometry/distance_field_cache.hpp"

namespace condyle::contact {
namespace {

// Any law, a batch at a time.
void evaluate_law(const void* law, const double* depth, int n, double* energy, double* pressure,
                  double* rate) {
  const auto& any = *static_cast<const ContactLaw*>(law);
  for (int i = 0; i < n; ++i) {
    const LawValue value = any.at(depth[i]);
    energy[i] = value.energy;
    pressure[i] = value.pressure;
    rate[i] = value.pressure_rate;
  }
}

Matrix3 symmetric(const double s[6]) {
  Matrix3 S;
  S << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
  return S;
}

Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// ∂wrench/∂twist in T from the sums in F: see fast_kernel.hpp.
Matrix6 twist_stiffness(const fast::Sums& sums, const Matrix3& R_TF) {
  const Matrix3 S = symmetric(sums.S), qSq = symmetric(sums.qSq);
  const Matrix3 Sq = Eigen::Map<const RowMajor3>(sums.Sq);
  const Matrix3 dyad = Eigen::Map<const RowMajor3>(sums.dyad);
  const Matrix3 force = cross_matrix(Eigen::Map<const Vector3>(sums.force));
  const Matrix3 by_turn = qSq - dyad + dyad.trace() * Matrix3::Identity();
  Matrix6 K;
  K.topLeftCorner<3, 3>() = R_TF * S * R_TF.transpose();
  K.topRightCorner<3, 3>() = R_TF * (-Sq - force) * R_TF.transpose();
  K.bottomLeftCorner<3, 3>() = R_TF * (force - Sq.transpose()) * R_TF.transpose();
  K.bottomRightCorner<3, 3>() = R_TF * by_turn * R_TF.transpose();
  return K;
}

class FastEvaluation final : public FaceEvaluation {
 public:
  FastEvaluation(std::shared_ptr<const geometry::DistanceField> field,
                 const Compartments& compartments, const ContactLaw& law, fast::Kernel kernel)
      : field_(std::move(field)),
        field_view_(fast::field_view(*field_)),
        law_(law),
        sorted_{fast::SortedFaces(compartments[kMedial]),
                fast::SortedFaces(compartments[kLateral])},
        centroids_{compartments[kMedial].centroids, compartments[kLateral].centroids},
        kernel_(kernel) {
    const auto* linear = std::get_if<LinearVolumeLaw>(&law_.variant());
    law_view_.modulus = linear != nullptr ? linear->modulus : 0.0;
    law_view_.law = &law_;
    law_view_.batch = linear != nullptr ? nullptr : &evaluate_law;
  }
  FastEvaluation(const FastEvaluation&) = delete;  // law_view_ points into this object
  FastEvaluation& operator=(const FastEvaluation&) = delete;

  SideLoads evaluate(const Pose& pose, Side side, Derivatives derivatives) const override {
    const RigidTransform X_TF = transform_TF(pose), X_FT = X_TF.inverse();
    fast::PlacementView placement;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) placement.R[3 * a + b] = X_FT.R(a, b);
      placement.p[a] = X_FT.p[a];
    }
    const bool stiffness = derivatives == Derivatives::kStiffness;
    const fast::SortedFaces& faces = sorted_[side];
    fast::Sums sums;
    kernel_(field_view_, faces.faces(), faces.clusters(), law_view_, placement, stiffness, sums);

    SideLoads loads;
    const double* D = sums.dyad;  // f qᵀ; q×f from its skew part
    loads.wrench.head<3>() = X_TF.R * Eigen::Map<const Vector3>(sums.force);
    loads.wrench.tail<3>() = X_TF.R * Vector3(D[7] - D[5], D[2] - D[6], D[3] - D[1]);
    if (stiffness) loads.stiffness = twist_stiffness(sums, X_TF.R) * twist_map(pose);
    loads.energy = sums.energy;
    loads.volume = sums.volume;
    loads.area = sums.area;
    loads.border_area = sums.border_area;
    loads.max_depth = sums.max_depth;
    loads.peak_pressure = sums.peak_pressure;
    loads.pressure_sum = sums.pressure_sum;
    loads.pressure_moment =
        X_TF.R * Eigen::Map<const Vector3>(sums.pressure_moment) + sums.pressure_sum * X_TF.p;
    loads.back_face = sums.max_facing > kBackFaceCosine;
    return loads;
  }

  FacePressure face_pressure(const Pose& pose, Side side) const override {
    const RigidTransform X_FT = transform_TF(pose).inverse();
    const geometry::VertexArray& centroids = centroids_[side];
    FacePressure faces{Eigen::VectorXd::Zero(centroids.rows()),
                       Eigen::VectorXd::Zero(centroids.rows())};
    for (Eigen::Index f = 0; f < centroids.rows(); ++f) {
      const Vector3 q = X_FT * Vector3(centroids.row(f));
      const double depth = -field_->value(q);
      if (!(depth > 0.0) || field_->on_border(q)) continue;
      faces.depth[f] = depth;
      faces.pressure[f] = law_.at(depth).pressure;
    }
    return faces;
  }

 private:
  std::shared_ptr<const geometry::DistanceField> field_;
  fast::FieldView field_view_;
  ContactLaw law_;
  fast::LawView law_view_{};
  std::array<fast::SortedFaces, kSides> sorted_;
  std::array<geometry::VertexArray, kSides> centroids_;  // in the caller's order
  fast::Kernel kernel_;
};

}  // namespace

std::unique_ptr<FaceEvaluation> make_fast_evaluation(const geometry::TriangleMesh& femur,
                                                     const Compartments& compartments,
                                                     const ContactLaw& law,
                                                     const FastSettings& settings) {
  auto cached = geometry::load_or_build_distance_field(femur, settings.field,
                                                       settings.cache_directory, settings.threads);
  return make_fast_evaluation(std::move(cached.field), compartments, law);
}

std::unique_ptr<FaceEvaluation> make_fast_evaluation(
    std::shared_ptr<const geometry::DistanceField> field, const Compartments& compartments,
    const ContactLaw& law, InstructionSet set) {
  return std::make_unique<FastEvaluation>(std::move(field), compartments, law,
                                          fast::kernel_for(set));
}

}  // namespace condyle::contact
