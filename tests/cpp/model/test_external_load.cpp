// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <numeric>

#include "condyle/model/external_load.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

ExternalLoad random_load(test::Draw& draw, int body) {
  return {body, test::random_vector(draw, 90.0), test::random_vector(draw, 1.0),
          test::random_vector(draw, 20.0)};
}

}  // namespace

TEST_CASE("a load's generalised force has its power, through splines and couplings [property]") {
  const Model model(test::random_model(41));
  Kinematics kinematics(model);
  test::Draw draw(42);
  const test::Motion motion(draw, model.n_coordinates());
  kinematics.set(motion.q(0.2), motion.qd(0.2), motion.qdd(0.2));
  for (int b = 0; b < model.n_bodies(); ++b) {
    const ExternalLoad load = random_load(draw, b);
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(model.n_coordinates());
    add_generalised_force(kinematics, load, tau);
    const double power = load.force_G.dot(kinematics.point_velocity(b, load.point_G)) +
                         load.moment_G.dot(kinematics.twist(b).w);
    CHECK(tau.dot(kinematics.qd()) == doctest::Approx(power).epsilon(1e-12));
    CHECK(tau[model.coordinate("q10")] == 0.0);
    // Added, not set; and the same by parts.
    add_generalised_force(kinematics, b, -load.force_G, load.point_G, -load.moment_G, tau);
    CHECK(tau.norm() < 1e-12);
  }
}

TEST_CASE("a load on ground is worth nothing [property]") {
  const Model model(test::random_model(43));
  Kinematics kinematics(model);
  test::Draw draw(44);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(model.n_coordinates());
  add_generalised_force(kinematics, random_load(draw, -1), tau);
  CHECK(tau.norm() == 0.0);
}

TEST_CASE(
    "the geometric stiffness of a load is the derivative of its generalised force "
    "[derivative]") {
  test::Draw draw(45);
  for (std::uint64_t seed : {46, 47}) {
    const Model model(test::random_model(seed));
    const int n = model.n_coordinates();
    Kinematics kinematics(model);
    const test::Motion motion(draw, n);
    const Eigen::VectorXd q = motion.q(0.3);
    std::vector<int> all(static_cast<std::size_t>(n));
    std::iota(all.rbegin(), all.rend(), 0);
    for (const char* body : {"boot", "patella"}) {
      const ExternalLoad load = random_load(draw, model.body(body));
      kinematics.set(q);
      Eigen::MatrixXd derivative = Eigen::MatrixXd::Zero(n, n);
      add_generalised_force_derivative(kinematics, load, all, derivative);
      CHECK(derivative.norm() > 1.0);
      const double h = 1e-6;
      for (int column = 0; column < n; ++column) {
        const int c = all[static_cast<std::size_t>(column)];
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, c);
        Eigen::VectorXd difference = Eigen::VectorXd::Zero(n), down = difference;
        kinematics.set(q + step);
        add_generalised_force(kinematics, load, difference);
        kinematics.set(q - step);
        add_generalised_force(kinematics, load, down);
        difference = (difference - down) / (2 * h);
        // Rounding: eps·300/h; h² times a third derivative of some 1e4.
        CHECK((difference - derivative.col(column)).norm() < 1e-6);
      }
    }
  }
}
