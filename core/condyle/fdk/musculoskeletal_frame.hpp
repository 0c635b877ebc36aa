// SPDX-License-Identifier: Apache-2.0
// One time frame of a musculoskeletal model, everything but contact: where bodies are, what generalised forces the motion needs,
// what ligaments and springs give of them, what muscles can do, and how recruitment shares the rest over them.
//
//   τ           inverse dynamics: what must act on the coordinates                       [Nm, N]
//   Q_p         passive: ligaments, springs of coordinates, passive tension of muscles   [Nm, N]
//   R f = τ − Q_p      on the coordinates that muscles balance, R = −∂L/∂q, 0 ≤ f ≤ N
//   residual    τ − Q_p − R f on every coordinate: what contact, or whatever drives the coordinate, gives
//
// Loads Q_c that are known, such as contact at this configuration, are taken off where recruitment is told of them:
// R f = τ − Q_p − Q_c, residual τ − Q_p − Q_c − R f.
//
// Where muscles hang on a body that floats on ligaments and contact (quadriceps on a patella), they have no moment arm on the
// coordinate that they balance: their pull gets there because the columns' coordinates α give. Recruitment can be told how,
// by C (set_coupling), and then balances, of g = τ − Q_p − Q_c on both,
//
//   (R_b + C R_α) f = g_b + C g_α          b the balanced coordinates; C = −K_bα K_αα⁻¹ (coupling)
//
// with K = ∂(τ − Q − R f)/∂α at held f: the balance along the motion in which α stays in equilibrium. Where α is in equilibrium
// it is that of b alone, and with C taken there, f is the optimum over muscles and α together (α eliminated).
//
// Derivatives by some coordinates, the columns: of everything above, with rates and accelerations held. Of R f:
//
//   ∂(R F)/∂q_c = −H_c F + R (∂f/∂q_c + P′ ∂L/∂q_c),   H = ∂²L/∂q²,   F = f + P
//
// with ∂f/∂q_c recruitment's answer to changed loads, moment arms and strengths (recruitment/sensitivity.hpp; strengths
// change with L and, H q̇ ≠ 0, with L̇). Where recruitment did not converge, f counts as held.
//
// The phases are separate calls in this order, so that a caller times or repeats what it needs.
// The workspace of one thread: it allocates when it is made and never again.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "condyle/model/external_load.hpp"
#include "condyle/model/inverse_dynamics.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/model.hpp"
#include "condyle/model/muscle.hpp"
#include "condyle/model/path.hpp"
#include "condyle/model/path_snapshot.hpp"
#include "condyle/model/spring.hpp"
#include "condyle/model/strand.hpp"
#include "condyle/recruitment/recruitment.hpp"

namespace condyle::fdk {

struct MuscleSettings {
  model::StrengthModel strength = model::StrengthModel::kHill;
  recruitment::RecruitmentSettings recruitment;
  /// Strength of the reserve actuator on every coordinate that muscles balance; 0: none.
  double reserve_moment = 0.0;  ///< of rotations [Nm]
  double reserve_force = 0.0;   ///< of translations [N]
  double reserve_price = 1.0;   ///< weight of (e/strength)^p in recruitment
};

/// A muscle now.
struct MuscleNow {
  double length = 0.0;    ///< L [m]
  double velocity = 0.0;  ///< L̇ [m/s]
  model::MuscleStrength strength;
};

class MusculoskeletalFrame {
 public:
  /// @param columns coordinates that derivatives are asked for; none that follows another.
  /// @pre the model outlives it.
  /// @throws std::invalid_argument for impossible muscles, ligaments or settings, by name and value, or a column that
  /// the model has not.
  MusculoskeletalFrame(const model::Model& model, const MuscleSettings& settings, std::span<const int> columns = {});

  /// Coordinates that muscles balance: role driven, balance muscles, in the model's order.
  std::span<const int> balanced() const { return balanced_; }
  std::span<const int> columns() const { return columns_; }
  const MuscleSettings& settings() const { return settings_; }
  /// Wrapping surfaces that are passed by unless a snapshot is given: "muscle 'recfem_r': KnExt_at_fem_r".
  std::vector<std::string> wraps_ignored() const;

  /// Places and moves the bodies. @throws std::invalid_argument as Kinematics::set.
  void set_motion(const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& qd,
                  const Eigen::Ref<const Eigen::VectorXd>& qdd);
  /// Moves the columns' coordinates only; the rest of the motion stays. Paths that they do not move are not computed again
  /// until the next set_motion or hold_paths. @param values (columns). @throws likewise.
  void move_columns(const Eigen::Ref<const Eigen::VectorXd>& values);
  /// τ of the motion under external loads.
  void compute_dynamics(std::span<const model::ExternalLoad> loads);
  /// ∂τ/∂q_c, for differentiate_residual. @pre compute_dynamics was called with this configuration.
  void differentiate_dynamics();
  /// Holds the paths that have snapshots to those of one of their time frames; nullptr: all are computed.
  /// @pre they outlive their use. @throws std::invalid_argument for a point on a body that the path's description has not.
  void hold_paths(const model::PathSnapshots* snapshots, std::size_t row);
  /// Lengths, velocities, moment arms and strengths of the muscles; with derivatives, the paths' Hessians.
  void compute_muscles(bool derivatives = false);
  /// Tensions of the ligaments, and their and the springs' generalised forces; with derivatives, their stiffness.
  void compute_ligaments(bool derivatives = false);
  /// Shares what is left on the balanced coordinates over the muscles.
  /// @returns the recruitment's result, valid until the next call; its status says whether there is one. Its forces are
  /// the active parts.
  /// @throws std::logic_error where no coordinate is balanced by muscles or the model has none.
  const recruitment::Recruitment& recruit();
  /// The same with generalised forces that something else gives. @param others Q_c (n_coordinates) [Nm, N].
  const recruitment::Recruitment& recruit(const Eigen::Ref<const Eigen::VectorXd>& others);
  /// How recruitment is to take what α gives into account: C (balanced, columns); none: zeros, as at the beginning.
  /// @pre of that shape and finite.
  void set_coupling(const Eigen::Ref<const Eigen::MatrixXd>& coupling) { coupling_ = coupling; }
  const Eigen::MatrixXd& used_coupling() const { return coupling_; }
  /// C at this configuration. @param held of the last differentiate_held.
  /// @returns false, and C as it was, where K_αα is singular.
  bool coupling(const Eigen::Ref<const Eigen::MatrixXd>& held, Eigen::Ref<Eigen::MatrixXd> C) const;
  /// Whether there is anything to recruit.
  bool recruits() const { return solver_.has_value(); }
  /// Instead of recruit: muscles carry their passive tension alone.
  void leave_passive(const Eigen::Ref<const Eigen::VectorXd>& others);
  /// ∂residual/∂q_c of what was last recruited (n_coordinates, columns), overwritten.
  /// @param others the columns' ∂Q_c, likewise. @pre dynamics, muscles and ligaments with derivatives and recruit were
  /// called with this configuration. It may be called again after another recruit.
  void differentiate_residual(const Eigen::Ref<const Eigen::MatrixXd>& others, Eigen::Ref<Eigen::MatrixXd> derivative);
  /// The same at held f: what differentiate_residual begins with. @pre likewise.
  void differentiate_held(const Eigen::Ref<const Eigen::MatrixXd>& others, Eigen::Ref<Eigen::MatrixXd> derivative);
  /// ∂f/∂q_c of the active forces (muscles, columns) of the last differentiate_residual [N/rad, N/m].
  const Eigen::MatrixXd& force_derivative() const { return force_rates_; }
  /// What came of it, in words. @pre recruit was called.
  std::string recruitment_message() const { return solver_->message(); }

  const model::Kinematics& kinematics() const { return kinematics_; }
  /// τ (n_coordinates).
  const Eigen::VectorXd& generalised_forces() const { return dynamics_.generalised_forces(); }
  /// Generalised forces of ligaments alone, and of coordinate springs (n_coordinates).
  const Eigen::VectorXd& ligament_forces() const { return ligament_tau_; }
  const Eigen::VectorXd& spring_forces() const { return spring_tau_; }
  const std::vector<MuscleNow>& muscles() const { return muscles_; }
  /// R = −∂L/∂q, n_coordinates × muscles [m, -].
  const Eigen::MatrixXd& moment_arms() const { return moment_arms_; }
  /// Names of the ligaments, and their lengths, velocities, strains and tensions.
  const model::Strands& strands() const { return strands_; }
  const model::StrandWorkspace& strand_loads() const { return strand_loads_; }
  /// Tension of every muscle, active and passive [N].
  const Eigen::VectorXd& muscle_forces() const { return forces_; }
  /// τ − Q_p − Q_c − R f (n_coordinates), reserves not counted as forces.
  const Eigen::VectorXd& residual() const { return residual_; }

 private:
  void balance(const Eigen::Ref<const Eigen::VectorXd>& others);
  void finish();
  void add_tension_derivative(std::size_t muscle, double tension, Eigen::Ref<Eigen::MatrixXd> derivative) const;
  void differentiate_passive();
  void differentiate_recruitment();

  const model::Model* model_;
  MuscleSettings settings_;
  std::vector<int> columns_;
  std::vector<int> balanced_;
  model::Kinematics kinematics_;
  model::InverseDynamics dynamics_;
  model::PathWorkspace path_workspace_;
  std::vector<model::Path> paths_;
  model::Strands strands_;
  model::StrandWorkspace strand_loads_;
  std::optional<recruitment::RecruitmentSolver> solver_;
  std::vector<const model::PathSnapshot*> held_;

  std::vector<MuscleNow> muscles_;
  std::vector<Eigen::VectorXd> gradients_;
  std::vector<char> moves_;  // of each path: whether a column moves it
  bool all_paths_ = true;
  // Recruitment begins from its last result where that is of this motion: what a time frame gives
  // does not depend on the ones before.
  bool warm_ = false;
  bool passive_differentiated_ = false;  // whether passive_rates_ has the muscles' part yet
  Eigen::MatrixXd moment_arms_;
  Eigen::VectorXd ligament_tau_, spring_tau_, passive_, forces_, residual_;
  Eigen::VectorXd q_, qd_, qdd_, active_, no_others_;
  recruitment::RowMatrix arms_;
  Eigen::VectorXd loads_, strengths_, minima_;
  Eigen::MatrixXd coupling_;  // C (balanced, columns)
  struct Place {
    int balanced = -1, column = -1;
  };
  std::vector<Place> places_;  // of each coordinate among these
  // of derivatives
  std::vector<Eigen::MatrixXd> hessians_;
  Eigen::MatrixXd dynamics_rates_, passive_rates_, other_rates_, force_rates_;  // ∂τ, ∂Q_p, ∂Q_c, ∂f by columns
  Eigen::MatrixXd arm_change_;  // of one muscle (balanced, columns)
  recruitment::RowMatrix load_rates_, arm_rates_, strength_rates_, active_rates_, reserve_rates_;
};

}  // namespace condyle::fdk
