// SPDX-License-Identifier: Apache-2.0
// The equilibrium of a knee under simulator loads, as a problem for the Newton solver.
//
//   r = Q_contact + Q_applied + Q_ligaments + Q_springs,   Q = G(pose)ᵀ·wrench   (common/pose.hpp)
//
// restricted to the free coordinates; the others keep the values of `pose`. The Jacobian is the same sum of generalised
// stiffnesses: analytic throughout.
#pragma once

#include <span>
#include <vector>

#include "condyle/contact/contact_model.hpp"
#include "condyle/fdk/knee_loads.hpp"
#include "condyle/model/ligament.hpp"
#include "condyle/numerics/newton_solver.hpp"

namespace condyle::fdk {

/// What is fixed while a knee is simulated. Refers to, and does not own, its contact model.
struct KneeSetup {
  const contact::ContactModel& contact;
  double axial_offset = 0.0;  ///< of the axial line, medial of To [m]
  RestraintSprings restraint;
  std::vector<model::Ligament> ligaments;
};

/// Net generalised force on all six coordinates, contact loads given.
Vector6 net_generalised_force(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                              const contact::ContactLoads& loads);

/// Its derivative by the pose; `loads` with stiffness.
Matrix6 net_generalised_stiffness(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                                  const contact::ContactLoads& loads);

class KneeEquilibrium : public numerics::EquilibriumProblem {
 public:
  /// @param pose values of the coordinates that are not free.
  /// @param free which coordinates are unknown, in the order of the unknowns (PoseIndex).
  /// `setup` must outlive the problem.
  KneeEquilibrium(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                  std::span<const int> free);

  int size() const override { return static_cast<int>(free_.size()); }
  numerics::LoadKind load_kind(int i) const override;
  std::string_view coordinate_name(int i) const override;
  void residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) override;
  void residual_and_jacobian(const numerics::Unknowns& alpha, numerics::Unknowns& r,
                             numerics::Jacobian& J) override;

  /// The free coordinates of a pose, as unknowns.
  numerics::Unknowns unknowns(const Pose& pose) const;
  /// The pose with these unknowns in it.
  Pose pose(const numerics::Unknowns& alpha) const;

 private:
  const KneeSetup& setup_;
  const KneeLoad load_;
  const Pose fixed_;
  const std::vector<int> free_;
};

}  // namespace condyle::fdk
