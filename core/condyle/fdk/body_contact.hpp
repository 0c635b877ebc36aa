// SPDX-License-Identifier: Apache-2.0
// A contact model between two bodies of a musculoskeletal model: where its frames are, and what its
// loads do to the coordinates.
//
//   X_TF = X_GT⁻¹ X_GF,   X_GF = X_GB·X_BF (moving body),  X_GT = X_GB·X_BT (fixed body)
//   Q_k = Σ_a ± ∂m_a/∂q_k (S_a·W)     + over the axes to F alone, − over those to T alone,
//
// W the model's wrench on F, at Fo, as a screw at ground's origin (common to both bodies: equal and
// opposite). Axes on the way to both bodies move them together and get nothing.
//
//   ∂W/∂q_c = V_T,c ×* W + X*·(∂wrench/∂pose · ∂pose/∂q_c, at an Fo that moves in T)
//   ∂pose/∂q_c = G(pose)⁻¹ (V_F,c − V_T,c at Fo, in T),    V_b,c = Σ_a ∂m_a/∂q_c S_a
//   ∂Q_k/∂q_c = Q_k(∂W/∂q_c) + geometric: axes that turn axes, and curved functions
//
// all analytic. G is singular where |θy| = π/2 (pose.hpp): place the frames so that this is far.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "condyle/contact/contact_model.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/model.hpp"
#include "condyle/model/screw.hpp"

namespace condyle::fdk {

/// What touches what. The contact model is not owned and must outlive its use.
struct BodyContactDescription {
  std::string name;  ///< in results and messages: "tibiofemoral"
  const contact::ContactModel* model = nullptr;
  std::string moving_body, fixed_body;           ///< that carry F and T: femur_r and tibia_r
  RigidTransform X_BF, X_BT;                     ///< F in the moving body, T in the fixed body
  SideOfBody side_of_body = SideOfBody::kRight;  ///< of the joint in the body model
};

/// The workspace of one thread: it allocates when it is made and never again.
class BodyContact {
 public:
  /// @param columns coordinates that stiffness is asked for.
  /// @pre the model and the contact model outlive it.
  /// @throws std::invalid_argument naming the contact and what is wrong: no contact model, a body
  /// that the model has not, both bodies the same, a contact model of the other side of the body, a
  /// placement that is not a rotation or not finite.
  BodyContact(const model::Model& model, const BodyContactDescription& description,
              std::span<const int> columns = {});

  const std::string& name() const { return name_; }
  const contact::ContactModel& model() const { return *contact_; }

  /// Pose of F in T.
  Pose pose(const model::Kinematics& kinematics) const;
  /// ∂pose/∂q_c (6, columns). @param derivative overwritten.
  void pose_derivative(const model::Kinematics& kinematics,
                       Eigen::Ref<Eigen::MatrixXd> derivative) const;

  /// Evaluates the contact model where the bodies are; loads are multiplied by `share`, for a start
  /// on a softer contact.
  /// @throws std::invalid_argument for a pose that is not finite.
  void evaluate(const model::Kinematics& kinematics, contact::Derivatives derivatives,
                double share = 1.0);
  /// As last evaluated.
  const Pose& pose() const { return pose_; }
  const contact::ContactLoads& loads() const { return loads_; }

  /// Adds the generalised force of the loads last evaluated. @param tau (n_coordinates) [Nm, N].
  /// @pre evaluate was called with these kinematics.
  void add_force(const model::Kinematics& kinematics, Eigen::Ref<Eigen::VectorXd> tau) const;
  /// Adds ∂Q/∂q_c over the columns (n_coordinates, columns). @pre … with derivatives.
  void add_stiffness(const model::Kinematics& kinematics,
                     Eigen::Ref<Eigen::MatrixXd> stiffness) const;

 private:
  // The axes to one of the bodies and not to the other.
  struct Branch {
    double sign = 1.0;
    std::vector<int> axes;
  };
  struct Placed {
    RigidTransform X_GT, X_GF;
  };
  Placed place(const model::Kinematics& kinematics) const;
  model::ForceScrew wrench_in_ground() const;
  model::Screw motion(const model::Kinematics& kinematics, const Branch& branch, int c) const;
  void add_geometric(const model::Kinematics& kinematics, const model::ForceScrew& W, int c,
                     Eigen::Ref<Eigen::VectorXd> column) const;

  std::string name_;
  const contact::ContactModel* contact_;
  int body_F_ = -1, body_T_ = -1;
  RigidTransform X_BF_, X_BT_;
  Branch to_F_, to_T_;
  std::vector<int> columns_;
  Placed placed_;
  Pose pose_ = Pose::Zero();
  contact::ContactLoads loads_;
};

}  // namespace condyle::fdk
