// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/seating.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "fdk/analytic_contact.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// Where the model first touches, in closed form: each sphere's centre at y = h(c_x, c_z) + R.
double touch_height(const test::KneeShape& shape, const Pose& pose) {
  Pose at_zero = pose;
  at_zero[kY] = 0.0;
  double highest = -HUGE_VAL;
  for (const double towards : {-1.0, 1.0}) {
    const double z_side = 0.5 * towards * shape.spacing;
    for (int k = 0; k < shape.spheres; ++k) {
      const double across = shape.spheres == 1 ? 0.0 : 2.0 * k / (shape.spheres - 1) - 1.0;
      const Vector3 c = transform_TF(at_zero) * Vector3(shape.centre_x, shape.centre_y,
                                                        z_side + towards * across * shape.half_width);
      const double dz = c.z() - z_side;
      highest = std::max(highest, shape.dish_height + c.x() * c.x() / (2 * shape.sagittal_radius) +
                                      dz * dz / (2 * shape.coronal_radius) + shape.radius - c.y());
    }
  }
  return highest;
}

}  // namespace

TEST_CASE("first touch is where the highest sphere meets its dish, from above and from deep within [oracle]") {
  std::mt19937 engine(41);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const test::AnalyticContact model;
  const SeatingSettings settings;
  for (int n = 0; n < 20; ++n) {
    // The spheres stay on the insert (24 mm): 8 mm of x, and 6.3 mm of offset turned by at most 0.4 rad.
    Pose pose;
    pose << 8e-3 * unit(engine), 0.0, 4e-3 * unit(engine), 0.05 * unit(engine), 0.1 * unit(engine),
        0.4 * unit(engine);
    const double expected = touch_height(model.shape(), pose);
    for (const double start : {expected - 0.013, expected + 0.002, expected + 0.09}) {
      pose[kY] = start;
      const FirstTouch touch = first_touch(model, pose, settings);
      INFO("draw " << n << ", start " << start - expected << " m from touch");
      REQUIRE(touch.converged());
      // The tolerance, and the rounding of a load that vanishes with depth^1.9 (below 1e-12 m).
      CHECK(std::abs(touch.pose[kY] - expected) < settings.tolerance + 1e-12);
      pose[kY] = touch.pose[kY];
      CHECK(touch.pose == pose);  // the other coordinates are held
      CHECK(model.evaluate(touch.pose, contact::Derivatives::kNone).total_wrench()[1] > 0.0);
    }
  }
}

TEST_CASE("the femur seats over the middle of the dish, wherever the frames' origins are [oracle]") {
  for (const double flexion : {0.0, 0.37, 1.2}) {
    for (const double forward : {-0.021, 0.0, 0.026}) {
      for (const double up : {-0.09, 0.0, 0.11}) {
        test::KneeShape shape;
        shape.centre_x += forward;  // moves the seat back by as much
        shape.centre_y += up;
        const test::AnalyticContact model(shape);
        const SeatedPose seat = seated_pose(model, flexion);
        INFO("flexion " << flexion << ", forward " << forward << ", up " << up << ": " << name(seat.status));
        // Turned by the flexion, the offsets leave the insert's reach along x (30 mm) at some of these.
        const Pose turned = (Pose() << 0, 0, 0, 0, 0, -flexion).finished();
        const Vector3 centre = transform_TF(turned) * Vector3(shape.centre_x, shape.centre_y, 0.0);
        if (std::abs(centre.x()) > 0.03) continue;
        REQUIRE(seat.converged());
        // At d from the bottom of a bowl of radius a, a step r towards it sinks (d − r/2) r/a: no ring sinks by the least
        // slope s where d < r/2 + s·a for every r down to r_s, at which s·r is the tolerance ε resolved (2ε = s·r_s).
        // Twelve directions miss the best one by 15°, and x and z share the slope: a factor 2. Across, the V of the two
        // condyles' outer spheres is steeper than the bowl.
        const SeatingSettings defaults;
        const double ring = 2 * defaults.tolerance / defaults.least_slope;
        CHECK(std::abs(seat.pose[kX] + centre.x()) <
              2 * (ring / 2 + defaults.least_slope * shape.sagittal_radius));
        CHECK(std::abs(seat.pose[kZ]) < 2 * (ring / 2 + defaults.least_slope * shape.coronal_radius));
        CHECK(seat.pose[kThetaX] == 0.0);
        CHECK(seat.pose[kThetaY] == 0.0);
        CHECK(seat.pose[kThetaZ] == -flexion);
        Pose bottom = seat.pose;
        bottom[kX] = -centre.x();
        bottom[kZ] = 0.0;
        CHECK(std::abs(seat.pose[kY] - touch_height(shape, bottom)) < 1e-8);
      }
    }
  }
}

TEST_CASE("where the insert is level across, the femur stays at the middle [property]") {
  test::KneeShape shape;
  shape.coronal_radius = 1e9;
  const SeatedPose seat = seated_pose(test::AnalyticContact(shape), 0.2);
  REQUIRE(seat.converged());
  CHECK(seat.pose[kZ] == doctest::Approx(0.0).epsilon(1e-9));
}

TEST_CASE("what cannot be seated is reported, with advice [error]") {
  test::KneeShape away;
  away.dish_height = -0.9;
  CHECK(seated_pose(test::AnalyticContact(away), 0.2).status == SeatingStatus::kNoContact);
  CHECK(first_touch(test::AnalyticContact(away), Pose::Zero()).status == SeatingStatus::kNoContact);
  test::KneeShape high;
  high.dish_height = 0.9;
  CHECK(first_touch(test::AnalyticContact(high), Pose::Zero()).status == SeatingStatus::kNoClearance);
  test::KneeShape dome;  // highest in the middle, a single point a side: every way is down
  dome.spheres = 1;
  dome.coronal_radius = -0.09;
  CHECK(seated_pose(test::AnalyticContact(dome), 0.2).status == SeatingStatus::kSlidesOff);
  for (const auto status : {SeatingStatus::kConverged, SeatingStatus::kNoContact, SeatingStatus::kNoClearance, SeatingStatus::kUntrusted,
                            SeatingStatus::kSlidesOff}) {
    CHECK(!advice(status).empty());
    CHECK(name(status) != "unknown");
  }
}

TEST_CASE("a wrong setting or pose is refused by name [error]") {
  const test::AnalyticContact model;
  CHECK_THROWS_WITH_AS(seated_pose(model, NAN), "seating: flexion is nan: must be finite [rad]",
                       std::invalid_argument);
  SeatingSettings settings;
  settings.tolerance = 0.0;
  CHECK_THROWS_WITH_AS(seated_pose(model, 0.0, settings),
                       "seating: tolerance is 0.000000: must be finite and above 0", std::invalid_argument);
  Pose pose = Pose::Zero();
  pose[kZ] = NAN;
  CHECK_THROWS_AS(first_touch(model, pose), std::invalid_argument);
  pose = Pose::Zero();
  pose[kY] = NAN;  // does not matter
  CHECK(first_touch(model, pose).converged());
}
