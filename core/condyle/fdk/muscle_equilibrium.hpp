// SPDX-License-Identifier: Apache-2.0
// The quasi-static equilibrium of a musculoskeletal model in one time frame, as a problem for the
// Newton solver: force-dependent kinematics.
//
//   unknowns   α: the model's force-dependent coordinates
//   r(α) = −(τ − Q_ligaments − Q_springs − Q_contact − R (f + P))_α        net generalised force on
//   α f(α)       recruitment of the coordinates that muscles balance, with everything else taken
//   off:
//              contact and ligaments load these, too
//
// Driven coordinates, their rates and the external loads are held; α's own rates are as given. The
// Jacobian ∂r/∂α is analytic: inverse dynamics, ligaments, springs, contact, the muscles' Hessians
// and recruitment's answer to all of them.
//
// Where recruitment finds no forces that carry the loads, f are those that miss them least, and
// count as held in the Jacobian: the iteration can pass through, and whoever ends there is told
// (`recruited()`, `recruitment_message()`).
//
// Sources: Andersen, de Zee, Damsgaard, Nolte & Rasmussen 2017, J Biomech Eng 139(9):091001,
// doi:10.1115/1.4037100 (force-dependent kinematics); Marra et al. 2015, J Biomech Eng
// 137(2):020904.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/fdk/body_contact.hpp"
#include "condyle/fdk/musculoskeletal_frame.hpp"
#include "condyle/numerics/newton_solver.hpp"

namespace condyle::fdk {

/// What is known of a time frame. Views: they must outlive their use.
struct FrameMotion {
  Eigen::Ref<const Eigen::VectorXd> q, qd,
      qdd;                                     ///< (n_coordinates); α's entries of q do not matter
  std::span<const model::ExternalLoad> loads;  ///< in ground
  const model::PathSnapshots* snapshots = nullptr;  ///< paths that are not computed
  std::size_t snapshot_row = 0;
};

/// Where the time of a time frame goes.
enum class Phase {
  kKinematics,
  kDynamics,
  kPaths,
  kLigaments,
  kRecruitment,
  kContact,
  kLinearAlgebra,  ///< what is left: assembly of the Jacobian, Newton's steps
};
inline constexpr int kPhases = 7;
std::string_view name(Phase phase);
using PhaseSeconds = std::array<double, kPhases>;

/// The workspace of one thread.
class MuscleEquilibrium : public numerics::EquilibriumProblem {
 public:
  /// @pre the model and the contact models outlive it.
  /// @throws std::invalid_argument where the model has no force-dependent coordinate, or more than
  /// numerics::kMaxUnknowns, or one that follows another or that muscles balance, by name; where
  /// two contacts have one name; as BodyContact and MusculoskeletalFrame.
  MuscleEquilibrium(const model::Model& model, const MuscleSettings& settings,
                    std::span<const BodyContactDescription> contacts);

  /// Which coordinates α are, in the model's order.
  std::span<const int> force_dependent() const { return columns_; }
  /// α's entries of a configuration.
  numerics::Unknowns unknowns(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// The time frame to be solved. @throws std::invalid_argument as Kinematics::set and
  /// MusculoskeletalFrame::hold_paths.
  void set_frame(const FrameMotion& motion);
  /// Moves the bodies alone: no loads. @pre set_frame.
  void place(const numerics::Unknowns& alpha);
  /// Multiplies contact loads by `share`, 0 < share ≤ 1, until the next call.
  void soften_contact(double share) {
    contact_share_ = share;
    alpha_.resize(0);
  }

  /// How recruitment follows what α gives (MusculoskeletalFrame::set_coupling), from the next Newton
  /// iteration on: C is taken anew at every iterate (in part where it swings), until that changes r by
  /// no more than the tolerances where r is within them (near the end twice them after five more times, and so on),
  /// or `most` times; then it is held. 0: as it is.
  void follow_sharing(int most, double force_tolerance, double moment_tolerance);
  int sharing_updates() const { return sharing_.updates; }
  /// What the last new C would have changed of r, in the tolerances; 0 before the first.
  double sharing_change() const { return sharing_.updates > 0 ? sharing_.change : 0.0; }
  /// C as given. @param C as MusculoskeletalFrame::set_coupling.
  void use_coupling(const Eigen::MatrixXd& C) {
    if (C == frame_.used_coupling()) return;
    frame_.set_coupling(C);
    shared_ = false;
  }
  /// C = 0, as at the beginning: α counts as driven.
  void uncouple_recruitment();

  int size() const override { return static_cast<int>(columns_.size()); }
  numerics::LoadKind load_kind(int i) const override;
  std::string_view coordinate_name(int i) const override;
  void residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) override;
  void residual_and_jacobian(const numerics::Unknowns& alpha, numerics::Unknowns& r,
                             numerics::Jacobian& J) override;
  bool renew(const numerics::Unknowns& alpha, numerics::Unknowns& r,
             numerics::Jacobian& J) override;

  // As last evaluated:
  /// The configuration's α; of size 0 before the first evaluation of a time frame.
  const numerics::Unknowns& alpha() const { return alpha_; }
  const MusculoskeletalFrame& frame() const { return frame_; }
  const std::vector<BodyContact>& contacts() const { return contacts_; }
  /// Generalised forces of all contacts (n_coordinates) [Nm, N].
  const Eigen::VectorXd& contact_forces() const { return contact_tau_; }
  /// Recruitment's result; nullptr where the model has nothing to recruit.
  const recruitment::Recruitment* recruited() const { return recruited_; }
  std::string recruitment_message() const;
  /// ∂(τ − Q − R f)/∂α of all coordinates (n_coordinates, size()), of the last Jacobian; at held f
  /// where C is about to be taken anew (renew).
  const Eigen::MatrixXd& residual_derivative() const { return derivative_; }

  /// Summed since reset_seconds; linear algebra: assembly here alone.
  const PhaseSeconds& seconds() const { return seconds_; }
  void reset_seconds() { seconds_.fill(0.0); }

 private:
  struct Sharing {
    int most = 0, updates = 0, near = 0;
    double force_tolerance = 1.0, moment_tolerance = 1.0;
    double weight = 1.0;  // part of a new C that is taken
    double change = std::numeric_limits<double>::infinity();  // of r by the last one, in full
    bool held = false;
  };

  enum class Derivatives { kNone, kHeld, kWhole };
  void evaluate(const numerics::Unknowns& alpha, Derivatives derivatives);
  void share();
  void differentiate(Derivatives derivatives);
  bool renews() const { return !sharing_.held && sharing_.updates < sharing_.most; }
  bool take_coupling();
  void net_force(numerics::Unknowns& r) const;
  void net_stiffness(numerics::Jacobian& J) const;
  double in_tolerances(const numerics::Unknowns& r) const;

  const model::Model* model_;
  std::vector<int> columns_;
  MusculoskeletalFrame frame_;
  std::vector<BodyContact> contacts_;
  std::span<const model::ExternalLoad> loads_;
  double contact_share_ = 1.0;
  Sharing sharing_;
  // What holds of alpha_: evaluated with derivatives; forces shared with the C of now; and what
  // the derivative is then.
  bool differentiated_ = false, shared_ = false;
  Derivatives derivative_is_ = Derivatives::kNone;
  numerics::Unknowns alpha_;
  Eigen::VectorXd contact_tau_;
  Eigen::MatrixXd contact_stiffness_, derivative_;
  const recruitment::Recruitment* recruited_ = nullptr;
  PhaseSeconds seconds_{};
};

}  // namespace condyle::fdk
