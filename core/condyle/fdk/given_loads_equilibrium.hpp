// SPDX-License-Identifier: Apache-2.0
// A knee's equilibrium under given loads, as a problem for the Newton solver. Symbols: given_loads_input.hpp.
//
//   Q(α)   = Gᵀ (contact wrench + ligament wrenches) + restraint springs     on all six coordinates of the pose
//   R f    = τ − s e_k Q_θz      min Σ w (f/N)^p + …,   l ≤ f ≤ N      recruitment; k knee flexion, s = dq_k/dθz
//   r(α)   = Q + R_s f − τ_s − Gᵀ W                            on α: what acts less what is needed; 0 in equilibrium
//
// Contact and ligaments carry part of the knee's flexion moment, so muscle forces depend on α, and the Jacobian holds
// recruitment's sensitivity:
//   J = ∂Q/∂α − ∂(Gᵀ W)/∂α + R_s ∂f/∂α + (∂R_s/∂α) f,      R ∂f/∂α = −s e_k ∂Q_θz/∂α − (∂R/∂α) f
// Where muscles cannot balance the loads, f is the nearest they can do and counts as constant: the search goes on, and
// whoever asked finds recruitment's status. f has kinks where a muscle begins to act: J is one-sided there.
#pragma once

#include <vector>

#include "condyle/fdk/given_loads_input.hpp"
#include "condyle/numerics/newton_solver.hpp"
#include "condyle/recruitment/recruitment.hpp"

namespace condyle::fdk {

class GivenLoadsEquilibrium : public numerics::EquilibriumProblem {
 public:
  /// Refers to, and does not own, its arguments. @pre they are valid and `solver` is of the setup's muscles.
  GivenLoadsEquilibrium(const contact::ContactModel& contact, const GivenLoadsSetup& setup,
                        recruitment::RecruitmentSolver& solver, const GivenLoadsFrame& frame);

  int size() const override { return 5; }
  numerics::LoadKind load_kind(int i) const override;
  std::string_view coordinate_name(int i) const override;
  void residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) override;
  void residual_and_jacobian(const numerics::Unknowns& alpha, numerics::Unknowns& r,
                             numerics::Jacobian& J) override;

  numerics::Unknowns unknowns(const Pose& pose) const;
  /// The pose with these unknowns and the frame's flexion in it.
  Pose pose(const numerics::Unknowns& alpha) const;

  // Of the last α that was evaluated.
  const contact::ContactLoads& loads() const { return loads_; }
  const recruitment::Recruitment& muscles() const { return solver_.result(); }

 private:
  void evaluate(const numerics::Unknowns& alpha, contact::Derivatives derivatives,
                numerics::Unknowns& r);
  void arms_at(const numerics::Unknowns& alpha);
  // ∂(R; R_s)/∂α_j.
  Eigen::Map<const recruitment::RowMatrix> arms_change(int j) const;
  Matrix6 stiffness() const;

  const contact::ContactModel& contact_;
  const GivenLoadsSetup& setup_;
  recruitment::RecruitmentSolver& solver_;
  const GivenLoadsFrame& frame_;
  Pose pose_ = Pose::Zero();
  contact::ContactLoads loads_;
  Wrench joint_ = Wrench::Zero();  // contact and ligaments
  recruitment::Vector balance_;    // τ − s e_k Q_θz
  recruitment::RowMatrix arms_, secondary_arms_;
  recruitment::RowMatrix load_changes_, arm_changes_, no_change_, force_changes_, reserve_changes_;
};

}  // namespace condyle::fdk
