// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads_input.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "fdk/given_loads_fixture.hpp"

using namespace condyle;
using namespace condyle::fdk;

TEST_CASE("half-way between two time frames is their mean in every field") {
  test::Draw draw(71);
  GivenLoadsFrame a = test::leg_frame(), b = test::leg_frame();
  test::let_arms_move(a, draw);
  test::let_arms_move(b, draw);
  a.minima = a.strengths * 0.013;
  b.minima = b.strengths * 0.027;
  b.flexion = 0.51;
  b.loads *= 1.7;
  b.secondary_loads *= -0.4;
  b.wrench << 3, 5, 7, 11, 13, 17;
  b.moment_arms *= 0.9;
  b.secondary_arms *= 1.1;
  b.strengths *= 0.8;
  b.arms_at *= 2.0;
  const GivenLoadsFrame c = between(a, b, 0.5);
  // Sums and halves of doubles: one rounding.
  const auto mean = [](const auto& u, const auto& v, const auto& w) {
    return (w - 0.5 * (u + v)).norm() <= 1e-15 * (u.norm() + v.norm());
  };
  CHECK(c.flexion == doctest::Approx(0.39).epsilon(1e-15));
  CHECK(mean(a.loads, b.loads, c.loads));
  CHECK(mean(a.secondary_loads, b.secondary_loads, c.secondary_loads));
  CHECK(mean(a.wrench, b.wrench, c.wrench));
  CHECK(mean(a.moment_arms, b.moment_arms, c.moment_arms));
  CHECK(mean(a.secondary_arms, b.secondary_arms, c.secondary_arms));
  CHECK(mean(a.strengths, b.strengths, c.strengths));
  CHECK(mean(a.minima, b.minima, c.minima));
  CHECK(mean(a.arms_by_pose, b.arms_by_pose, c.arms_by_pose));
  CHECK(mean(a.arms_at, b.arms_at, c.arms_at));
  const GivenLoadsFrame none = unloaded(b);
  CHECK(none.loads.norm() + none.secondary_loads.norm() + none.wrench.norm() == 0.0);
  CHECK((none.moment_arms - b.moment_arms).norm() == 0.0);
}

TEST_CASE("what cannot be meant is refused by time frame, field and value") {
  const GivenLoadsSetup setup = test::leg_setup();
  const auto message = [&](auto&& spoil) -> std::string {
    GivenLoadsFrame frame = test::leg_frame();
    spoil(frame);
    try {
      require_valid(frame, setup, 12);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message([](GivenLoadsFrame&) {}) == "");
  CHECK(message([](GivenLoadsFrame& f) { f.loads.resize(2); f.loads.setZero(); }) ==
        "given loads: time frame 12: loads has shape (2, 1): must be (3, 1)");
  CHECK(message([](GivenLoadsFrame& f) { f.secondary_arms(1, 2) = std::nan(""); }) ==
        "given loads: time frame 12: secondary_arms[1][2] is nan: must be finite");
  CHECK(message([](GivenLoadsFrame& f) {
          f.flexion = std::numeric_limits<double>::infinity();
        }) == "given loads: time frame 12: flexion is inf: must be finite [rad]");
  CHECK(message([](GivenLoadsFrame& f) { f.arms_by_pose.setZero(3, 7); }) ==
        "given loads: time frame 12: arms_by_pose has shape (3, 7): must be (40, 7)");
}

TEST_CASE("a knee of the other side, and a coordinate that is not there, are refused") {
  GivenLoadsSetup setup = test::leg_setup();
  const test::AnalyticContact right;
  CHECK_NOTHROW(require_valid(setup, right));
  test::KneeShape shape;
  shape.side_of_body = SideOfBody::kLeft;
  const test::AnalyticContact left(shape);
  CHECK_THROWS_WITH_AS(
      require_valid(setup, left),
      "given loads: the contact model is of a left knee, the loads are of a right one",
      std::invalid_argument);
  setup.knee_coordinate = 3;
  CHECK_THROWS_WITH_AS(require_valid(setup, right),
                       "given loads: knee_coordinate is 3: must be 0 to 2, or -1 for none",
                       std::invalid_argument);
  setup.knee_coordinate = 1;
  setup.ligaments[2].slack_length = -0.01;
  CHECK_THROWS_AS(require_valid(setup, right), std::invalid_argument);
}
