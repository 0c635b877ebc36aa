// SPDX-License-Identifier: Apache-2.0
// A contact pair in closed form for tests of the fast evaluation: a torus as the femur, two dished
// patches as the insert.
//
//   φ(p) = hypot(hypot(p_x, p_y) − R, p_z) − r  in a frame tilted in F: every term of the Hessian
// is at work.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "condyle/contact/contact_pair.hpp"
#include "condyle/contact/fast_integral.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

struct TorusPair {
  static constexpr double kMajor = 0.0231, kMinor = 0.0172;

  Matrix3 tilt;  // F to the torus's own frame
  std::shared_ptr<const geometry::DistanceField> field;
  std::array<contact::SurfaceFaces, kSides> compartments;
  Pose pose;  // nominal: overlap of about 1 mm on both sides

  double distance(const Vector3& p_F) const {
    const Vector3 p = tilt * p_F;
    return std::hypot(std::hypot(p.x(), p.y()) - kMajor, p.z()) - kMinor;
  }

  /// @param faces of each patch, roughly.
  explicit TorusPair(std::uint64_t seed = 41, double spacing = 0.9e-3, int side_faces = 40) {
    Draw draw(seed);
    tilt = rotation_TF((Pose() << 0, 0, 0, 0.4, -0.3, 0.7).finished());
    geometry::DistanceFieldSettings settings;
    settings.spacing = spacing;
    const Vector3 half = Vector3::Constant(kMajor + kMinor);
    field = std::make_shared<const geometry::DistanceField>(geometry::DistanceField::build(
        -half, half, settings,
        [this](const Vector3& p) {
          return geometry::DistanceSample{distance(p), false};
        },
        1));
    pose << 0.011, 0.042, -0.007, 0.23, -0.31, -0.52;
    const RigidTransform X_TF = transform_TF(pose);
    for (const Side side : {kMedial, kLateral}) {
      compartments[side] = patch(X_TF, side == kMedial ? -0.6 : 0.5, side_faces, draw);
    }
  }

 private:
  // Points on a shallow dish about a place on the torus's outer rim, 1 mm deep in the middle, out
  // of contact at its edge.
  contact::SurfaceFaces patch(const RigidTransform& X_TF, double angle, int n,
                                  Draw& draw) const {
    const double u = angle, v = 0.3 * angle;  // around the axis; around the tube
    const Vector3 out(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
    const Vector3 ring(kMajor * std::cos(u), kMajor * std::sin(u), 0.0);
    const Vector3 normal = X_TF.R * tilt.transpose() * out;
    const Vector3 centre = X_TF * (tilt.transpose() * (ring + (kMinor - 1e-3) * out));
    const Vector3 s = normal.cross(Vector3(0.3, 0.5, -0.8)).normalized(), t = normal.cross(s);
    contact::SurfaceFaces faces;
    faces.centroids.resize(n * n, 3);
    faces.areas.resize(n * n);
    faces.normals.resize(n * n, 3);
    for (int i = 0; i < n * n; ++i) {
      const double a = (i / n + draw(0.2, 0.8)) / n - 0.5, b = (i % n + draw(0.2, 0.8)) / n - 0.5;
      const double width = 0.024;
      faces.centroids.row(i) =
          centre + width * (a * s + b * t) + 6.0 * width * width * (a * a + b * b) * normal;
      faces.areas[i] = width * width / (n * n) * draw(0.7, 1.3);
      faces.normals.row(i) = -(normal - 12.0 * width * (a * s + b * t)).normalized();
    }
    return faces;
  }
};

/// Both compartments integrated against the field.
inline contact::ContactPair fast_pair(
    const std::shared_ptr<const geometry::DistanceField>& field,
    const std::array<contact::SurfaceFaces, kSides>& compartments, const contact::ContactLaw& law,
    contact::InstructionSet set = contact::best_instruction_set()) {
  std::vector<contact::ContactPair::Compartment> parts;
  for (const auto& faces : compartments) {
    parts.push_back({contact::make_fast_integral(field, faces, law, set), nullptr});
  }
  return contact::ContactPair(std::move(parts));
}

}  // namespace condyle::test
