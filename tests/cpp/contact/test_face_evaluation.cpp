// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "condyle/contact/face_evaluation.hpp"
#include "condyle/geometry/signed_distance.hpp"
#include "contact/contact_fixtures.hpp"

using namespace condyle;
using namespace condyle::contact;

TEST_CASE("a compartment's points: centroid, area and unit normal; no normal without an area") {
  const auto dish = test::dished_insert(8)[kMedial];
  const CompartmentFaces faces = compartment_faces(dish);
  REQUIRE(faces.count() == dish.face_count());
  for (Eigen::Index f = 0; f < faces.count(); ++f) {
    const Vector3 n = faces.normals.row(f), c = faces.centroids.row(f);
    CHECK(std::abs(n.norm() - 1.0) < 1e-14);
    CHECK(n.y() > 0.9);
    for (int k = 0; k < 3; ++k) {  // the normal is across the plane of the corners and the centroid
      CHECK(std::abs(n.dot(Vector3(dish.vertices.row(dish.faces(f, k))) - c)) < 1e-16);
    }
  }
  const auto line = test::mesh_of({{0, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0}}, {{0, 1, 2}});
  CHECK(compartment_faces(line).areas[0] == 0.0);
  CHECK(compartment_faces(line).normals.row(0).norm() == 0.0);
}

TEST_CASE(
    "the exact evaluation is the sum over all faces of what a whole-surface search says, culled or "
    "not") {
  const auto femur = test::notched_femur();
  const InsertMeshes insert = test::dished_insert(20);
  const Compartments compartments{compartment_faces(insert[kMedial]),
                                  compartment_faces(insert[kLateral])};
  const ContactLaw law(LinearVolumeLaw{5.1e9});
  const auto evaluation = make_exact_evaluation(femur, compartments, law);
  const geometry::SignedDistance surface(femur);
  test::Draw draw(61);
  for (int trial = 0; trial < 4; ++trial) {
    const Pose pose = test::pressed_pose(draw);
    const RigidTransform X_TF = transform_TF(pose), X_FT = X_TF.inverse();
    for (const Side side : {kMedial, kLateral}) {
      const CompartmentFaces& faces = compartments[side];
      SideLoads sum;
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
      const SideLoads found = evaluation->evaluate(pose, side, Derivatives::kNone);
      REQUIRE(sum.pressure_sum > 10.0);
      // The same terms in the same order; depths of 1e-3 carry 1e-14 of rounding.
      CHECK((found.wrench - sum.wrench).norm() < 1e-12 * sum.wrench.norm());
      CHECK(found.energy == doctest::Approx(sum.energy).epsilon(1e-12));
      CHECK(found.pressure_sum == doctest::Approx(sum.pressure_sum).epsilon(1e-12));
      CHECK(found.stiffness == Matrix6::Zero());
      CHECK(evaluation->evaluate(pose, side, Derivatives::kStiffness).wrench == found.wrench);
    }
  }
}
