// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_integral.hpp"

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "condyle/contact/fast_dispatch.hpp"
#include "condyle/contact/fast_faces.hpp"

namespace condyle::contact {
namespace {

Matrix3 symmetric(const double s[6]) {
  Matrix3 S;
  S << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2];
  return S;
}

Matrix3 by_rows(const double m[9]) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m);
}

ContactSums from_kernel(const fast::Sums& k) {
  ContactSums sums;
  sums.energy = k.energy;
  sums.volume = k.volume;
  sums.area = k.area;
  sums.border_area = k.border_area;
  sums.max_depth = k.max_depth;
  sums.peak_pressure = k.peak_pressure;
  sums.pressure_sum = k.pressure_sum;
  sums.pressure_moment = Eigen::Map<const Vector3>(k.pressure_moment);
  sums.back_face = k.max_facing > kBackFaceCosine;
  sums.force = Eigen::Map<const Vector3>(k.force);
  sums.dyad = by_rows(k.dyad);
  sums.S = symmetric(k.S);
  sums.Sq = by_rows(k.Sq);
  sums.qSq = symmetric(k.qSq);
  return sums;
}

// A law and its layers, for the kernel to call back: any law, a group of faces at a time.
struct LawOfFaces {
  ContactLaw law;
  std::vector<Layer> layers;  // in the kernel's order; empty: the law's own

  static void evaluate(const void* self, int first_face, const double* depth, int n, double* energy,
                       double* pressure, double* rate) {
    const auto& [law, layers] = *static_cast<const LawOfFaces*>(self);
    for (int i = 0; i < n; ++i) {
      const LawValue value =
          layers.empty() ? law.at(depth[i])
                         : law.at(depth[i], layers[static_cast<std::size_t>(first_face + i)]);
      energy[i] = value.energy;
      pressure[i] = value.pressure;
      rate[i] = value.pressure_rate;
    }
  }
};

bool is_linear(const ContactLaw& law) {
  return std::holds_alternative<LinearVolumeLaw>(law.variant()) ||
         std::holds_alternative<ThinLayerLinearLaw>(law.variant());
}

class FastIntegral final : public SurfaceIntegral {
 public:
  FastIntegral(std::shared_ptr<const geometry::DistanceField> field, SurfaceFaces faces,
               const ContactLaw& law, fast::Kernel kernel)
      : field_(std::move(field)),
        faces_(std::move(faces)),
        field_view_(fast::field_view(*field_)),
        sorted_(faces_),
        law_{law, {}},
        kernel_(kernel) {
    if (!faces_.layers.empty()) {
      for (const auto f : sorted_.order()) {
        law_.layers.push_back(faces_.layers[static_cast<std::size_t>(f)]);
      }
    }
    const bool uniform_linear = is_linear(law) && law_.layers.empty();
    law_view_.modulus = uniform_linear ? law.at(1.0).pressure_rate : 0.0;
    law_view_.law = &law_;
    law_view_.batch = uniform_linear ? nullptr : &LawOfFaces::evaluate;
  }
  FastIntegral(const FastIntegral&) = delete;  // law_view_ points into this object
  FastIntegral& operator=(const FastIntegral&) = delete;

  ContactSums sums(const RigidTransform& X_DP, Derivatives derivatives) const override {
    fast::PlacementView placement;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) placement.R[3 * a + b] = X_DP.R(a, b);
      placement.p[a] = X_DP.p[a];
    }
    fast::Sums sums;
    kernel_(field_view_, sorted_.faces(), sorted_.clusters(), law_view_, placement,
            derivatives == Derivatives::kStiffness, sums);
    return from_kernel(sums);
  }

  FacePressure face_pressure(const RigidTransform& X_DP) const override {
    FacePressure result{Eigen::VectorXd::Zero(faces_.count()),
                        Eigen::VectorXd::Zero(faces_.count())};
    for (Eigen::Index f = 0; f < faces_.count(); ++f) {
      const Vector3 q = X_DP * Vector3(faces_.centroids.row(f));
      const double depth = -field_->value(q);
      if (!(depth > 0.0) || field_->on_border(q)) continue;
      result.depth[f] = depth;
      result.pressure[f] =
          faces_.layers.empty()
              ? law_.law.at(depth).pressure
              : law_.law.at(depth, faces_.layers[static_cast<std::size_t>(f)]).pressure;
    }
    return result;
  }

 private:
  std::shared_ptr<const geometry::DistanceField> field_;
  SurfaceFaces faces_;  // in the caller's order
  fast::FieldView field_view_;
  fast::SortedFaces sorted_;
  LawOfFaces law_;
  fast::LawView law_view_{};
  fast::Kernel kernel_;
};

}  // namespace

std::unique_ptr<SurfaceIntegral> make_fast_integral(
    std::shared_ptr<const geometry::DistanceField> field, SurfaceFaces faces, const ContactLaw& law,
    InstructionSet set) {
  return std::make_unique<FastIntegral>(std::move(field), std::move(faces), law,
                                        fast::kernel_for(set));
}

}  // namespace condyle::contact
