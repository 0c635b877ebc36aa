// SPDX-License-Identifier: Apache-2.0
// Forces on bodies and what they are worth in coordinates.
//
//   τ_k = Σ_a ∂m_a/∂q_k (S_a · W)     over the axes a to the body,
//   W = (moment + point × force, force) at ground's origin:
//
// the generalised force of the load: its power is Σ τ_k q̇_k. Dependent coordinates get none, those
// they follow get theirs.
#pragma once

#include <Eigen/Core>
#include <span>

#include "condyle/common/types.hpp"
#include "condyle/model/kinematics.hpp"

namespace condyle::model {

/// A load on a body that is known in ground, such as a floor's reaction on a foot. The point moves
/// in the world as measured; it does not move with the body when coordinates are varied.
struct ExternalLoad {
  int body = -1;                       ///< −1: on ground, without effect
  Vector3 force_G = Vector3::Zero();   ///< [N]
  Vector3 point_G = Vector3::Zero();   ///< where the force acts [m]
  Vector3 moment_G = Vector3::Zero();  ///< free moment [Nm]
};

/// Adds a load's generalised force to tau. @param tau (n_coordinates) [Nm, N].
void add_generalised_force(const Kinematics& kinematics, const ExternalLoad& load,
                           Eigen::Ref<Eigen::VectorXd> tau);
void add_generalised_force(const Kinematics& kinematics, int body, const Vector3& force_G,
                           const Vector3& point_G, const Vector3& moment_G,
                           Eigen::Ref<Eigen::VectorXd> tau);

/// Adds ∂τ/∂q_c of a load that stays as it is in ground: its geometric stiffness. For a load that
/// changes with q, add the generalised force of its change to column c.
/// @param coordinates the c of the columns; a dependent one's column gets nothing.
/// @param derivative (n_coordinates, coordinates.size()).
void add_generalised_force_derivative(const Kinematics& kinematics, const ExternalLoad& load,
                                      std::span<const int> coordinates,
                                      Eigen::Ref<Eigen::MatrixXd> derivative);

}  // namespace condyle::model
