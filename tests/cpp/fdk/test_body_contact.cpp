// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <numeric>
#include <stdexcept>
#include <string>

#include "condyle/fdk/body_contact.hpp"
#include "fdk/leg_model.hpp"
#include "support/random_model.hpp"
#include "support/random_pose.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// A wrench linear in the pose, whatever the pose: no kink, no lift-off, no symmetry.
class LinearContact : public contact::ContactModel {
 public:
  explicit LinearContact(std::uint64_t seed) {
    test::Draw draw(seed);
    for (int s = 0; s < kSides; ++s) {
      wrench_[s] = test::general_wrench(draw);
      for (int i = 0; i < 36; ++i) stiffness_[s].data()[i] = draw(-2000.0, 2000.0);
    }
  }
  SideOfBody side_of_body() const override { return SideOfBody::kRight; }
  contact::ContactLoads evaluate(const Pose& pose,
                                 contact::Derivatives derivatives) const override {
    contact::ContactLoads loads;
    for (int s = 0; s < kSides; ++s) {
      loads.wrench[s] = wrench_[s] + stiffness_[s] * pose;
      if (derivatives == contact::Derivatives::kStiffness) loads.stiffness[s] = stiffness_[s];
    }
    return loads;
  }

 private:
  Wrench wrench_[kSides];
  Matrix6 stiffness_[kSides];
};

std::string message_of(const BodyContactDescription& description) {
  const model::Model model(test::leg_model_description());
  try {
    const BodyContact contact(model, description);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

// Bodies on different branches of a general tree, so that both move and share some of their axes.
struct Scene {
  model::Model model{test::random_model(31)};
  LinearContact law{7};
  std::vector<int> columns;
  BodyContactDescription description;
  Eigen::VectorXd q;

  Scene() {
    test::Draw draw(5);
    for (int c = 0; c < model.n_coordinates(); ++c) {
      if (!model.dependent(c)) columns.push_back(c);
    }
    description = {
        "pair", &law, "foot", "arm", test::thigh_F(), test::shank_T(), SideOfBody::kRight};
    q.resize(model.n_coordinates());
    for (int c = 0; c < q.size(); ++c) q[c] = draw(-0.5, 0.5);
  }
};

}  // namespace

TEST_CASE("generalised forces do the work of the contact's wrench on the pose [power]") {
  Scene scene;
  model::Kinematics kinematics(scene.model);
  kinematics.set(scene.q);
  BodyContact contact(scene.model, scene.description, scene.columns);
  contact.evaluate(kinematics, contact::Derivatives::kNone);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(scene.q.size());
  contact.add_force(kinematics, tau);
  Eigen::MatrixXd rates(6, scene.columns.size());
  contact.pose_derivative(kinematics, rates);
  const Vector6 Q = generalised_force(contact.pose(), contact.loads().total_wrench());
  for (std::size_t i = 0; i < scene.columns.size(); ++i) {
    const double power = Q.dot(rates.col(static_cast<Eigen::Index>(i)));
    // Sums of some ten products of 1e3 N: 1e-12 of them.
    CHECK(tau[scene.columns[i]] == doctest::Approx(power).epsilon(1e-11).scale(1e3));
  }
}

TEST_CASE(
    "pose derivative and stiffness are those of differences, couplings and branches included") {
  Scene scene;
  model::Kinematics kinematics(scene.model);
  const auto n = static_cast<Eigen::Index>(scene.q.size());
  BodyContact contact(scene.model, scene.description, scene.columns);
  const auto at = [&](const Eigen::VectorXd& q) {
    kinematics.set(q);
    contact.evaluate(kinematics, contact::Derivatives::kStiffness);
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
    contact.add_force(kinematics, tau);
    return std::pair(contact.pose(), tau);
  };
  const double h = 1e-6;
  at(scene.q);
  Eigen::MatrixXd rates(6, scene.columns.size()),
      stiffness = Eigen::MatrixXd::Zero(n, scene.columns.size());
  contact.pose_derivative(kinematics, rates);
  contact.add_stiffness(kinematics, stiffness);
  const double scale = stiffness.cwiseAbs().maxCoeff();
  REQUIRE(scale > 100.0);
  for (std::size_t i = 0; i < scene.columns.size(); ++i) {
    CAPTURE(i);
    Eigen::VectorXd q = scene.q;
    q[scene.columns[i]] += h;
    const auto [pose_ahead, tau_ahead] = at(q);
    q[scene.columns[i]] -= 2 * h;
    const auto [pose_behind, tau_behind] = at(q);
    const auto column = static_cast<Eigen::Index>(i);
    // Rounding ε/h = 2e-10 of the values and h² of the third derivatives, which are of the values'
    // size.
    CHECK(((pose_ahead - pose_behind) / (2 * h) - rates.col(column)).cwiseAbs().maxCoeff() < 2e-9);
    CHECK(((tau_ahead - tau_behind) / (2 * h) - stiffness.col(column)).cwiseAbs().maxCoeff() <
          2e-8 * scale);
  }
}

TEST_CASE("a softer contact is its loads times the share") {
  Scene scene;
  model::Kinematics kinematics(scene.model);
  kinematics.set(scene.q);
  BodyContact contact(scene.model, scene.description, scene.columns);
  contact.evaluate(kinematics, contact::Derivatives::kStiffness);
  const Wrench full = contact.loads().total_wrench();
  const Matrix6 stiffness = contact.loads().total_stiffness();
  contact.evaluate(kinematics, contact::Derivatives::kStiffness, 0.25);
  CHECK((contact.loads().total_wrench() - 0.25 * full).norm() < 1e-12 * full.norm());
  CHECK((contact.loads().total_stiffness() - 0.25 * stiffness).norm() < 1e-12 * stiffness.norm());
}

TEST_CASE("what cannot be meant is refused by name") {
  const test::AnalyticContact knee;
  test::KneeShape left_shape;
  left_shape.side_of_body = SideOfBody::kLeft;
  const test::AnalyticContact left(left_shape);
  BodyContactDescription description = test::leg_contact(knee);
  CHECK(message_of(description).empty());
  description.model = &left;
  CHECK(message_of(description) ==
        "contact 'tibiofemoral': the contact model is of a left knee; the joint is on the right: "
        "mirror the implant, "
        "or place the contact on the other side");
  description = test::leg_contact(knee);
  description.fixed_body = "patella";
  CHECK(message_of(description).find("contact 'tibiofemoral': fixed_body: ") == 0);
  CHECK(message_of(description).find("'patella'") != std::string::npos);
  description.fixed_body = "thigh";
  CHECK(message_of(description) ==
        "contact 'tibiofemoral': moving_body and fixed_body are both 'thigh'");
  description = test::leg_contact(knee);
  description.X_BT.R(0, 1) += 0.01;
  CHECK(message_of(description) == "contact 'tibiofemoral': X_BT.R is not a rotation");
  description.model = nullptr;
  CHECK(message_of(description) == "contact 'tibiofemoral': no contact model");
}
