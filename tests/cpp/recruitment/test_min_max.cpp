// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/min_max.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;

TEST_CASE("levels fall, and whoever is at one has it [property]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto p = random_problem(seed, seed % 2 == 0, seed % 3 == 0);
    ScaledProblem s(p.setup, {});
    s.set_frame(p.frame(), seed % 4 != 0);
    MinMax min_max(s.n, s.m);
    CAPTURE(seed);
    REQUIRE(min_max.solve(s) == MinMax::Outcome::kConverged);
    REQUIRE(!min_max.levels.empty());
    CHECK(std::is_sorted(min_max.levels.rbegin(), min_max.levels.rend()));
    CHECK((s.A * min_max.x + s.reserve.cwiseProduct(min_max.y) - s.b).norm() <= 1e-12);
    for (int i = 0; i < s.m; ++i) {
      const int what = min_max.held[static_cast<std::size_t>(i)];
      const double load = s.weight[i] * min_max.x[i];
      if (what >= 0) CHECK(load == doctest::Approx(min_max.levels[static_cast<std::size_t>(what)]));
      if (min_max.x[i] > s.lower[i] + 1e-12) CHECK(load <= min_max.levels[0] * (1.0 + 1e-12));
    }
  }
}

TEST_CASE("the multipliers prove that the first level cannot be lower [oracle]") {
  for (std::uint64_t seed = 50; seed < 70; ++seed) {
    const auto p = random_problem(seed, false, false);
    ScaledProblem s(p.setup, {});
    s.set_frame(p.frame(), false);
    MinMax min_max(s.n, s.m);
    REQUIRE(min_max.solve(s) == MinMax::Outcome::kConverged);
    // Any forces of levels ≤ t have bᵀλ = xᵀAᵀλ ≤ t Σ (Aᵀλ)₊/ŵ = t.
    const Vector z = s.A.transpose() * min_max.multipliers;
    CHECK(z.cwiseQuotient(s.weight).cwiseMax(0.0).sum() == doctest::Approx(1.0).epsilon(1e-10));
    CHECK(s.b.dot(min_max.multipliers) == doctest::Approx(min_max.levels[0]).epsilon(1e-10));
  }
}

TEST_CASE("two legs that share no muscle have each its own levels") {
  RecruitmentSetup setup;
  setup.coordinates = 2;
  setup.muscles = 4;
  RowMatrix R(2, 4);
  R << 0.04, 0.03, 0.0, 0.0, 0.0, 0.0, 0.05, 0.02;
  Vector N(4), loads(2);
  N << 900.0, 700.0, 800.0, 600.0;
  loads << 5.7, 26.0;
  ScaledProblem s(setup, {});
  s.set_frame({R, loads, N, Vector()}, true);
  MinMax min_max(2, 4);
  REQUIRE(min_max.solve(s) == MinMax::Outcome::kConverged);
  REQUIRE(min_max.levels.size() == 2);
  CHECK(min_max.levels[0] * s.load_scale == doctest::Approx(26.0 / (0.05 * 800.0 + 0.02 * 600.0)).epsilon(1e-13));
  CHECK(min_max.levels[1] * s.load_scale == doctest::Approx(5.7 / (0.04 * 900.0 + 0.03 * 700.0)).epsilon(1e-13));
}
