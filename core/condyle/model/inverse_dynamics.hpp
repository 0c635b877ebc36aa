// SPDX-License-Identifier: Apache-2.0
// Inverse dynamics: the generalised forces that a motion needs, and their derivative by
// coordinates.
//
//   τ(q, q̇, q̈) = M(q) q̈ + C(q, q̇) − gravity − Σ Jᵀ F_ext        [Nm, N]
//
// what must act on the coordinates: OpenSim's sign.
//
// Recursive Newton–Euler over the bodies, with all twists and wrenches at ground's origin, gives
// the load S_a·F_a of each elementary axis (F_a: what moves everything on it); the chain rule
// through the axes' functions gives τ. A dependent coordinate's load goes to the coordinate it
// follows; its own entry is 0.
//
// Springs, muscles, ligaments and contact are not in it: their generalised forces are subtracted by
// whoever asks.
//
// The derivative moves everything on an axis as one rigid body:
//
//   u = V_j × S_j,   α = −S_j × (A_j − g) − u × V_j
//   ∂F_b/∂m_j = S_j ×* F_b + I_b α + B_b u,   ∂F_b/∂ṁ_j = B_b S_j + 2 I_b u,   ∂F_b/∂m̈_j = I_b S_j
//   B_b β = I_b (β × V_b) + β ×* (I_b V_b) + V_b ×* (I_b β)
//
// and B is linear, acts on β's rotation alone, and adds up over bodies as inertia does. q̇ and q̈
// are held; that they change ṁ and m̈ where functions are curved is included.
//
// Where OpenSim differs: its CustomJoint (Simbody's function-based mobiliser, seen in OpenSim 4.6)
// adds θ̇₂θ̇₃ (e₃ × e₂) to the child's angular acceleration where one coordinate drives both the
// second and the third rotation, as in many splined knees. Its power is then not the rate of its
// own energy (0.3 % in a gait's left knee); here it is.
//
// Sources: Luh, Walker & Paul 1980, J Dyn Syst Meas Control 102(2):69–76, doi:10.1115/1.3149599;
// Featherstone 2008, Rigid Body Dynamics Algorithms, ch. 5; Carpentier & Mansard 2018, Robotics:
// Science and Systems XIV, doi:10.15607/RSS.2018.XIV.038 (here in ground's frame and in elementary
// axes).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "condyle/common/types.hpp"
#include "condyle/model/external_load.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/screw.hpp"

namespace condyle::model {

/// The workspace of one thread: it allocates when it is made and never again.
class InverseDynamics {
 public:
  /// @pre the model outlives it.
  explicit InverseDynamics(const Model& model);

  /// τ at the kinematics' q, q̇, q̈. @returns (n_coordinates), valid until the next call.
  /// @throws std::invalid_argument for a load on a body that the model has not, or that is not
  /// finite.
  const Eigen::VectorXd& compute(const Kinematics& kinematics,
                                 std::span<const ExternalLoad> loads = {});
  /// As last computed.
  const Eigen::VectorXd& generalised_forces() const { return tau_; }

  /// ∂τ/∂q_c at constant q̇, q̈ and loads (force, point and moment in ground).
  /// @pre compute was called with this configuration of these kinematics.
  /// @param coordinates the c of the columns; a dependent coordinate's column is 0.
  /// @param derivative (n_coordinates, coordinates.size()), overwritten.
  /// @throws std::invalid_argument for a coordinate that the model has not, or another shape.
  void derivative(const Kinematics& kinematics, std::span<const int> coordinates,
                  Eigen::Ref<Eigen::MatrixXd> derivative);

 private:
  // A body where it is: mass, inertia about its centre, centre, in ground.
  struct BodyNow {
    Vector3 centre = Vector3::Zero();
    Matrix3 inertia = Matrix3::Zero();
  };
  // Inertia and B of everything on an axis, at ground's origin.
  struct Composite {
    double mass = 0.0;
    Vector3 h = Vector3::Zero();  // Σ mass·centre
    Matrix3 J = Matrix3::Zero();  // about the origin
    Matrix3 M = Matrix3::Zero();  // B β = (M β_w, 2 β_w × P)
    Vector3 P = Vector3::Zero();  // linear momentum
    Composite& operator+=(const Composite& other);
    ForceScrew times(const Screw& alpha, const Screw& beta) const;
  };

  void require(std::span<const ExternalLoad> loads) const;
  void compose(const Kinematics& kinematics);
  void add_axis_derivative(const Kinematics& kinematics, const TermNow& by);

  const Model* model_;
  std::vector<double> mass_;          // of bodies
  std::vector<Vector3> mass_centre_;  // in the body
  std::vector<Matrix3> inertia_;      // about the centre, in the body
  std::vector<BodyNow> bodies_;
  std::vector<Screw> S_;                         // of axes
  std::vector<ForceScrew> inertial_, external_;  // Σ over everything on an axis
  std::vector<double> load_;                     // of axes: S·(inertial − external)
  Eigen::VectorXd tau_;
  // of derivatives
  std::vector<Composite> composite_;
  std::vector<ForceScrew> IS_;  // composite inertia times S
  std::vector<Vector3> BS_;     // Bᵀ S, its rotation's part
  std::vector<double> change_;  // of axis loads
};

}  // namespace condyle::model
