// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/touch_map.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "fdk/analytic_contact.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// A model that trusts itself only where its own knee carries load, and invents a load everywhere else.
class Doubtful : public contact::ContactModel {
 public:
  SideOfBody side_of_body() const override { return knee_.side_of_body(); }
  contact::ContactLoads evaluate(const Pose& pose, contact::Derivatives d) const override {
    contact::ContactLoads loads = knee_.evaluate(pose, d);
    if (loads.total_wrench()[1] > 0.0 && !loads.implausible_depth) return loads;
    loads.trust = 0.1;
    loads.wrench[kMedial][1] = 640.0;
    return loads;
  }

 private:
  test::AnalyticContact knee_;
};

}  // namespace

TEST_CASE("a node's law predicts touch between nodes [property]") {
  const test::AnalyticContact model;
  const TouchMap map(model, TouchSearch{});
  const auto& shape = model.shape();
  for (const double x : {-0.0037, 0.0021, 0.0083}) {
    for (const double theta_z : {0.07, -0.41, -1.28}) {
      const KneeResponse response = map.at(x, theta_z);
      Pose pose = Pose::Zero();
      pose[kX] = x;
      pose[kThetaZ] = theta_z;
      const Vector3 centre = transform_TF(pose) * Vector3(shape.centre_x, shape.centre_y, 0.0);
      const double y_touch = shape.dish_height + shape.radius +
                             centre.x() * centre.x() / (2 * shape.sagittal_radius) - centre.y();
      for (const SideResponse& side : response) {
        REQUIRE(side.known);
        // Interpolation h²/8 · y'' (0.1 mm by the grid's choice) and the law's exponent (0.1 of 0.1 mm).
        CHECK(std::abs(side.y_touch - y_touch) < 1.5e-4);
      }
    }
  }
  CHECK(map.evaluations() > 0);
}

TEST_CASE("outside the map, and beside the insert, nothing is known [property]") {
  const test::AnalyticContact model;
  const TouchMap map(model, TouchSearch{});
  CHECK(!map.at(0.05, -0.3)[kMedial].known);
  CHECK(!map.at(0.0, 0.9)[kMedial].known);
  CHECK(!map.at(0.034, 0.0)[kLateral].known);
}

TEST_CASE("loads that a model does not trust are no touch [property]") {
  const Doubtful model;
  Pose pose = Pose::Zero();
  contact::ContactLoads loads;
  descend_to_contact(model, TouchSearch{}, pose, loads);
  CHECK(loads.trust == 1.0);
  CHECK(loads.total_wrench()[1] > 0.0);
  CHECK(pose[kY] < 0.0425);
}
