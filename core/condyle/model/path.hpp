// SPDX-License-Identifier: Apache-2.0
// A path over bodies, compiled: the line of a muscle or a ligament, its length and derivatives.
//
//   L(q),   g = ∂L/∂q (moment arm r = −g),   L̇ = g·q̇,   H = ∂²L/∂q²       all analytic
//
// The path runs straight between the points present, and around the cylinders that it touches
// (cylinder_wrap.hpp). Along the axes between two bodies a body-fixed point p moves with
// s_a(p) = ω_a × (p − c_a), or the direction of a slide, and
//   ∂²p/∂m_a∂m_b = ω_a × s_b(p),  axis a before b as seen from the body the span is measured from
// (axes on that body's own branch count backwards, with a minus sign); the chain rule through the
// axes' functions does the rest. Axes that the ends of a span share are not looked at.
//
// Points: fixed; moving in their body with coordinates, location + Σ function(q); or present only
// while a coordinate is in its range (widened by 1e-5, as OpenSim has it). A conditional point that
// comes or goes makes L jump unless it lies on the line; nothing here smooths that.
// Which segment a cylinder takes among several, and several cylinders on one path, follow OpenSim's
// GeometryPath: in the order listed, each in its range of points; a segment that it pierces before
// one that it only forces aside, else the one lengthened least. Several are repeated until the
// points of contact stand still (1e-12 m; OpenSim stops at 0.5 mm of length).
// A coordinate that a coupling sets counts as a function of the free one that it follows, as in the
// kinematics.
//
// Ellipsoids, spheres and tori are not computed: `wraps_ignored()` names them. Give a snapshot
// (path_snapshot.hpp) instead; without one the path runs past them through its points.
//
// Source of the semantics: OpenSim 4.6. Moment arm: An, Takahashi, Harrigan & Chao 1984, J Biomech
// Eng 106:280–282.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "condyle/common/types.hpp"
#include "condyle/model/cylinder_wrap.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/model.hpp"
#include "condyle/model/path_snapshot.hpp"

namespace condyle::model {

class PathWorkspace;

/// A path point with names resolved.
struct PathPoint {
  int slot = 0;  ///< of its body among Path::bodies()
  Vector3 location = Vector3::Zero();
  std::array<std::vector<ModelAxis::Term>, 3> moving;
  int motion = -1;  ///< first of its three motions; −1: does not move in its body
  int condition_coordinate = -1;
  double condition_min = 0.0, condition_max = 0.0;
};

/// A cylinder that a path may touch.
struct PathCylinder {
  Cylinder surface;
  int slot = 0;
  RigidTransform X_BC;
  int first_point = 0, last_point = 0;
};

class Path {
 public:
  /// @param owner for messages: "muscle 'vasmed_r'".
  /// @throws std::invalid_argument naming the owner, the field, its value and the limit.
  Path(const Model& model, const PathDescription& description, std::string owner);

  const std::string& owner() const { return owner_; }
  /// The free coordinates that the length may depend on, ascending: the entries of gradients and
  /// the rows of Hessians.
  std::span<const int> coordinates() const { return coordinates_; }
  int n_coordinates() const { return static_cast<int>(coordinates_.size()); }
  /// Active wrapping surfaces that are not computed, by name.
  const std::vector<std::string>& wraps_ignored() const { return wraps_ignored_; }

  /// Length [m]. @param held the path at this time frame from outside, instead of computing it.
  /// @throws std::invalid_argument for a held point on a body that the path's description has not.
  double length(const Kinematics& kinematics, PathWorkspace& workspace,
                const PathSnapshot* held = nullptr) const;

  /// Length, and ∂L/∂q over coordinates() into `gradient` [m/rad, m/m].
  /// @throws std::invalid_argument likewise, or for a gradient of another size than
  /// n_coordinates().
  double gradient(const Kinematics& kinematics, PathWorkspace& workspace,
                  Eigen::Ref<Eigen::VectorXd> gradient, const PathSnapshot* held = nullptr) const;

  /// Length, gradient, and ∂²L/∂q_i∂q_c into `hessian` (n_coordinates × columns).
  /// @param columns coordinates c of the model, each once; those the path does not depend on give
  /// zeros.
  double hessian(const Kinematics& kinematics, PathWorkspace& workspace,
                 std::span<const int> columns, Eigen::Ref<Eigen::VectorXd> gradient,
                 Eigen::Ref<Eigen::MatrixXd> hessian, const PathSnapshot* held = nullptr) const;

  /// L̇ = g·q̇ [m/s]; moving points count, as they are in g. @param gradient as `gradient` gave it.
  double velocity(const Kinematics& kinematics,
                  const Eigen::Ref<const Eigen::VectorXd>& gradient) const;

  /// The path as it now lies, held to its bodies: to draw, or to check snapshots against.
  PathSnapshot snapshot(const Kinematics& kinematics, PathWorkspace& workspace) const;

  // What it was compiled to (path_route.hpp works on it).
  struct ChainStep {
    int axis = 0;       ///< of the model
    int motion = 0;     ///< index among the path's motions
    double sign = 1.0;  ///< −1 on the branch of the body that is measured from
  };
  const std::vector<PathPoint>& points() const { return points_; }
  const std::vector<PathCylinder>& cylinders() const { return cylinders_; }
  const std::vector<int>& bodies() const { return bodies_; }
  const std::vector<ChainStep>& chain(int from_slot, int to_slot) const {
    return chains_[static_cast<std::size_t>(from_slot) * bodies_.size() +
                   static_cast<std::size_t>(to_slot)];
  }
  /// Motions: the axes of the model that matter, then three slides of every moving point, then two
  /// of every free point between cylinders.
  int n_motions() const { return free_motion_ + 2 * n_free_; }
  /// Terms of all motions, at most.
  int n_terms() const { return n_terms_; }
  int first_free_motion() const { return free_motion_; }
  const std::vector<int>& axes() const { return axes_; }
  /// Index among coordinates(); −1: does not matter.
  int coordinate_index(int coordinate) const {
    return coordinate_index_[static_cast<std::size_t>(coordinate)];
  }

 private:
  int slot(int body);
  void refuse(const std::string& what) const;
  void compile_points(const Model& model, const PathDescription& description);
  void compile_wraps(const Model& model, const PathDescription& description);
  void compile_chains(const Model& model);

  std::string owner_;
  std::vector<PathPoint> points_;
  std::vector<PathCylinder> cylinders_;
  std::vector<std::string> wraps_ignored_;
  std::vector<int> bodies_, axes_, coordinates_, coordinate_index_;
  std::vector<std::vector<ChainStep>> chains_;
  int free_motion_ = 0, n_free_ = 0, n_terms_ = 0;
};

}  // namespace condyle::model
