// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/external_load.hpp"

#include "condyle/model/screw.hpp"

namespace condyle::model {

void add_generalised_force(const Kinematics& kinematics, const ExternalLoad& load,
                           Eigen::Ref<Eigen::VectorXd> tau) {
  const ForceScrew W = wrench_at_origin(load.force_G, load.point_G, load.moment_G);
  for (const int a : kinematics.model().axes_to(load.body)) {
    const double share = power(axis_screw(kinematics.axes()[static_cast<std::size_t>(a)]), W);
    for (const TermNow& term : kinematics.terms(a)) tau[term.coordinate] += term.slope * share;
  }
}

void add_generalised_force(const Kinematics& kinematics, int body, const Vector3& force_G,
                           const Vector3& point_G, const Vector3& moment_G,
                           Eigen::Ref<Eigen::VectorXd> tau) {
  add_generalised_force(kinematics, ExternalLoad{body, force_G, point_G, moment_G}, tau);
}

// Axis j carries every later axis a of the chain along: δS_a = S_j × S_a. A term's own slope
// changes by its curvature.
void add_generalised_force_derivative(const Kinematics& kinematics, const ExternalLoad& load,
                                      std::span<const int> coordinates,
                                      Eigen::Ref<Eigen::MatrixXd> derivative) {
  const ForceScrew W = wrench_at_origin(load.force_G, load.point_G, load.moment_G);
  const std::span<const int> chain = kinematics.model().axes_to(load.body);
  const auto axis = [&](int a) {
    return axis_screw(kinematics.axes()[static_cast<std::size_t>(a)]);
  };
  for (std::size_t column = 0; column < coordinates.size(); ++column) {
    auto out = derivative.col(static_cast<Eigen::Index>(column));
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Screw S_j = axis(chain[i]);
      for (const TermNow& by : kinematics.terms(chain[i])) {
        if (by.coordinate != coordinates[column]) continue;
        out[by.coordinate] += by.curvature * power(S_j, W);
        for (std::size_t k = i + 1; k < chain.size(); ++k) {
          const double change = by.slope * power(cross(S_j, axis(chain[k])), W);
          for (const TermNow& term : kinematics.terms(chain[k])) {
            out[term.coordinate] += term.slope * change;
          }
        }
      }
    }
  }
}

}  // namespace condyle::model
