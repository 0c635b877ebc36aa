// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/spring.hpp"

namespace condyle::model {
namespace {

double force(const Kinematics& kinematics, const ModelSpring& spring) {
  return -spring.stiffness * (kinematics.q()[spring.coordinate] - spring.rest) -
         spring.viscosity * kinematics.qd()[spring.coordinate];
}

}  // namespace

void add_spring_force(const Kinematics& kinematics, Eigen::Ref<Eigen::VectorXd> tau) {
  for (const ModelSpring& spring : kinematics.model().springs()) {
    const CoordinateNow& c = kinematics.coordinate(spring.coordinate);
    tau[c.independent] += c.slope * force(kinematics, spring);
  }
}

// q = g(i): τ_i = g'·F(g, g' i̇), so ∂τ_i/∂i = g''·F − g'·(stiffness·g' + viscosity·g''·i̇).
void add_spring_force_derivative(const Kinematics& kinematics, std::span<const int> coordinates,
                                 Eigen::Ref<Eigen::MatrixXd> derivative) {
  for (const ModelSpring& spring : kinematics.model().springs()) {
    const CoordinateNow& c = kinematics.coordinate(spring.coordinate);
    const double change = spring.stiffness * c.slope +
                          spring.viscosity * c.curvature * kinematics.qd()[c.independent];
    for (std::size_t column = 0; column < coordinates.size(); ++column) {
      if (coordinates[column] != c.independent) continue;
      derivative(c.independent, static_cast<Eigen::Index>(column)) +=
          c.curvature * force(kinematics, spring) - c.slope * change;
    }
  }
}

}  // namespace condyle::model
