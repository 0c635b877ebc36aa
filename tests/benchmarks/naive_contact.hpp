// SPDX-License-Identifier: Apache-2.0
// The baseline that every evaluation is measured against.
#pragma once

#include <array>

#include "condyle/contact/contact_law.hpp"
#include "condyle/contact/surface_faces.hpp"
#include "condyle/geometry/signed_distance.hpp"

namespace condyle::benchmark {

/// One closest-point search per insert face, no culling: what a straightforward program does. The
/// total Fy comes along, so that nothing is optimised away and the rows can be compared.
inline double naive_force(const geometry::SignedDistance& distance,
                          const std::array<contact::SurfaceFaces, kSides>& compartments,
                          const Pose& pose, int& loaded) {
  const RigidTransform X_TF = transform_TF(pose), X_FT = X_TF.inverse();
  const contact::ContactLaw law;
  double force = 0.0;
  loaded = 0;
  for (const contact::SurfaceFaces& faces : compartments) {
    for (Eigen::Index f = 0; f < faces.count(); ++f) {
      const auto query = distance.query(X_FT * Vector3(faces.centroids.row(f)));
      if (!(query.distance < 0.0) || query.on_border) continue;
      ++loaded;
      force -= faces.areas[f] * law.at(-query.distance).pressure * (X_TF.R * query.gradient).y();
    }
  }
  return force;
}

}  // namespace condyle::benchmark
