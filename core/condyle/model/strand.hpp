// SPDX-License-Identifier: Apache-2.0
// The ligament strands of a model: lengths, tensions, and what they do to the coordinates.
//
//   τ = −Σ F ∂L/∂q,    ∂τ/∂q = −Σ (F′ ∂L/∂q ∂L/∂qᵀ + F ∂²L/∂q²),    F′ = dF/dL  (ligament_law.hpp)
//
// Most strands have one straight part between two bodies, and many share the pair. For those,
// force, moment and the 6 × 6 spatial stiffness are summed in a body's frame first and meet the
// joint axes once per pair; the others go through Path::hessian one by one. Strands whose wraps are
// not computed run straight through their points (`wraps_ignored()`) unless a snapshot holds them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "condyle/model/kinematics.hpp"
#include "condyle/model/ligament_law.hpp"
#include "condyle/model/path.hpp"
#include "condyle/model/path_route.hpp"

namespace condyle::model {

class StrandWorkspace;

struct Strand {
  std::string name;
  LigamentForceLaw law;
  Path path;
};

enum class StrandDamping { kNone, kBlankevoort };

class Strands {
 public:
  /// The ligaments of a model. @throws std::invalid_argument naming the ligament, the field, its
  /// value and the limit.
  explicit Strands(const Model& model);

  int size() const { return static_cast<int>(strands_.size()); }
  const Strand& operator[](int i) const { return strands_[static_cast<std::size_t>(i)]; }
  /// "strand: surface" of every wrap that is not computed.
  std::vector<std::string> wraps_ignored() const;

  /// Lengths, velocities, strains and tensions into the workspace; −F ∂L/∂q added to `tau`.
  /// @param tau (n_coordinates of the model) [Nm, N]; entries of dependent coordinates are not
  /// touched.
  void add_forces(const Kinematics& kinematics, StrandWorkspace& workspace,
                  Eigen::Ref<Eigen::VectorXd> tau,
                  StrandDamping damping = StrandDamping::kNone) const;

  /// The same, and ∂τ/∂q_c over the workspace's columns c added to `stiffness` (n_coordinates ×
  /// columns). With damping, at fixed L̇: velocities count as given.
  void add_forces_and_stiffness(const Kinematics& kinematics, StrandWorkspace& workspace,
                                Eigen::Ref<Eigen::VectorXd> tau,
                                Eigen::Ref<Eigen::MatrixXd> stiffness,
                                StrandDamping damping = StrandDamping::kNone) const;

  /// Elastic energy of the lengths in the workspace [J].
  double energy(const StrandWorkspace& workspace) const;

 private:
  friend class StrandWorkspace;
  // The joint axes between two bodies, from the one with the lower index.
  struct Pair {
    int body_a = -1, body_b = -1;
    std::vector<Path::ChainStep> chain;  // motion: not used
  };
  int pair(int body_a, int body_b) const;
  void add(const Kinematics& kinematics, StrandWorkspace& workspace,
           Eigen::Ref<Eigen::VectorXd> tau, Eigen::Ref<Eigen::MatrixXd>* stiffness,
           StrandDamping damping) const;
  double tension_of(std::size_t i, StrandWorkspace& workspace, StrandDamping damping) const;
  void sum_straight(const Kinematics& kinematics, StrandWorkspace& workspace, bool second,
                    StrandDamping damping) const;
  void project_pairs(const Kinematics& kinematics, StrandWorkspace& workspace, bool second) const;
  void add_other(const Kinematics& kinematics, StrandWorkspace& workspace,
                 Eigen::Ref<Eigen::VectorXd> tau, Eigen::Ref<Eigen::MatrixXd>* stiffness,
                 StrandDamping damping) const;

  int n_bodies_ = 0, n_axes_ = 0, n_coordinates_ = 0;
  std::vector<Strand> strands_;
  std::vector<Pair> pairs_;
  std::vector<int> pair_index_;  // (n_bodies + 1)²; −1: none
};

/// The scratch of one thread, the strands' snapshots at the present time frame, and the results per
/// strand.
class StrandWorkspace {
 public:
  /// @param columns coordinates that stiffness is asked for. @pre the strands outlive it.
  /// @throws std::invalid_argument for a coordinate that the model has not.
  explicit StrandWorkspace(const Strands& strands, std::span<const int> columns = {});

  /// Holds the strands that have snapshots to those of a time frame, and computes the others.
  /// Allocates only for snapshots of more points than any before. @pre
  /// `snapshots` outlives its use. @throws std::invalid_argument for a held point on a body that
  /// the strand's description has not.
  void hold(const PathSnapshots& snapshots, std::size_t time_frame);
  /// One strand; nullptr: computed.
  void hold(int strand, const PathSnapshot* snapshot);

  std::span<const int> columns() const { return columns_; }

  Eigen::VectorXd length;    ///< [m]
  Eigen::VectorXd velocity;  ///< L̇ [m/s]
  Eigen::VectorXd strain;    ///< [-]
  Eigen::VectorXd force;     ///< F, with damping where asked for [N]

 private:
  friend class Strands;
  // A strand of one straight part between bodies: |X_AB b − a| + fixed.
  struct Line {
    int pair = -1;  // −1: another kind
    Vector3 a = Vector3::Zero(), b = Vector3::Zero();
    double fixed = 0.0;
  };
  // Sums over the strands of a pair, in frame A about B's origin; r from there to the strand's end
  // on B.
  struct PairSums {
    Vector3 force, moment;  // Σ F u, Σ r × F u
    Matrix3 virial;         // Σ F r uᵀ
    Matrix6 stiffness;      // Σ Jᵀ (F′ u uᵀ + F/L (1 − u uᵀ)) J,  J = (1, −[r])
    Matrix3 R_AB;
    Vector3 p_AB, v, w;  // placement and twist of B in A
    bool used = false;
  };
  bool make_line(const PathSnapshot& points, Line& line) const;

  const Strands* strands_;
  std::vector<int> columns_, column_of_coordinate_;
  std::vector<char> axis_wanted_;
  std::vector<Line> lines_, described_;
  std::vector<const PathSnapshot*> held_;
  std::vector<PairSums> sums_;
  std::vector<Vector3> chain_v_, chain_w_;
  Eigen::VectorXd by_length_, axis_force_, gradient_;
  Eigen::MatrixXd axis_hessian_, hessian_;
  PathWorkspace path_;
};

}  // namespace condyle::model
