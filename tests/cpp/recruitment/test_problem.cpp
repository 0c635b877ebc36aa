// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/problem.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "random_problem.hpp"

using namespace condyle::recruitment;
using condyle::test::random_problem;

namespace {

void names(RecruitmentSetup& setup) {
  for (int j = 0; j < setup.coordinates; ++j) setup.coordinate_names.push_back("angle_" + std::to_string(j));
  for (int i = 0; i < setup.muscles; ++i) setup.muscle_names.push_back("strap_" + std::to_string(i));
}

}  // namespace

TEST_CASE("a wrong setup is refused by field, value and limit [error]") {
  auto p = random_problem(3, true, false);
  names(p.setup);
  const RecruitmentSettings settings;
  require_valid(p.setup, settings);
  auto wrong = p.setup;
  wrong.weights[5] = 0.0;
  CHECK_THROWS_WITH_AS(require_valid(wrong, settings),
                       "recruitment: weight of strap_5 = 0: must be finite and more than 0", std::invalid_argument);
  wrong = p.setup;
  wrong.reserve_prices[2] = -1.5;
  CHECK_THROWS_WITH_AS(require_valid(wrong, settings),
                       "recruitment: reserve price of angle_2 = -1.5: must be finite and more than 0",
                       std::invalid_argument);
  wrong = p.setup;
  wrong.weights.conservativeResize(4);
  CHECK_THROWS_WITH_AS(require_valid(wrong, settings), "recruitment: size of weights = 4: must be 43",
                       std::invalid_argument);
  RecruitmentSettings bad;
  bad.criterion.exponent = 0.5;
  CHECK_THROWS_WITH_AS(require_valid(p.setup, bad), "recruitment: exponent = 0.5: must be finite and at least 1",
                       std::invalid_argument);
}

TEST_CASE("a wrong time frame is refused by muscle and coordinate [error]") {
  auto p = random_problem(4, false, true);
  names(p.setup);
  const RecruitmentSettings settings;
  require_valid(p.frame(), p.setup, settings);
  auto wrong = p;
  wrong.strengths[7] = -2.0;
  CHECK_THROWS_WITH_AS(require_valid(wrong.frame(), p.setup, settings),
                       "recruitment: strength of strap_7 = -2: must be finite and at least 0", std::invalid_argument);
  wrong = p;
  wrong.moment_arms(2, 9) = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH_AS(require_valid(wrong.frame(), p.setup, settings),
                       "recruitment: moment arm of strap_9 about angle_2 = inf: must be finite", std::invalid_argument);
  wrong = p;
  wrong.loads[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(require_valid(wrong.frame(), p.setup, settings), std::invalid_argument);
  wrong = p;
  wrong.strengths[5] = 0.0;
  wrong.minima[5] = 3.0;
  CHECK_THROWS_WITH_AS(require_valid(wrong.frame(), p.setup, settings),
                       "recruitment: minimum of strap_5 = 3: must be at most its strength, 0", std::invalid_argument);
}

TEST_CASE("statuses have names and advice") {
  for (auto status : {RecruitmentStatus::kConverged, RecruitmentStatus::kInfeasible, RecruitmentStatus::kMaxIterations}) {
    CHECK(name(status) != "unknown");
    CHECK(!advice(status).empty());
  }
}
