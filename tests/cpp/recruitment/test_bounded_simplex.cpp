// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/bounded_simplex.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "support/random_pose.hpp"

using namespace condyle::recruitment;
using Outcome = BoundedSimplex::Outcome;

namespace {

LinearProgram random_program(std::uint64_t seed, int n, int k) {
  condyle::test::Draw draw(seed);
  LinearProgram p(n, k);
  Vector inside(k);
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) p.G(j, i) = draw(-1.0, 1.0);
    p.cost[i] = draw(0.1, 2.0);
    p.lower[i] = i % 5 == 0 ? 0.05 : 0.0;
    p.upper[i] = i % 7 == 0 ? std::numeric_limits<double>::infinity() : draw(0.3, 1.2);
    inside[i] = p.lower[i] + draw(0.0, 0.2);
  }
  p.b = p.G * inside;
  return p;
}

}  // namespace

TEST_CASE("the optimum has an equal dual [property]") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto p = random_program(seed, 5, 23);
    BoundedSimplex simplex(5, 23);
    REQUIRE(simplex.solve(p) == Outcome::kOptimal);
    const Vector& v = simplex.values;
    CHECK((p.G * v - p.b).norm() <= 1e-12);
    CHECK((v - p.lower).minCoeff() >= -1e-11);
    CHECK((p.upper - v).minCoeff() >= -1e-11);
    // Weak duality: no solution is cheaper than this.
    const Vector reduced = p.cost - p.G.transpose() * simplex.multipliers;
    double dual = p.b.dot(simplex.multipliers);
    for (int i = 0; i < 23; ++i) {
      if (reduced[i] > 0.0) dual += reduced[i] * p.lower[i];
      if (reduced[i] < -1e-11) dual += reduced[i] * p.upper[i];
    }
    CHECK(dual == doctest::Approx(p.cost.dot(v)).epsilon(1e-9));
  }
}

TEST_CASE("infeasible: the multipliers prove it, and the violation is the least [property]") {
  auto p = random_program(3, 4, 11);
  for (int i = 0; i < 11; ++i) p.upper[i] = std::min(p.upper[i], 1.5);
  p.b[2] += 40.0;
  BoundedSimplex simplex(4, 11);
  REQUIRE(simplex.solve(p) == Outcome::kInfeasible);
  const Vector z = p.G.transpose() * simplex.multipliers;
  double proof = p.b.dot(simplex.multipliers);
  for (int i = 0; i < 11; ++i) proof -= z[i] * (z[i] > 0.0 ? p.upper[i] : p.lower[i]);
  CHECK(proof > 1.0);
  CHECK(proof == doctest::Approx(simplex.infeasibility).epsilon(1e-10));
}

TEST_CASE("a degenerate program ends: Beale's example cycles without a rule against it") {
  LinearProgram p(3, 7);
  p.G << 0.25, -60.0, -0.04, 9.0, 1.0, 0.0, 0.0,  //
      0.5, -90.0, -0.02, 3.0, 0.0, 1.0, 0.0,      //
      0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0;
  p.b << 0.0, 0.0, 1.0;
  p.cost << -0.75, 150.0, -0.02, 6.0, 0.0, 0.0, 0.0;
  p.upper.setConstant(std::numeric_limits<double>::infinity());
  BoundedSimplex simplex(3, 7);
  REQUIRE(simplex.solve(p) == Outcome::kOptimal);
  CHECK(p.cost.dot(simplex.values) == doctest::Approx(-0.05).epsilon(1e-12));
}

TEST_CASE("from its own basis it takes no step") {
  auto p = random_program(9, 5, 23);
  BoundedSimplex simplex(5, 23);
  REQUIRE(simplex.solve(p) == Outcome::kOptimal);
  const Vector first = simplex.values;
  REQUIRE(simplex.iterations > 0);
  REQUIRE(simplex.solve(p) == Outcome::kOptimal);
  CHECK(simplex.iterations == 0);
  CHECK((simplex.values - first).norm() <= 1e-13);
}
