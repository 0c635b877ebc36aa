// SPDX-License-Identifier: Apache-2.0
// Where a path lies now: its points present, the cylinders that it touches, and the spans between
// them.
//
// A span joins two nodes, straight or around one cylinder. Between two cylinders on one segment a
// free node stands midway on the straight part: the length is stationary in it, which is what makes
// the spans' derivatives those of the whole (the Hessian with the free node's two sideways motions
// eliminated).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "condyle/model/path.hpp"

namespace condyle::model {

struct PathNode {
  Vector3 p_G = Vector3::Zero();  ///< [m]
  int slot = 0;                   ///< of its body
  int point = -1;                 ///< of the description; −1: a held, tangent or free one
  int cylinder = -1;              ///< a tangent point on this cylinder of the path
  int turn = 0;                   ///< of the line there: +1 counter-clockwise, −1 clockwise
  int free = -1;                  ///< number of a free node
  Vector3 sideways[2] = {Vector3::Zero(), Vector3::Zero()};  ///< its motions, unit, in ground
};

struct PathSpan {
  int a = 0, b = 0;   ///< nodes, in `PathWorkspace::nodes`
  int cylinder = -1;  ///< −1: straight
  int turn = 0;
  double length = 0.0;                                   ///< [m]
  CylinderLine line;                                     ///< around the cylinder, in its frame
  Vector3 a_C = Vector3::Zero(), b_C = Vector3::Zero();  ///< the ends in the cylinder's frame
};

/// How the end of a span moves with one of the path's motions, as seen from the span's body of
/// reference.
struct MotionStep {
  int motion = 0;
  Vector3 velocity = Vector3::Zero();  ///< per unit rate
  Vector3 turn = Vector3::Zero();      ///< angular velocity per unit rate; 0 for a slide
};

/// ∂motion/∂coordinate.
struct MotionTerm {
  int motion = 0, coordinate = 0;  ///< coordinate: index among the path's
  double slope = 0.0, curvature = 0.0;
};

/// The scratch of one thread. Grows to the largest path that has used it, then allocates no more.
class PathWorkspace {
 public:
  void reserve(const Path& path, std::size_t n_held);

  std::vector<PathNode> nodes;
  std::vector<PathSpan> spans;
  std::vector<RigidTransform> X_GC, X_CG;  ///< of the path's cylinders
  std::vector<int> order, last_contact;
  std::vector<Vector3> previous;  ///< tangent points, to see them stand still
  std::vector<MotionStep> steps_a, steps_b;
  std::vector<MotionTerm> terms;
  std::vector<char> wanted;  ///< motions that a column of the Hessian depends on
  std::vector<int> column;   ///< of the path's coordinates; −1: none
  Eigen::VectorXd motion_gradient;
  Eigen::MatrixXd motion_hessian;
  int n_free = 0;
  double length = 0.0;  ///< of the whole path [m]
};

/// The slot of a held point's body in the path. @throws std::invalid_argument naming the path's
/// owner and the body.
int held_slot(const Path& path, const HeldPoint& point);

/// Lays the path: fills nodes, spans and length.
void lay_path(const Path& path, const Kinematics& kinematics, PathWorkspace& workspace,
              const PathSnapshot* held);

}  // namespace condyle::model
