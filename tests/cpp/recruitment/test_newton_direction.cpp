// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/newton_direction.hpp"

#include <doctest/doctest.h>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;
using Method = NewtonDirection::Method;

TEST_CASE("both methods solve the system that they say") {
  const auto p = random_problem(21, true, false);
  ScaledProblem s(p.setup, {});
  s.set_frame(p.frame(), true);
  condyle::test::Draw draw(22);
  Vector D(s.m), E(s.n), r(s.n);
  for (int i = 0; i < s.m; ++i) D[i] = i % 3 == 0 ? 0.0 : draw(0.2, 5.0);
  for (int j = 0; j < s.n; ++j) {
    E[j] = draw(0.1, 2.0);
    r[j] = draw(-1.0, 1.0);
  }
  const Vector usual = Vector::Constant(s.n, 1.3);
  const double shift = 0.37;
  const Eigen::MatrixXd H = Eigen::MatrixXd(s.A * D.asDiagonal() * s.A.transpose()) +
                            Eigen::MatrixXd((s.reserve.cwiseAbs2().cwiseProduct(E) + shift * usual).asDiagonal());
  for (Method method : {Method::kNormal, Method::kGraded}) {
    NewtonDirection direction(s.n, s.m, method);
    REQUIRE(direction.factorise(s, D, E, usual, shift));
    Vector step(s.n), dz(s.m);
    direction.solve(r, step, dz);
    // The normal method shifts the diagonal by 1e-13 of itself.
    CHECK((H * step - r).norm() <= 1e-11);
    CHECK((s.A.transpose() * step - dz).norm() <= 1e-12);
  }
}

TEST_CASE("the graded method is right for muscles that the others drown [regression]") {
  const auto p = random_problem(23, false, false, 4, 12);
  ScaledProblem s(p.setup, {});
  s.set_frame(p.frame(), true);
  Vector D = Vector::Ones(s.m);
  D[5] = 1e18;  // a muscle whose slope is that of p = 5 at x = 1e-6
  Vector r = Vector::Constant(s.n, 0.5), step(s.n), dz(s.m);
  const Vector none = Vector::Zero(s.n), usual = Vector::Ones(s.n);
  NewtonDirection direction(s.n, s.m, Method::kGraded);
  REQUIRE(direction.factorise(s, D, none, usual, 1e-30));
  direction.solve(r, step, dz);
  // What all muscles together give is what is asked for, though D spreads over 18 digits.
  CHECK((s.A * D.cwiseProduct(dz) - r).norm() <= 1e-12);
  CHECK(dz[5] != 0.0);
}

TEST_CASE("a coordinate that no free muscle moves is not regular") {
  const auto p = random_problem(24, false, false);
  ScaledProblem s(p.setup, {});
  s.set_frame(p.frame(), true);
  const Vector none = Vector::Zero(s.n), usual = Vector::Ones(s.n);
  for (Method method : {Method::kNormal, Method::kGraded}) {
    NewtonDirection direction(s.n, s.m, method);
    Vector D = Vector::Ones(s.m);
    REQUIRE(direction.factorise(s, D, none, usual, 1e-14));
    CHECK(direction.regular(usual, 1e-14));
    for (int i = 0; i < s.m; ++i) D[i] = s.A(2, i) == 0.0 ? 1.0 : 0.0;
    direction.factorise(s, D, none, usual, 1e-14);
    CHECK(!direction.regular(usual, 1e-14));
  }
}
