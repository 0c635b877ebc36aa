// SPDX-License-Identifier: Apache-2.0
// Pairs of made-up bodies for tests of the contact pair, everything in a general pose: neither
// body's frame, nor their placement, nor any length or angle is a round number.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "condyle/contact/contact_pair.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

using contact::CompartmentLoads;
using contact::ContactPair;
using contact::Derivatives;

/// A pair and a placement that presses it.
struct PairCase {
  TriangleMesh moving;              ///< in F
  std::vector<TriangleMesh> fixed;  ///< in T
  RigidTransform X_TF;

  Pose pose() const { return pose_from_transform(X_TF); }
};

/// Lengths by which moments and angles are made comparable with forces and displacements [m].
inline constexpr double kArm = 0.02;

inline RigidTransform general_placement(std::uint64_t seed) {
  Draw draw(seed);
  return transform_TF(general_pose(draw, 0.5));
}

/// Two bodies given in frames of their own, `moving` placed at X in the fixed one's, as seen from
/// frames F and T that lie in a general pose to those.
inline PairCase in_general_frames(const TriangleMesh& moving,
                                  const std::vector<TriangleMesh>& fixed, const RigidTransform& X,
                                  const RigidTransform& to_F, const RigidTransform& to_T) {
  PairCase out{moved(moving, to_F), {}, to_T * X * to_F.inverse()};
  for (const auto& mesh : fixed) out.fixed.push_back(moved(mesh, to_T));
  return out;
}

inline PairCase in_general_frames(const TriangleMesh& moving,
                                  const std::vector<TriangleMesh>& fixed, const RigidTransform& X) {
  return in_general_frames(moving, fixed, X, general_placement(3), general_placement(8));
}

/// A shallow dish, body below; its distance is C1 inside the body (facets meet in hollows), so that
/// finite differences apply to what is integrated against it.
inline TriangleMesh dish(int cells, double half = 0.0085) {
  return patch(0.0011, -0.0007, half, cells,
               [](double x, double z) { return 3.1 * x * x + 2.3 * z * z + 0.05 * x; });
}

/// A closed ellipsoid about the origin, half axes 9, 7 and 11 mm.
inline TriangleMesh ellipsoid(int levels) {
  TriangleMesh mesh = sphere(1.0, levels);
  for (Eigen::Index v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertices.row(v).array() *= Eigen::Array3d(0.0091, 0.0073, 0.0112).transpose();
  }
  return mesh;
}

/// An ellipsoid pressed about 1 mm into a dish: the contact lies inside both surfaces.
inline PairCase ellipsoid_in_dish(int levels, int cells, double sink = 0.9e-3) {
  RigidTransform X;
  X.R = rotation_TF((Pose() << 0, 0, 0, 0.07, 0.31, -0.12).finished());
  X.p = {-0.0013, 0.0074 - sink, 0.0009};
  return in_general_frames(ellipsoid(levels), {dish(cells)}, X);
}

/// The same pair with the roles exchanged.
inline PairCase exchanged(const PairCase& pair) {
  return {pair.fixed.front(), {pair.moving}, pair.X_TF.inverse()};
}

/// Another placement of the pair: the moving body shifted by up to 0.2 mm and turned by up to 0.02
/// rad about its middle.
inline PairCase nearby(const PairCase& pair, Draw& draw) {
  Pose step;
  for (int i = 0; i < 3; ++i) step[i] = draw(-2e-4, 2e-4);
  for (int i = 3; i < 6; ++i) step[i] = draw(-0.02, 0.02);
  const RigidTransform turn = transform_TF(step);
  const Vector3 middle = pair.moving.vertices.colwise().mean();
  PairCase out = pair;
  out.X_TF.R = turn.R * pair.X_TF.R;
  out.X_TF.p = pair.X_TF * middle + turn.p - out.X_TF.R * middle;
  return out;
}

/// All compartments together.
struct Whole {
  Wrench wrench = Wrench::Zero();
  Matrix6 stiffness = Matrix6::Zero();
  double energy = 0.0, volume = 0.0, area = 0.0, border_area = 0.0;
};

inline Whole whole(const ContactPair& pair, const Pose& pose,
                   Derivatives derivatives = Derivatives::kNone) {
  Whole sum;
  for (std::size_t c = 0; c < pair.compartments(); ++c) {
    const CompartmentLoads loads = pair.evaluate(pose, c, derivatives);
    sum.wrench += loads.wrench;
    sum.stiffness += loads.stiffness;
    sum.energy += loads.energy;
    sum.volume += loads.volume;
    sum.area += loads.area;
    sum.border_area += loads.border_area;
  }
  return sum;
}

/// The wrench on the other body, at To, in F: what a pair with exchanged roles must report.
inline Wrench reaction(const RigidTransform& X_TF, const Wrench& wrench) {
  const Vector3 force = wrench.head<3>();
  const Vector3 moment = wrench.tail<3>() + X_TF.p.cross(force);
  Wrench other;
  other << -(X_TF.R.transpose() * force), -(X_TF.R.transpose() * moment);
  return other;
}

/// Moments over the arm: a wrench in newtons.
inline Vector6 scaled(Vector6 wrench) {
  wrench.tail<3>() /= kArm;
  return wrench;
}

/// Rows and columns of rotations over the arm: a stiffness in N/m.
inline Matrix6 scaled(Matrix6 stiffness) {
  stiffness.bottomRows<3>() /= kArm;
  stiffness.rightCols<3>() /= kArm;
  return stiffness;
}

/// A pose moved along one coordinate: by `step` [m], or step over the arm [rad].
inline Pose along(Pose pose, int coordinate, double step) {
  pose[coordinate] += coordinate < 3 ? step : step / kArm;
  return pose;
}

}  // namespace condyle::test
