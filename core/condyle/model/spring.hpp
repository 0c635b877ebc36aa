// SPDX-License-Identifier: Apache-2.0
// Springs and dampers on coordinates: generalised force −stiffness·(q − rest) − viscosity·q̇.
// A spring on a dependent coordinate acts on the one it follows, through the coupling's slope.
#pragma once

#include <Eigen/Core>
#include <span>

#include "condyle/model/kinematics.hpp"

namespace condyle::model {

/// Adds the springs' generalised force. @param tau (n_coordinates) [Nm, N].
void add_spring_force(const Kinematics& kinematics, Eigen::Ref<Eigen::VectorXd> tau);

/// Adds its ∂/∂q_c, rates of free coordinates held.
/// @param coordinates the c of the columns. @param derivative (n_coordinates, coordinates.size()).
void add_spring_force_derivative(const Kinematics& kinematics, std::span<const int> coordinates,
                                 Eigen::Ref<Eigen::MatrixXd> derivative);

}  // namespace condyle::model
