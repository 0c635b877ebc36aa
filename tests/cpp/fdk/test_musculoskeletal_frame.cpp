// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/musculoskeletal_frame.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fdk/leg_model.hpp"
#include "support/forearm_model.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

std::string message_of(const model::Model& model, const MuscleSettings& settings) {
  try {
    MusculoskeletalFrame frame(model, settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("muscles hold a forearm against gravity, motion and a load in the hand [closed form]") {
  const model::Model model(test::forearm_model());
  MuscleSettings settings;
  settings.strength = model::StrengthModel::kConstant;
  MusculoskeletalFrame frame(model, settings);
  REQUIRE(frame.balanced().size() == 1);

  const double q = 0.37, qd = -0.8, qdd = 2.1;
  frame.set_motion(one(q), one(qd), one(qdd));
  // 20 N down in the hand, 0.3 m along the forearm.
  const Vector3 hand(0.3 * std::cos(q), 0.3 * std::sin(q), 0.0);
  const model::ExternalLoad load{model.body("forearm"), Vector3(0, -20, 0), hand, Vector3::Zero()};
  frame.compute_dynamics({&load, 1});
  const double inertia = 0.02 + 1.5 * 0.12 * 0.12;
  const double tau = inertia * qdd + (1.5 * 9.80665 * 0.12 + 20.0 * 0.3) * std::cos(q);
  CHECK(frame.generalised_forces()[0] == doctest::Approx(tau).epsilon(1e-12));

  frame.compute_muscles();
  // From (0, 0.3) to (0.04 cos q, 0.04 sin q): L² = 0.3² + 0.04² − 2·0.3·0.04 sin q.
  const double length = std::sqrt(0.09 + 0.0016 - 0.024 * std::sin(q));
  const double arm = 0.012 * std::cos(q) / length;
  CHECK(frame.muscles()[0].length == doctest::Approx(length).epsilon(1e-13));
  CHECK(frame.muscles()[0].velocity == doctest::Approx(-arm * qd).epsilon(1e-12));
  CHECK(frame.moment_arms()(0, 0) == doctest::Approx(arm).epsilon(1e-12));
  CHECK(frame.moment_arms()(0, 1) < 0.0);  // the extensor's

  frame.compute_ligaments();
  const auto& result = frame.recruit();
  REQUIRE(result.converged());
  CHECK(frame.muscle_forces()[0] == doctest::Approx(tau / arm).epsilon(1e-9));
  CHECK(std::abs(frame.muscle_forces()[1]) < 1e-9);
  CHECK(std::abs(frame.residual()[0]) < 1e-9 * tau);
}

TEST_CASE("passive tension and springs are taken off before muscles are recruited") {
  model::ModelDescription description = test::forearm_model();
  description.springs.push_back({"elbow", 7.0, 0.1, 0.3});
  const model::Model model(description);
  MusculoskeletalFrame frame(model, {});
  const double q = -0.9, qd = 0.4;  // the flexor is long
  frame.set_motion(one(q), one(qd), one(0.0));
  frame.compute_dynamics({});
  frame.compute_muscles();
  frame.compute_ligaments();
  CHECK(frame.spring_forces()[0] == doctest::Approx(-7.0 * (q - 0.1) - 0.3 * qd).epsilon(1e-12));
  const auto& result = frame.recruit();
  REQUIRE(result.converged());
  const double passive = frame.muscles()[0].strength.passive;
  CHECK(passive > 1.0);
  CHECK(frame.muscle_forces()[0] == doctest::Approx(result.forces[0] + passive).epsilon(1e-12));
  // Everything together balances τ.
  const double given = frame.moment_arms().row(0).dot(frame.muscle_forces()) + frame.spring_forces()[0];
  CHECK(given == doctest::Approx(frame.generalised_forces()[0]).epsilon(1e-9));
}

TEST_CASE("a load beyond the muscles is infeasible by name; a reserve carries what is left") {
  const model::Model model(test::forearm_model());
  const auto solve = [&](MusculoskeletalFrame& frame) -> const recruitment::Recruitment& {
    frame.set_motion(one(0.2), one(0.0), one(5000.0));
    frame.compute_dynamics({});
    frame.compute_muscles();
    frame.compute_ligaments();
    return frame.recruit();
  };
  MusculoskeletalFrame alone(model, {});
  CHECK(solve(alone).status == recruitment::RecruitmentStatus::kInfeasible);
  CHECK(alone.recruitment_message().find("elbow") != std::string::npos);
  MuscleSettings settings;
  settings.reserve_moment = 1.0;
  MusculoskeletalFrame helped(model, settings);
  const auto& result = solve(helped);
  CHECK(result.converged());
  CHECK(result.reserves[0] > 1.0);
  CHECK(helped.residual()[0] == doctest::Approx(result.reserves[0]).epsilon(1e-9));
}

TEST_CASE("what cannot be meant is refused by name") {
  const model::Model model(test::forearm_model());
  MuscleSettings settings;
  settings.reserve_moment = -1.0;
  CHECK(message_of(model, settings) == "muscle settings: reserve_moment is -1; it must be at least 0");
  model::ModelDescription description = test::forearm_model();
  description.coordinates[0].balance = model::CoordinateBalance::kReaction;
  const model::Model driven(description);
  MusculoskeletalFrame frame(driven, {});
  frame.set_motion(one(0.1), one(0.0), one(0.0));
  CHECK(frame.balanced().empty());
  CHECK_THROWS_WITH_AS(frame.recruit(), doctest::Contains("nothing to recruit"), std::logic_error);
}

TEST_CASE("moving some coordinates is what setting the whole motion anew is") {
  model::ModelDescription description = test::leg_model_description();
  // A muscle that the knee does not move.
  model::MuscleDescription gluteus = description.muscles[0];
  gluteus.name = "gluteus";
  gluteus.path.points = {gluteus.path.points[0], gluteus.path.points[0]};
  gluteus.path.points[0].body = model::kGround;
  gluteus.path.points[0].location = {0.05, 1.2, 0.1};
  description.muscles.push_back(gluteus);
  const model::Model model(description);
  const std::vector<int> columns{model.coordinate("adduction"), model.coordinate("tx"), model.coordinate("ty")};
  const FrameInstant instant = test::leg_instant(model, 0.6);
  MusculoskeletalFrame moved(model, {}, columns), set(model, {});
  const auto compute = [&](MusculoskeletalFrame& frame) {
    frame.compute_dynamics(instant.loads);
    frame.compute_muscles();
    frame.compute_ligaments();
    frame.recruit();
  };
  moved.set_motion(instant.q, instant.qd, instant.qdd);
  compute(moved);
  const Vector3 values(0.02, -0.003, -0.004);
  moved.move_columns(values);
  compute(moved);
  Eigen::VectorXd q = instant.q;
  for (int i = 0; i < 3; ++i) q[columns[static_cast<std::size_t>(i)]] = values[i];
  set.set_motion(q, instant.qd, instant.qdd);
  compute(set);
  CHECK(moved.residual() == set.residual());
  CHECK(moved.moment_arms() == set.moment_arms());
  CHECK(moved.muscle_forces() == set.muscle_forces());
  CHECK_THROWS_WITH_AS(MusculoskeletalFrame(model, {}, std::vector<int>{7}),
                       doctest::Contains("coordinate 7: must be 0 to 6"), std::invalid_argument);
}
