// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <numeric>

#include "condyle/model/spring.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

// One spring on a free coordinate, one on a coordinate that follows two couplings on, one on what
// that follows.
ModelDescription description() {
  ModelDescription d = test::random_model(31);
  d.springs = {{"q6", 31.0, 0.17, 2.3}, {"q10", 47.0, -0.21, 0.9}, {"q3", 11.0, 0.05, 0.7}};
  return d;
}

}  // namespace

TEST_CASE(
    "a spring pulls to its rest, a damper against the rate; nothing else feels them "
    "[property]") {
  const Model model(description());
  Kinematics kinematics(model);
  test::Draw draw(32);
  const test::Motion motion(draw, model.n_coordinates());
  kinematics.set(motion.q(0.2), motion.qd(0.2), motion.qdd(0.2));
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(model.n_coordinates());
  add_spring_force(kinematics, tau);
  const int q6 = model.coordinate("q6");
  CHECK(tau[q6] ==
        doctest::Approx(-31.0 * (kinematics.q()[q6] - 0.17) - 2.3 * kinematics.qd()[q6]));
  for (int c = 0; c < model.n_coordinates(); ++c) {
    if (c != q6 && c != model.coordinate("q3")) CHECK(tau[c] == 0.0);
  }
  // What a coupling carries over does the same work: power of the springs at their own coordinates.
  double power = 0.0;
  for (const ModelSpring& s : model.springs()) {
    const double q = kinematics.q()[s.coordinate], qd = kinematics.qd()[s.coordinate];
    power += (-s.stiffness * (q - s.rest) - s.viscosity * qd) * qd;
  }
  CHECK(tau.dot(kinematics.qd()) == doctest::Approx(power).epsilon(1e-12));
}

TEST_CASE("the springs' derivative is that of their force [derivative]") {
  const Model model(description());
  const int n = model.n_coordinates();
  Kinematics kinematics(model);
  test::Draw draw(33);
  const test::Motion motion(draw, n);
  const Eigen::VectorXd q = motion.q(0.4), qd = motion.qd(0.4), qdd = motion.qdd(0.4);
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  kinematics.set(q, qd, qdd);
  Eigen::MatrixXd derivative = Eigen::MatrixXd::Zero(n, n);
  add_spring_force_derivative(kinematics, all, derivative);
  const double h = 1e-6;
  for (int c = 0; c < n; ++c) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, c);
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(n), down = difference;
    kinematics.set(q + step, qd, qdd);
    add_spring_force(kinematics, difference);
    kinematics.set(q - step, qd, qdd);
    add_spring_force(kinematics, down);
    difference = (difference - down) / (2 * h);
    // Rounding: eps·50/h; h² times a third derivative of some 1e3.
    CHECK((difference - derivative.col(c)).norm() < 1e-7);
  }
  CHECK(derivative(model.coordinate("q3"), model.coordinate("q3")) != 0.0);
}
