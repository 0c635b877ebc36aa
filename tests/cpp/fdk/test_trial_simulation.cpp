// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "condyle/fdk/trial_simulation.hpp"
#include "fdk/leg_model.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

constexpr Eigen::Index kFrames = 13;

struct Leg {
  model::Model model{test::leg_model_description()};
  test::AnalyticContact knee;
  BodyContactDescription contact = test::leg_contact(knee);

  TrialSimulation simulate(const TrialInput& input, const TrialSimulationSettings& settings = {},
                           const TimeFrames& starts = {}) const {
    return simulate_trial(model, input, {&contact, 1}, starts, settings);
  }
};

// A squat: down and up again, so that the last time frame is the first.
TrialInput squat(const model::Model& model) {
  TrialInput input;
  for (TimeFrames* table : {&input.q, &input.qd, &input.qdd})
    table->setZero(kFrames, model.n_coordinates());
  for (Eigen::Index i = 0; i < kFrames; ++i) {
    const double phase = 2.0 * 3.14159265358979 * static_cast<double>(i) / (kFrames - 1);
    const FrameInstant instant = test::leg_instant(model, 0.45 - 0.25 * std::cos(phase));
    input.q.row(i) = instant.q.transpose();
    input.qd.row(i) = 0.2 * instant.qd.transpose();
    input.loads.push_back(instant.loads);
  }
  return input;
}

}  // namespace

TEST_CASE("a trial out and back ends where it began, all in equilibrium") {
  const Leg leg;
  const TrialInput input = squat(leg.model);
  TrialSimulationSettings settings;
  settings.solver.max_sharing_updates =
      0;  // muscles share as an analysis of known coordinates has it
  const TrialSimulation s = leg.simulate(input, settings);
  INFO(summary(s));
  REQUIRE(s.converged());
  CHECK(summary(s) == "13 of 13 time frames converged");
  CHECK((s.alpha.row(0) - s.alpha.row(kFrames - 1)).cwiseAbs().maxCoeff() < 1e-5);
  CHECK((s.alpha.row(0) - s.alpha.row(kFrames / 2)).cwiseAbs().maxCoeff() >
        1e-4);  // and it moved between
  for (Eigen::Index i = 0; i < kFrames; ++i) {
    CAPTURE(i);
    const ForceDependentRecord& record = s.records[static_cast<std::size_t>(i)];
    CHECK(record.evaluations > 0);
    CHECK(record.history.back() <= 1.0);
    // Closed loop: an analysis of the result's coordinates leaves on α what contact gives.
    MusculoskeletalFrame frame(leg.model, {});
    frame.set_motion(s.q.row(i).transpose(), input.qd.row(i).transpose(),
                     input.qdd.row(i).transpose());
    frame.compute_dynamics(input.loads[static_cast<std::size_t>(i)]);
    frame.compute_muscles();
    frame.compute_ligaments();
    REQUIRE(frame.recruit(s.contact_loads.row(i).transpose()).converged());
    for (const int c : s.force_dependent) CHECK(std::abs(frame.residual()[c]) < 0.011);
    CHECK((frame.muscle_forces().transpose() - s.muscle_forces.row(i)).norm() <
          1e-6 * s.muscle_forces.row(i).norm());
    // Contact's pose and wrench belong together.
    const Pose pose = s.contact_poses.row(i).transpose();
    const Wrench medial = s.contact_wrenches.row(i).head<6>().transpose();
    CHECK((leg.knee.evaluate(pose, contact::Derivatives::kNone).wrench[kMedial] - medial).norm() <
          1e-9 * medial.norm());
  }
}

TEST_CASE("chunks: the same bytes for any number of threads, the same equilibria as serially") {
  const Leg leg;
  const TrialInput input = squat(leg.model);
  TrialSimulationSettings settings;
  const TrialSimulation serial = leg.simulate(input, settings);
  settings.chunk = 4;
  const TrialSimulation one = leg.simulate(input, settings);
  settings.threads = 3;
  const TrialSimulation three = leg.simulate(input, settings);
  REQUIRE(one.converged());
  CHECK(one.alpha == three.alpha);
  CHECK(one.contact_wrenches == three.contact_wrenches);
  CHECK(one.muscle_forces == three.muscle_forces);
  CHECK((one.alpha - serial.alpha).cwiseAbs().maxCoeff() < 1e-4);  // as C has settled
}

TEST_CASE("rates of α: taken as zero, or kept") {
  const Leg leg;
  TrialInput input = squat(leg.model);
  const int rotation = leg.model.coordinate("rotation");
  const TrialSimulation still = leg.simulate(input);
  input.qd.col(rotation).setConstant(2.0);  // the spring's damper gives −0.6 Nm
  const TrialSimulation ignored = leg.simulate(input);
  CHECK(ignored.alpha == still.alpha);
  TrialSimulationSettings settings;
  settings.keep_rates = true;
  const TrialSimulation kept = leg.simulate(input, settings);
  REQUIRE(kept.converged());
  CHECK((kept.alpha.col(1) - still.alpha.col(1)).cwiseAbs().minCoeff() > 1e-4);
}

TEST_CASE(
    "a time frame that does not converge is reported, what was done is kept, the rest goes on") {
  const Leg leg;
  TrialInput input = squat(leg.model);
  TrialSimulationSettings settings;
  SUBCASE("too few iterations for a jump") {
    input.loads[5][0].force_G *= 6.0;
    settings.solver.newton.max_iterations = 3;
    settings.solver.max_substeps = 1;
    settings.solver.softer_contact.clear();
    settings.extrapolation = 2;
    // A good start for every time frame but the fifth.
    const TrialSimulation before = leg.simulate(squat(leg.model));
    const TrialSimulation s = leg.simulate(input, settings, before.alpha);
    REQUIRE(s.not_converged == 1);
    const ForceDependentRecord& record = s.records[5];
    CHECK(record.status == ForceDependentStatus::kNotConverged);
    CHECK(s.alpha.row(5).transpose() == record.alpha);
    CHECK(s.alpha_residuals.row(5).cwiseAbs().maxCoeff() > 0.0005);
    CHECK(summary(s).find(
              "12 of 13 time frames converged; first not converged: time frame 5: not converged") ==
          0);
    CHECK(summary(s).find(record.worst_name) != std::string::npos);
  }
  SUBCASE("muscles too weak") {
    input.loads[7][0].point_G.x() -= 1.0;
    const TrialSimulation s = leg.simulate(input, settings);
    REQUIRE(s.not_converged == 1);
    CHECK(s.records[7].recruitment == recruitment::RecruitmentStatus::kInfeasible);
    CHECK(s.records[7].message.find("flexion") != std::string::npos);
    CHECK(s.muscle_forces.row(7).maxCoeff() > 0.0);
    CHECK(s.records[8].status == ForceDependentStatus::kConverged);
  }
}

TEST_CASE("a trial that begins where nothing is found from nothing is entered elsewhere") {
  const Leg leg;
  const TrialInput input = squat(leg.model);
  TrialSimulationSettings settings;
  settings.solver.newton.max_iterations = 5;
  const TrialSimulation before = leg.simulate(input);
  TimeFrames starts = before.alpha;
  starts.row(0) << 0.06, 0.3, 0.02, 0.015, -0.02;
  const TrialSimulation s = leg.simulate(input, settings, starts);
  INFO(summary(s));
  REQUIRE(s.converged());
  CHECK(s.records[0].evaluations > s.records[1].evaluations);  // both attempts count
  CHECK((s.alpha - before.alpha).cwiseAbs().maxCoeff() < 1e-4);
  CHECK((s.contact_wrenches - before.contact_wrenches).cwiseAbs().maxCoeff() < 1.0);
}

TEST_CASE("trials and settings that do not fit are refused by name") {
  const Leg leg;
  TrialInput input = squat(leg.model);
  TrialSimulationSettings settings;
  settings.extrapolation = 3;
  CHECK_THROWS_WITH_AS(leg.simulate(input, settings),
                       "trial simulation settings: extrapolation is 3: must be 0, 1 or 2",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      leg.simulate(input, {}, TimeFrames::Zero(2, 5)),
      "trial: starts has shape (2, 5); it must be (1, 5) or (13, 5) (time frames, force-dependent "
      "coordinates)",
      std::invalid_argument);
  input.q(4, test::kFlexion) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(leg.simulate(input), doctest::Contains("time frame 4: "),
                       std::invalid_argument);
  input.qd.resize(2, 2);
  CHECK_THROWS_WITH_AS(leg.simulate(input), doctest::Contains("trial: qd has shape (2, 2)"),
                       std::invalid_argument);
}
