// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/fdk/trial_results.hpp"
#include "fdk/leg_model.hpp"

using namespace condyle;
using namespace condyle::fdk;

TEST_CASE("a time frame is kept in its row, as it was solved, and nowhere else") {
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem(model, {}, {&contact, 1});
  TrialSimulation results = empty_results(model, problem, 3);
  CHECK(results.contact_names == std::vector<std::string>{"tibiofemoral"});
  CHECK(results.force_dependent.size() == 5);
  CHECK(results.q.rows() == 3);
  CHECK(results.contact_wrenches.cols() == 12);
  CHECK(results.muscle_forces.cols() ==
        static_cast<Eigen::Index>(model.description().muscles.size()));

  const FrameInstant instant = test::leg_instant(model, 0.35);
  const numerics::Unknowns start = numerics::Unknowns::Zero(5);
  results.records[1] = solve_force_dependent(problem, instant, {&start, 1});
  REQUIRE(results.records[1].converged());
  keep_time_frame(problem, 1, results);
  const MusculoskeletalFrame& frame = problem.frame();
  CHECK(results.q.row(1).transpose() == frame.kinematics().q());
  CHECK(results.alpha.row(1).transpose() == results.records[1].alpha);
  CHECK(results.contact_poses.row(1).transpose() == problem.contacts()[0].pose());
  CHECK(results.contact_wrenches(1, kY) == problem.contacts()[0].loads().wrench[kMedial][kY]);
  CHECK(results.contact_wrenches(1, 6 + kY) == problem.contacts()[0].loads().wrench[kLateral][kY]);
  CHECK(results.muscle_forces.row(1).transpose() == frame.muscle_forces());
  CHECK(results.ligament_forces.row(1).transpose() == frame.strand_loads().force);
  // R of the first body, row by row, then its origin.
  CHECK(results.segment_poses(1, 1) == frame.kinematics().X_GB(0).R(0, 1));
  CHECK(results.segment_poses(1, 9) == frame.kinematics().X_GB(0).p[0]);
  for (const Eigen::Index other : {0, 2}) {
    CHECK(results.q.row(other).isZero(0.0));
    CHECK(results.contact_wrenches.row(other).isZero(0.0));
  }
}

TEST_CASE("a summary counts, and names the first time frame that is not in equilibrium") {
  TrialSimulation results;
  results.records.resize(3);
  for (ForceDependentRecord& record : results.records) {
    record.status = ForceDependentStatus::kConverged;
  }
  CHECK(summary(results) == "3 of 3 time frames converged");
  results.records[1].message = "not converged: 3 N remain on tz";
  results.records[1].status = ForceDependentStatus::kNotConverged;
  results.not_converged = 1;
  results.untrusted = 2;
  CHECK(summary(results).find("2 of 3 time frames converged; in 2 a contact model does not trust") ==
        0);
  CHECK(summary(results).find("time frame 1: not converged: 3 N remain on tz") !=
        std::string::npos);
}
