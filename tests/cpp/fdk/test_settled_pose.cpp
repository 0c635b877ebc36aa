// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/settled_pose.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "fdk/analytic_contact.hpp"

using namespace condyle;
using namespace condyle::fdk;

TEST_CASE("the femur settles with its spheres over the lowest line of the dish [oracle]") {
  const test::AnalyticContact model;
  const auto& shape = model.shape();
  for (const double flexion : {0.0, 0.31, 1.1}) {
    const SettledPose settled = settled_pose(model, flexion);
    INFO("flexion " << flexion << ": " << name(settled.newton.status));
    REQUIRE(settled.converged());
    CHECK(settled.pose[kThetaX] == 0.0);
    CHECK(settled.pose[kThetaY] == 0.0);
    CHECK(settled.pose[kThetaZ] == -flexion);
    // Centre of the spheres over x = z = 0; F over the residual's tolerance of 0.01 N by a stiffness of F/a = 150/0.0573.
    const Vector3 centre =
        transform_TF(settled.pose) * Vector3(shape.centre_x, shape.centre_y, 0.0);
    CHECK(std::abs(centre.x()) < 0.01 / (150.0 / shape.sagittal_radius));
    CHECK(std::abs(centre.z()) < 0.01 / (150.0 / shape.coronal_radius));
    // Five equal spheres a side but for the coronal dish, worth at most half_width²/2b.
    const double depth = std::pow(15.0 / shape.stiffness, 1.0 / shape.exponent);
    const double dish = shape.half_width * shape.half_width / (2 * shape.coronal_radius);
    CHECK(std::abs(centre.y() - (shape.dish_height + shape.radius - depth)) < dish);
  }
}

TEST_CASE("an implant out of reach is reported, not invented [error]") {
  test::KneeShape shape;
  shape.dish_height = -0.5;
  const test::AnalyticContact model(shape);
  const SettledPose settled = settled_pose(model, 0.2);
  CHECK(!settled.touched);
  CHECK(!settled.converged());
  CHECK_THROWS_WITH_AS(settled_pose(model, NAN),
                       "settled pose: flexion is nan: must be finite [rad]", std::invalid_argument);
}
