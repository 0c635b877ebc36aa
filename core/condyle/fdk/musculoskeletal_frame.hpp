// SPDX-License-Identifier: Apache-2.0
// One time frame of a musculoskeletal model, everything but contact: where bodies are, what generalised forces the motion needs,
// what ligaments and springs give of them, what muscles can do, and how recruitment shares the rest over them.
//
//   τ           inverse dynamics: what must act on the coordinates                       [Nm, N]
//   Q_p         passive: ligaments, springs of coordinates, passive tension of muscles   [Nm, N]
//   R f = τ − Q_p      on the coordinates that muscles balance, R = −∂L/∂q, 0 ≤ f ≤ N
//   residual    τ − Q_p − R f on every coordinate: what contact, or whatever drives the coordinate, gives
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
  /// @pre the model outlives it.
  /// @throws std::invalid_argument for impossible muscles, ligaments or settings, by name and value.
  MusculoskeletalFrame(const model::Model& model, const MuscleSettings& settings);

  /// Coordinates that muscles balance: role driven, balance muscles, in the model's order.
  std::span<const int> balanced() const { return balanced_; }
  const MuscleSettings& settings() const { return settings_; }
  /// Wrapping surfaces that are passed by unless a snapshot is given: "muscle 'recfem_r': KnExt_at_fem_r".
  std::vector<std::string> wraps_ignored() const;

  /// Places and moves the bodies. @throws std::invalid_argument as Kinematics::set.
  void set_motion(const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& qd,
                  const Eigen::Ref<const Eigen::VectorXd>& qdd);
  /// τ of the motion under external loads.
  void compute_dynamics(std::span<const model::ExternalLoad> loads);
  /// Holds the paths that have snapshots to those of one of their time frames; nullptr: all are computed.
  /// @pre they outlive their use. @throws std::invalid_argument for a point on a body that the path's description has not.
  void hold_paths(const model::PathSnapshots* snapshots, std::size_t row);
  /// Lengths, velocities, moment arms and strengths of the muscles.
  void compute_muscles();
  /// Tensions of the ligaments, and their and the springs' generalised forces.
  void compute_ligaments();
  /// Shares what is left on the balanced coordinates over the muscles.
  /// @returns the recruitment's result, valid until the next call; its status says whether there is one. Its forces are
  /// the active parts.
  /// @throws std::logic_error where no coordinate is balanced by muscles or the model has none.
  const recruitment::Recruitment& recruit();
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
  /// τ − Q_p − R f (n_coordinates), reserves not counted as forces.
  const Eigen::VectorXd& residual() const { return residual_; }

 private:
  const model::Model* model_;
  MuscleSettings settings_;
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
  Eigen::MatrixXd moment_arms_;
  Eigen::VectorXd ligament_tau_, spring_tau_, passive_, forces_, residual_;
  recruitment::RowMatrix arms_;
  Eigen::VectorXd loads_, strengths_, minima_;
};

}  // namespace condyle::fdk
