// SPDX-License-Identifier: Apache-2.0
// What is evaluated at every time frame allocates nothing.

// GCC 12 inlines the counting operator delete but not its operator new, and takes them for a
// mismatched pair.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
#endif

#include <doctest/doctest.h>

#include "condyle/model/inverse_dynamics.hpp"
#include "condyle/model/spring.hpp"
#include "support/count_allocations.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

TEST_CASE("kinematics, inverse dynamics, its derivative and springs allocate nothing [property]") {
  CHECK(test::count_allocations([] { std::vector<double>(7).front() += 1.0; }) == 1);
  ModelDescription d = test::random_model(71);
  d.springs.push_back({"q10", 31.0, 0.17, 2.3});
  const Model model(d);
  const int n = model.n_coordinates();
  test::Draw draw(72);
  const test::Motion motion(draw, n);
  const Eigen::VectorXd q = motion.q(0.1), qd = motion.qd(0.1), qdd = motion.qdd(0.1);
  const std::vector<ExternalLoad> loads(
      2, {model.body("boot"), {1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}, Vector3::Zero()});
  const std::vector<int> chosen{0, 3, 7};
  Kinematics kinematics(model);
  InverseDynamics dynamics(model);
  Eigen::MatrixXd derivative(n, 3);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
  CHECK(test::count_allocations([&] {
          kinematics.set(q, qd, qdd);
          dynamics.compute(kinematics, loads);
          dynamics.derivative(kinematics, chosen, derivative);
          add_generalised_force(kinematics, loads[0], tau);
          add_generalised_force_derivative(kinematics, loads[0], chosen, derivative);
          add_spring_force(kinematics, tau);
          add_spring_force_derivative(kinematics, chosen, derivative);
          kinematics.set(q);
        }) == 0);
  CHECK(tau.norm() > 0.0);
}
