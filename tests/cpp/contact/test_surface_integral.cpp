// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>

#include "condyle/contact/contact_pair.hpp"
#include "condyle/geometry/signed_distance.hpp"
#include "contact/contact_fixtures.hpp"

using namespace condyle;
using namespace condyle::contact;

TEST_CASE(
    "the exact integral is the sum over all faces of what a whole-surface search says, culled or "
    "not") {
  const auto femur = test::notched_femur();
  const InsertMeshes insert = test::dished_insert(20);
  const std::array<SurfaceFaces, kSides> compartments{surface_faces(insert[kMedial]),
                                                      surface_faces(insert[kLateral])};
  const ContactLaw law(LinearVolumeLaw{5.1e9});
  const ContactPair pair = make_contact_pair(femur, {insert[kMedial], insert[kLateral]}, law);
  const geometry::SignedDistance surface(femur);
  test::Draw draw(61);
  for (int trial = 0; trial < 4; ++trial) {
    const Pose pose = test::pressed_pose(draw);
    const RigidTransform X_TF = transform_TF(pose), X_FT = X_TF.inverse();
    for (const Side side : {kMedial, kLateral}) {
      const SurfaceFaces& faces = compartments[side];
      CompartmentLoads sum;
      for (Eigen::Index f = 0; f < faces.count(); ++f) {
        const Vector3 c = faces.centroids.row(f);
        const auto query = surface.query(X_FT * c);
        if (query.distance >= 0.0 || query.on_border) continue;
        const Vector3 force = 5.1e9 * faces.areas[f] * query.distance * (X_TF.R * query.gradient);
        sum.wrench.head<3>() += force;
        sum.wrench.tail<3>() += (c - X_TF.p).cross(force);
        sum.energy += 0.5 * 5.1e9 * faces.areas[f] * query.distance * query.distance;
        sum.pressure_sum -= 5.1e9 * faces.areas[f] * query.distance;
      }
      const CompartmentLoads found = pair.evaluate(pose, side, Derivatives::kNone);
      REQUIRE(sum.pressure_sum > 10.0);
      // The same terms in the same order; depths of 1e-3 carry 1e-14 of rounding.
      CHECK((found.wrench - sum.wrench).norm() < 1e-12 * sum.wrench.norm());
      CHECK(found.energy == doctest::Approx(sum.energy).epsilon(1e-12));
      CHECK(found.pressure_sum == doctest::Approx(sum.pressure_sum).epsilon(1e-12));
      CHECK(found.stiffness == Matrix6::Zero());
      CHECK(pair.evaluate(pose, side, Derivatives::kStiffness).wrench == found.wrench);
    }
  }
}
