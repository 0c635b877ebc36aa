// SPDX-License-Identifier: Apache-2.0
// Contacts whose energy, volume and wrench have a closed form under this law, as meshes of any
// fineness.
//
// In its own frame a scene has the fixed body below y = 0 or about −y and the moving one above it.
// Surfaces are patches of what they stand for, wider than the contact, their vertices on it.
// Patches of the two bodies are turned about the vertical against each other, so that their grids
// never line up.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "contact/pair_fixtures.hpp"

namespace condyle::test {

inline constexpr double kTurn = 0.43;  ///< of the grids about y against each other [rad]

/// What one compartment must report, in the scene's own frame.
struct Oracle {
  double energy = 0.0;               ///< [J]
  double volume = 0.0;               ///< [m³]
  Vector3 force = Vector3::Zero();   ///< on the moving body [N]
  Vector3 moment = Vector3::Zero();  ///< about the scene's origin [Nm]
};

/// Relative errors against an oracle: energy, volume, force, moment (over force and kArm).
struct OracleErrors {
  double energy, volume, force, moment, border_area;

  double worst() const { return std::max({energy, volume, force, moment}); }
};

/// Evaluates a scene seen from general frames of either body.
inline OracleErrors errors(const TriangleMesh& moving, const TriangleMesh& fixed,
                           const RigidTransform& X, const contact::ContactLaw& law,
                           const contact::PairSettings& settings, const Oracle& oracle) {
  const RigidTransform to_T = general_placement(8);
  const PairCase bodies = in_general_frames(moving, {fixed}, X);
  const ContactPair pair = contact::make_contact_pair(bodies.moving, bodies.fixed, law, settings);
  const CompartmentLoads loads = pair.evaluate(bodies.pose(), 0, Derivatives::kNone);
  const Vector3 f = loads.wrench.head<3>();
  const Vector3 force = to_T.R.transpose() * f;
  const Vector3 moment =
      to_T.R.transpose() * (loads.wrench.tail<3>() + (bodies.X_TF.p - to_T.p).cross(f));
  return {std::abs(loads.energy / oracle.energy - 1.0),
          std::abs(loads.volume / oracle.volume - 1.0),
          (force - oracle.force).norm() / oracle.force.norm(),
          (moment - oracle.moment).norm() / (oracle.force.norm() * kArm), loads.border_area};
}

inline RigidTransform turned(const Vector3& p = Vector3::Zero(), double tilt = 0.0) {
  return {(Eigen::AngleAxisd(tilt, Vector3::UnitZ()) * Eigen::AngleAxisd(kTurn, Vector3::UnitY()))
              .toRotationMatrix(),
          p};
}

/// The plane y = 0 seen from above: a square of half width `half`, body below.
inline TriangleMesh plane(int cells, double half) {
  return patch(0.0, 0.0, half, cells, [](double, double) { return 0.0; });
}

/// The upper cap of a sphere about the origin, body below; over a square of half width `half`.
inline TriangleMesh cap(double radius, int cells, double half) {
  return patch(0.0, 0.0, half, cells,
               [=](double x, double z) { return std::sqrt(radius * radius - x * x - z * z); });
}

/// A mesh upside down: turned by half a turn about z, so that normals stay out of the body.
inline TriangleMesh upside_down(const TriangleMesh& mesh) {
  return moved(mesh, {Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitZ()).toRotationMatrix(),
                      Vector3::Zero()});
}

/// The upper part of a cylinder about z: |x| <= half_width in rows of equal angle, |z| <=
/// half_length.
inline TriangleMesh arc(double radius, double half_width, double half_length, int across,
                        int along_axis) {
  const double reach = std::asin(half_width / radius);
  std::vector<Vector3> v;
  std::vector<Eigen::Vector3i> f;
  const int row = along_axis + 1;
  for (int i = 0; i <= across; ++i) {
    const double angle = reach * (2.0 * i / across - 1.0);
    for (int j = 0; j <= along_axis; ++j) {
      v.emplace_back(radius * std::sin(angle), radius * std::cos(angle),
                     half_length * (2.0 * j / along_axis - 1.0));
      if (i == across || j == along_axis) continue;
      const int a = i * row + j;
      f.insert(f.end(), {{a, a + 1, a + row + 1}, {a, a + row + 1, a + row}});
    }
  }
  return mesh_of(v, f);
}

/// A flat rectangle at y = 0, |x| <= half_x, |z| <= half_z, body below. The rows of its faces
/// slant, so that where a contact ends along z it does not end between two rows.
inline TriangleMesh strip(double half_x, double half_z, int cells_x, int cells_z) {
  TriangleMesh mesh = arc(1.0, 0.5, 1.0, cells_x, cells_z);
  for (Eigen::Index v = 0; v < mesh.vertex_count(); ++v) {
    const double xi = 2.0 * static_cast<double>(v / (cells_z + 1)) / cells_x - 1.0;
    const double zeta = mesh.vertices(v, 2);
    mesh.vertices.row(v) << half_x * (xi + 0.3 * (1.0 - xi * xi) * zeta), 0.0, half_z * zeta;
  }
  return mesh;
}

}  // namespace condyle::test
