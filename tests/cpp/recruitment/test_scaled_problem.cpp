// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/scaled_problem.hpp"

#include <doctest/doctest.h>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;

TEST_CASE("scaled forces meet scaled loads where forces meet loads [property]") {
  const auto p = random_problem(11, true, true);
  const RecruitmentSettings settings;
  ScaledProblem s(p.setup, settings);
  s.set_frame(p.frame(), true);
  condyle::test::Draw draw(12);
  Vector f(s.m), e(s.n);
  for (int i = 0; i < s.m; ++i) f[i] = draw(0.0, 1.0) * p.strengths[i];
  for (int j = 0; j < s.n; ++j) e[j] = p.setup.reserve_strengths[j] > 0.0 ? draw(-9.0, 9.0) : 0.0;
  const Vector off = p.loads - p.moment_arms * f - e;
  const Vector x = f.cwiseQuotient(p.strengths) / s.load_scale;
  Vector y = Vector::Zero(s.n);
  for (int j = 0; j < s.n; ++j) {
    if (p.setup.reserve_strengths[j] > 0.0) y[j] = e[j] / p.setup.reserve_strengths[j] / s.load_scale;
  }
  const Vector scaled = s.b - s.A * x - s.reserve.cwiseProduct(y);
  for (int j = 0; j < s.n; ++j) {
    // Sums of some 20 terms of up to 180 Nm.
    CHECK(scaled[j] * s.load_scale / s.row_scale[j] == doctest::Approx(off[j]).epsilon(1e-11));
    CHECK(s.A.row(j).cwiseAbs().maxCoeff() == doctest::Approx(1.0));
  }
  CHECK(s.b.cwiseAbs().maxCoeff() <= 1.0 + 1e-15);
  CHECK((s.upper * s.load_scale).isApproxToConstant(1.0, 1e-14));
}

TEST_CASE("a muscle of zero strength has no room") {
  auto p = random_problem(13, false, false);
  p.strengths[6] = 0.0;
  ScaledProblem s(p.setup, {});
  for (bool bounds : {true, false}) {
    s.set_frame(p.frame(), bounds);
    CHECK(s.upper[6] == 0.0);
    CHECK(s.upper[7] > 0.0);
  }
}
