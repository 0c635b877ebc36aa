// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <limits>
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
