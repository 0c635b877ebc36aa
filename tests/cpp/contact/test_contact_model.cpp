// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "condyle/contact/contact_model.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::contact;

namespace {

/// Loads that tell which pose they belong to.
class Echo final : public ContactModel {
 public:
  SideOfBody side_of_body() const override { return SideOfBody::kLeft; }
  ContactLoads evaluate(const Pose& pose, Derivatives derivatives) const override {
    require_finite(pose);
    ContactLoads loads;
    loads.wrench = {2.0 * pose, -0.5 * pose};
    loads.implausible_depth = pose[kY] < 0.0;
    if (derivatives == Derivatives::kStiffness) loads.stiffness[kLateral] = pose * pose.transpose();
    return loads;
  }
};

std::vector<Pose> some_poses() {
  test::Draw draw(3);
  std::vector<Pose> poses;
  for (int i = 0; i < 50; ++i) poses.push_back(test::general_pose(draw));
  return poses;
}

}  // namespace

TEST_CASE("a batch holds each pose's own loads, in order, for any number of threads") {
  const Echo model;
  const auto poses = some_poses();
  for (const int threads : {1, 3, 0}) {
    std::vector<ContactLoads> loads(poses.size());
    model.evaluate_batch(poses, Derivatives::kStiffness, threads, loads);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      CHECK(loads[i].total_wrench() == 2.0 * poses[i] - 0.5 * poses[i]);
      CHECK(loads[i].total_stiffness() == Matrix6(poses[i] * poses[i].transpose()));
    }
  }
}

TEST_CASE("a batch's mistakes are named: its size, and the row and coordinate of a pose") {
  const Echo model;
  auto poses = some_poses();
  std::vector<ContactLoads> loads(poses.size() - 1);
  CHECK_THROWS_WITH_AS(model.evaluate_batch(poses, Derivatives::kNone, 1, loads),
                       "evaluate_batch: 49 results for 50 poses", std::invalid_argument);
  loads.resize(poses.size());
  poses[7][kZ] = std::numeric_limits<double>::infinity();
  poses[31][kX] = std::numeric_limits<double>::quiet_NaN();
  for (const int threads : {1, 3}) {
    CHECK_THROWS_WITH_AS(model.evaluate_batch(poses, Derivatives::kNone, threads, loads),
                         "row 7: pose: z is inf: must be finite", std::invalid_argument);
  }
}

TEST_CASE("arrays hold what a batch gives, row by row, for any number of threads") {
  const Echo model;
  const auto poses = some_poses();
  const std::size_t n = poses.size();
  std::vector<ContactLoads> loads(n);
  model.evaluate_batch(poses, Derivatives::kStiffness, 1, loads);
  for (const int threads : {1, 3, 0}) {
    std::vector<double> wrench(n * 12, -1.0), stiffness(n * 72, -1.0), error(n * 12, -1.0),
        trust(n);
    const auto implausible = std::make_unique<bool[]>(n);
    model.evaluate_into(poses, threads, {wrench, stiffness, error, trust, {implausible.get(), n}});
    for (std::size_t i = 0; i < n; ++i) {
      for (const Side side : {kMedial, kLateral}) {
        const std::size_t row = 2 * i + static_cast<std::size_t>(side);
        CHECK(Eigen::Map<const Wrench>(&wrench[6 * row]) == loads[i].wrench[side]);
        CHECK(Eigen::Map<const Matrix6>(&stiffness[36 * row]) == loads[i].stiffness[side]);
        CHECK(Eigen::Map<const Wrench>(&error[6 * row]).isZero());
      }
      CHECK(trust[i] == 1.0);
      CHECK(implausible[i] == (poses[i][kY] < 0.0));
    }
  }
}

TEST_CASE("arrays: what is not asked for is not written, what does not fit is refused by name") {
  const Echo model;
  auto poses = some_poses();
  std::vector<double> wrench(600), stiffness(72);
  model.evaluate_into(poses, 1, {.wrench = wrench});
  CHECK(Eigen::Map<const Wrench>(&wrench[12 * 49]) == 2.0 * poses[49]);
  CHECK_THROWS_WITH_AS(model.evaluate_into(poses, 1, {.wrench = wrench, .stiffness = stiffness}),
                       "evaluate_into: stiffness has 72 values: 50 poses need 3600",
                       std::invalid_argument);
  poses[7][kZ] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH_AS(model.evaluate_into(poses, 3, {.wrench = wrench}),
                       "row 7: pose: z is inf: must be finite", std::invalid_argument);
}
