// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/model/screw.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

Screw random_screw(test::Draw& draw) {
  return {test::random_vector(draw, 2.0), test::random_vector(draw, 3.0)};
}

// A few products of numbers of size 20.
constexpr double kRounding = 1e-13;

}  // namespace

TEST_CASE("the product of twists is a commutator and obeys Jacobi's identity [property]") {
  test::Draw draw(21);
  const Screw A = random_screw(draw), B = random_screw(draw), C = random_screw(draw);
  Screw sum = cross(A, B);
  sum += cross(B, A);
  CHECK(sum.w.norm() + sum.v.norm() < kRounding);
  sum = cross(A, cross(B, C));
  sum += cross(B, cross(C, A));
  sum += cross(C, cross(A, B));
  CHECK(sum.w.norm() + sum.v.norm() < kRounding);
}

TEST_CASE("power does not change when twist and wrench are carried along together [property]") {
  test::Draw draw(22);
  const Screw A = random_screw(draw), S = random_screw(draw);
  const ForceScrew F{test::random_vector(draw, 2.0), test::random_vector(draw, 3.0)};
  CHECK(std::abs(power(S, F)) > 0.1);
  CHECK(std::abs(power(cross(A, S), F) + power(S, cross(A, F))) < kRounding);
}

TEST_CASE(
    "a turn's screw moves points on its line nowhere; a force's power is force times velocity "
    "[property]") {
  test::Draw draw(23);
  AxisNow axis{true, test::random_vector(draw, 1.0).normalized(), test::random_vector(draw, 2.0)};
  const Screw turn = axis_screw(axis);
  CHECK((turn.v + turn.w.cross(axis.point + 0.7 * axis.direction)).norm() < kRounding);
  const Vector3 f = test::random_vector(draw, 3.0), p = test::random_vector(draw, 1.0),
                m = test::random_vector(draw, 2.0);
  const ForceScrew F = wrench_at_origin(f, p, m);
  CHECK(power(turn, F) ==
        doctest::Approx(f.dot(turn.v + turn.w.cross(p)) + m.dot(turn.w)).epsilon(1e-12));
  axis.rotational = false;
  CHECK(power(axis_screw(axis), F) == doctest::Approx(f.dot(axis.direction)).epsilon(1e-12));
}
