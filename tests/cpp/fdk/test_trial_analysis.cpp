// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/trial_analysis.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "support/forearm_model.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

constexpr Eigen::Index kFrames = 71;  // more than one chunk, and not a multiple of it

TrialInput swinging() {
  TrialInput input;
  for (TimeFrames* table : {&input.q, &input.qd, &input.qdd}) table->resize(kFrames, 1);
  for (Eigen::Index i = 0; i < kFrames; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    input.q(i, 0) = 0.3 + 0.6 * std::sin(5 * t);
    input.qd(i, 0) = 3.0 * std::cos(5 * t);
    input.qdd(i, 0) = -15.0 * std::sin(5 * t);
  }
  return input;
}

std::string message_of(const TrialInput& input, const TrialParts& parts = {}) {
  const model::Model model(test::forearm_model());
  try {
    analyse_trial(model, input, {}, parts, 1);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("every time frame is what the frame alone gives, for any number of threads") {
  const model::Model model(test::forearm_model());
  const TrialInput input = swinging();
  const TrialAnalysis serial = analyse_trial(model, input, {}, {}, 1);
  const TrialAnalysis parallel = analyse_trial(model, input, {}, {}, 3);
  CHECK(serial.muscle_forces == parallel.muscle_forces);
  CHECK(serial.generalised_forces == parallel.generalised_forces);
  CHECK(serial.segment_poses == parallel.segment_poses);

  MusculoskeletalFrame frame(model, {});
  const Eigen::Index row = 47;
  frame.set_motion(input.q.row(row).transpose(), input.qd.row(row).transpose(),
                   input.qdd.row(row).transpose());
  frame.compute_dynamics({});
  frame.compute_muscles();
  frame.compute_ligaments();
  REQUIRE(frame.recruit().converged());
  CHECK(serial.muscle_forces.row(row) == frame.muscle_forces().transpose());
  CHECK(serial.muscle_lengths(row, 1) == frame.muscles()[1].length);
  CHECK(serial.moment_arms(row, 1) == frame.moment_arms()(0, 1));
  CHECK(serial.status[47] == recruitment::RecruitmentStatus::kConverged);
  CHECK(serial.kkt[47] < 1e-9);
  // R_GB row by row, then the origin.
  CHECK(serial.segment_poses(row, 0) == doctest::Approx(std::cos(input.q(row, 0))).epsilon(1e-15));
  CHECK(serial.segment_poses(row, 3) == doctest::Approx(std::sin(input.q(row, 0))).epsilon(1e-15));
}

TEST_CASE("work of the generalised forces is the change of energy [conservation]") {
  const model::Model model(test::forearm_model());
  const TrialInput input = swinging();
  const TrialAnalysis found = analyse_trial(model, input, {}, {.recruitment = false}, 1);
  double work = 0.0;  // Simpson's rule: h⁴ · f''''/180 · T ≈ 1e-8 · 2e4/180 · 0.7 J
  for (Eigen::Index i = 0; i + 2 < kFrames; i += 2) {
    const auto power = [&](Eigen::Index k) { return found.generalised_forces(k, 0) * input.qd(k, 0); };
    work += 0.01 / 3.0 * (power(i) + 4 * power(i + 1) + power(i + 2));
  }
  const auto energy = [&](Eigen::Index i) {
    const double qd = input.qd(i, 0);
    return 0.5 * (0.02 + 1.5 * 0.0144) * qd * qd + 1.5 * 9.80665 * 0.12 * std::sin(input.q(i, 0));
  };
  CHECK(std::abs(work - (energy(kFrames - 1) - energy(0))) < 2e-6);
}

TEST_CASE("parts that were not asked for have no rows") {
  const model::Model model(test::forearm_model());
  const TrialAnalysis found =
      analyse_trial(model, swinging(), {}, {.dynamics = false, .ligaments = false, .recruitment = false}, 2);
  CHECK(found.muscle_lengths.rows() == kFrames);
  CHECK(found.generalised_forces.size() == 0);
  CHECK(found.ligament_forces.size() == 0);
  CHECK(found.status.empty());
}

TEST_CASE("shapes, gaps and parts that do not fit are refused by name") {
  TrialInput input = swinging();
  input.qd.resize(kFrames, 2);
  CHECK(message_of(input) ==
        "model 'forearm': qd has 71 × 2 values; it must have 71 time frames × 1 coordinates");
  input = swinging();
  input.loads.resize(3);
  CHECK(message_of(input).find("external loads of 3 time frames for 71 of motion") != std::string::npos);
  input = swinging();
  input.q(40, 0) = std::numeric_limits<double>::quiet_NaN();
  CHECK(message_of(input).find("time frame 40: ") == 0);
  CHECK(message_of(input).find("elbow") != std::string::npos);
  CHECK(message_of(swinging(), {.muscles = false}).find("recruitment needs") != std::string::npos);
  model::PathSnapshots snapshots;
  snapshots.times = {0.0};
  input = swinging();
  input.snapshots = &snapshots;
  CHECK(message_of(input).find("snapshot_rows has 0 values") != std::string::npos);
  input.snapshot_rows.assign(kFrames, 1);
  CHECK(message_of(input).find("snapshot_rows holds 1; the snapshots have 1 times") != std::string::npos);
}
