// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/side_response.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "fdk/analytic_contact.hpp"

using namespace condyle;
using namespace condyle::fdk;

TEST_CASE("the law matches force, moment and their slopes where it is fitted [derivative]") {
  const test::AnalyticContact model;
  Pose pose;
  pose << 0.0027, 0.0413, 0.0011, 0.006, -0.07, -0.33;
  const auto loads = model.evaluate(pose, contact::Derivatives::kStiffness);
  for (int s = 0; s < kSides; ++s) {
    const SideResponse side = fit_side_response(pose, loads.wrench[s], loads.stiffness[s]);
    REQUIRE(side.known);
    const SensitivePoint p{pose[kY], pose[kThetaX]};
    const auto moment = [&](const SensitivePoint& q) { return side.arm_at(q) * side.force(q); };
    CHECK(side.force(p) == doctest::Approx(loads.wrench[s][1]).epsilon(1e-10));
    CHECK(moment(p) == doctest::Approx(loads.wrench[s][3]).epsilon(1e-10));
    // Central differences with h = 1e-7 over depths of 1e-4: truncation (h/d)² ~ 1e-6.
    const double h = 1e-7;
    const SensitivePoint up{p.y + h, p.theta_x}, down{p.y - h, p.theta_x};
    const SensitivePoint plus{p.y, p.theta_x + h}, minus{p.y, p.theta_x - h};
    CHECK((side.force(up) - side.force(down)) / (2 * h) ==
          doctest::Approx(loads.stiffness[s](1, kY)).epsilon(1e-5));
    CHECK((side.force(plus) - side.force(minus)) / (2 * h) ==
          doctest::Approx(loads.stiffness[s](1, kThetaX)).epsilon(1e-5));
    CHECK((moment(plus) - moment(minus)) / (2 * h) ==
          doctest::Approx(loads.stiffness[s](3, kThetaX)).epsilon(1e-5));
    CHECK(side.force({p.y - side.depth_for(500.0) + side.depth(p), p.theta_x}) ==
          doctest::Approx(500.0).epsilon(1e-9));
  }
}

TEST_CASE("a secant turns the law to what was seen before, and leaves it where it was fitted [property]") {
  const test::AnalyticContact model;
  Pose pose = Pose::Zero();
  pose[kY] = 0.0413;
  const auto loads = model.evaluate(pose, contact::Derivatives::kStiffness);
  SideResponse side = fit_side_response(pose, loads.wrench[0], loads.stiffness[0]);
  const SensitivePoint here{0.0413, 0.0}, before{0.04131, 0.0023};
  const double force = side.force(here), arm = side.arm_at(here);
  const double force_before = 0.7 * side.force(before), arm_before = side.arm_at(before) + 0.0017;
  side.match(before, force_before, arm_before);
  CHECK(side.force(before) == doctest::Approx(force_before).epsilon(1e-9));
  CHECK(side.arm_at(before) == doctest::Approx(arm_before).epsilon(1e-9));
  CHECK(side.force(here) == doctest::Approx(force).epsilon(1e-12));
  CHECK(side.arm_at(here) == doctest::Approx(arm).epsilon(1e-12));
}

TEST_CASE("a side out of contact has no law, and a law seen unloaded backs off [property]") {
  const test::AnalyticContact model;
  Pose pose = Pose::Zero();
  pose[kY] = 0.0413;
  const auto loads = model.evaluate(pose, contact::Derivatives::kStiffness);
  SideResponse side = fit_side_response(pose, loads.wrench[0], loads.stiffness[0]);
  REQUIRE(side.known);
  side.seen_unloaded({0.0412, 0.0});
  CHECK(side.depth({0.0412, 0.0}) == doctest::Approx(-1e-4));
  side.seen_unloaded({0.0410, 0.0});
  CHECK(side.depth({0.0410, 0.0}) == doctest::Approx(-2e-4));
  side.seen_unloaded({0.0413, 0.0});  // nothing new: it was predicted
  CHECK(side.depth({0.0410, 0.0}) == doctest::Approx(-2e-4));
  CHECK(side.force({0.0412, 0.0}) == 0.0);
  CHECK(!fit_side_response(pose, Wrench::Zero(), Matrix6::Zero()).known);
}
