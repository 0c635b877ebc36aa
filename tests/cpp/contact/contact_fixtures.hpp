// SPDX-License-Identifier: Apache-2.0
// Small implants for contact tests, right knees unless said: medial is z < 0.
#pragma once

#include <algorithm>
#include <cmath>

#include "condyle/contact/mesh_contact.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

using contact::InsertMeshes;

/// Height of the plane inserts' surfaces [m].
inline constexpr double kPlaneHeight = 0.0073;

/// Two square plane patches at y = kPlaneHeight, about z = ∓0.021, `cells` squares across.
inline InsertMeshes plane_insert(int cells, double half = 0.011) {
  const auto flat = [](double, double) { return kPlaneHeight; };
  return {patch(0.004, -0.021, half, cells, flat), patch(0.004, 0.021, half, cells, flat)};
}

/// Two dished patches, their surfaces nowhere parallel to an axis.
inline InsertMeshes dished_insert(int cells) {
  const auto dish = [](double x, double z) {
    return 0.0073 + 3.0 * x * x + 2.0 * (std::abs(z) - 0.021) * (std::abs(z) - 0.021) + 0.05 * x;
  };
  return {patch(0.004, -0.021, 0.007, cells, dish), patch(0.004, 0.021, 0.007, cells, dish)};
}

/// A femoral surface notched from below: over each compartment a four-sided hollow whose apex and
/// ridges, seen from inside the body, are the closest features. Its distance is C1 inside the body,
/// so that finite differences apply. Open, and wide enough that no point of dished_insert() is
/// closest to its border.
inline TriangleMesh notched_femur() {
  const Vector3 apex[] = {{0.0012, 0.0009, -0.0203}, {-0.0017, -0.0006, 0.0221}};
  TriangleMesh femur;
  for (const Vector3& at : apex) {
    constexpr double kReach[] = {0.0312, 0.0195, 0.0312, 0.0195};
    std::vector<Vector3> v{at};
    const double slopes[] = {0.21, 0.13, 0.17, 0.26};  // along +x, +z, −x, −z
    const Vector3 ways[] = {Vector3::UnitX(), Vector3::UnitZ(), -Vector3::UnitX(),
                            -Vector3::UnitZ()};
    for (int k = 0; k < 4; ++k)
      v.push_back(at + kReach[k] * (ways[k] - slopes[k] * Vector3::UnitY()));
    const auto part = mesh_of(v, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}});
    femur = femur.face_count() == 0 ? part : joined(femur, part);
  }
  return femur;
}

/// A pose that presses the notched femur a millimetre or two into the dished insert, all
/// coordinates in general position.
inline Pose pressed_pose(Draw& draw) {
  Pose pose;
  pose << draw(0.003, 0.005), draw(0.0054, 0.0058), draw(-0.001, 0.001), draw(-0.02, 0.02),
      draw(-0.15, 0.15), draw(-0.05, 0.05);
  return pose;
}

/// The pose of the mirror image: z, θx and θy change sign.
inline Pose mirrored(Pose pose) {
  for (const int i : {2, 3, 4}) pose[i] = -pose[i];
  return pose;
}

}  // namespace condyle::test
