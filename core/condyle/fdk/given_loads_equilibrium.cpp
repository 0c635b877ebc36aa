// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads_equilibrium.hpp"

namespace condyle::fdk {
namespace {

constexpr std::array<std::string_view, 5> kNames{"x", "y", "z", "theta_x", "theta_y"};
constexpr int kUnknowns = 5;

}  // namespace

GivenLoadsEquilibrium::GivenLoadsEquilibrium(const contact::ContactModel& contact,
                                             const GivenLoadsSetup& setup,
                                             recruitment::RecruitmentSolver& solver,
                                             const GivenLoadsFrame& frame)
    : contact_(contact),
      setup_(setup),
      solver_(solver),
      frame_(frame),
      balance_(frame.loads),
      arms_(frame.moment_arms),
      secondary_arms_(frame.secondary_arms) {
  const Eigen::Index n = arms_.rows(), m = arms_.cols();
  load_changes_.setZero(kUnknowns, n);
  arm_changes_.resize(frame.arms_by_pose.rows() > 0 ? kUnknowns * n : 0, m);
  no_change_.resize(0, m);
  force_changes_.setZero(kUnknowns, m);
  reserve_changes_.setZero(kUnknowns, n);
  for (int j = 0; j < kUnknowns && arm_changes_.rows() > 0; ++j) {
    arm_changes_.middleRows(j * n, n) = frame.arms_by_pose.middleRows(j * (n + 5), n);
  }
}

numerics::LoadKind GivenLoadsEquilibrium::load_kind(int i) const {
  return i < 3 ? numerics::LoadKind::kForce : numerics::LoadKind::kMoment;
}

std::string_view GivenLoadsEquilibrium::coordinate_name(int i) const {
  return kNames[static_cast<std::size_t>(i)];
}

numerics::Unknowns GivenLoadsEquilibrium::unknowns(const Pose& pose) const {
  return pose.head<kUnknowns>();
}

Pose GivenLoadsEquilibrium::pose(const numerics::Unknowns& alpha) const {
  Pose pose;
  pose.head<kUnknowns>() = alpha;
  pose[kThetaZ] = -frame_.flexion;
  return pose;
}

Eigen::Map<const recruitment::RowMatrix> GivenLoadsEquilibrium::arms_change(int j) const {
  const Eigen::Index rows = arms_.rows() + 5, m = arms_.cols();
  return {frame_.arms_by_pose.data() + j * rows * m, rows, m};
}

void GivenLoadsEquilibrium::arms_at(const numerics::Unknowns& alpha) {
  if (frame_.arms_by_pose.rows() == 0) return;
  const Eigen::Index n = arms_.rows();
  arms_ = frame_.moment_arms;
  secondary_arms_ = frame_.secondary_arms;
  for (int j = 0; j < kUnknowns; ++j) {
    const double moved = alpha[j] - frame_.arms_at[j];
    arms_ += moved * arms_change(j).topRows(n);
    secondary_arms_ += moved * arms_change(j).bottomRows(5);
  }
}

void GivenLoadsEquilibrium::evaluate(const numerics::Unknowns& alpha,
                                     contact::Derivatives derivatives, numerics::Unknowns& r) {
  pose_ = pose(alpha);
  loads_ = contact_.evaluate(pose_, derivatives);
  joint_ = loads_.total_wrench();
  for (const model::Ligament& ligament : setup_.ligaments) {
    joint_ += model::ligament_wrench(ligament, pose_);
  }
  Vector6 Q = generalised_force(pose_, joint_);
  if (setup_.restraint) Q += restraint_force(*setup_.restraint, pose_);
  arms_at(alpha);
  balance_ = frame_.loads;
  if (setup_.knee_coordinate >= 0) {
    balance_[setup_.knee_coordinate] -= setup_.knee_sign() * Q[kThetaZ];
  }
  const auto& recruited =
      solver_.solve({arms_, balance_, frame_.strengths, frame_.minima}, solver_.warm_start());
  r = Q.head<kUnknowns>() - frame_.secondary_loads -
      generalised_force(pose_, frame_.wrench).head<kUnknowns>();
  r.noalias() += secondary_arms_ * recruited.forces;
}

void GivenLoadsEquilibrium::residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) {
  evaluate(alpha, contact::Derivatives::kNone, r);
}

Matrix6 GivenLoadsEquilibrium::stiffness() const {
  Matrix6 S = loads_.total_stiffness();
  for (const model::Ligament& ligament : setup_.ligaments) {
    S += model::ligament_stiffness(ligament, pose_);
  }
  Matrix6 K = generalised_stiffness(pose_, joint_, S);
  if (setup_.restraint) K += restraint_stiffness(*setup_.restraint, pose_);
  return K;
}

void GivenLoadsEquilibrium::residual_and_jacobian(const numerics::Unknowns& alpha,
                                                  numerics::Unknowns& r, numerics::Jacobian& J) {
  evaluate(alpha, contact::Derivatives::kStiffness, r);
  const Matrix6 K = stiffness();
  J = (K - generalised_stiffness(pose_, frame_.wrench, Matrix6::Zero()))
          .topLeftCorner<kUnknowns, kUnknowns>();
  const bool arms_move = arm_changes_.rows() > 0;
  const recruitment::Recruitment& recruited = solver_.result();
  if (arms_move) {
    for (int j = 0; j < kUnknowns; ++j) {
      J.col(j) += arms_change(j).bottomRows(5) * recruited.forces;
    }
  }
  if (!recruited.converged() || (setup_.knee_coordinate < 0 && !arms_move)) return;
  if (setup_.knee_coordinate >= 0) {
    load_changes_.col(setup_.knee_coordinate) =
        -setup_.knee_sign() * K.row(kThetaZ).head<kUnknowns>().transpose();
  }
  solver_.forces_along(load_changes_, arm_changes_, no_change_, force_changes_, reserve_changes_);
  J.noalias() += secondary_arms_ * force_changes_.transpose();
}

}  // namespace condyle::fdk
