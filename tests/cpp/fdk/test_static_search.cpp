// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/static_search.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "fdk/analytic_contact.hpp"

using namespace condyle;
using namespace condyle::fdk;
using namespace condyle::fdk::detail;

namespace {

StaticLoad general_load() {
  StaticLoad load;
  load.x = 0.0043;
  load.z = -0.0012;
  load.theta_y = 0.043;
  load.theta_z = -0.37;
  load.Fy = 1180.0;
  load.Mx = 11.3;
  return load;
}

}  // namespace

TEST_CASE("y is found from far above and from deep below [property]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSettings settings;
  const StaticLoad load = general_load();
  for (const double start : {0.052, 0.0415, 0.0385}) {
    StaticEquilibrium result;
    SampleState state(model, settings, load, result);
    CHECK(solve_y(state, {start, 0.0}) == EquilibriumStatus::kConverged);
    CHECK(std::abs(result.loads.total_wrench()[1] - load.Fy) <= 1e-3 * load.Fy + 0.01);
    CHECK(state.Fy_met());
    CHECK(result.evaluations < 20);
  }
}

TEST_CASE("the reduced stiffness is the slope of Mx along constant Fy [derivative]") {
  const test::AnalyticContact model;
  StaticEquilibriumSettings settings;
  settings.force_relative_tolerance = 1e-12;
  settings.force_tolerance = 1e-9;
  const StaticLoad load = general_load();
  StaticEquilibrium result;
  SampleState state(model, settings, load, result);
  const auto Mx_at = [&](double theta_x) {
    REQUIRE(solve_y(state, {0.0413, theta_x}) == EquilibriumStatus::kConverged);
    return state.Mx_residual() + load.Mx;
  };
  const double h = 1e-6, theta_x = 0.0043;
  const double difference = (Mx_at(theta_x + h) - Mx_at(theta_x - h)) / (2 * h);
  Mx_at(theta_x);
  // Fy to 1e-9 N leaves 2.5e-11 Nm of Mx, over 2e-6 rad: 1e-5; truncation (h/tilt of touch)².
  CHECK(state.reduced_rotational_stiffness() == doctest::Approx(difference).epsilon(1e-5));
  CHECK(difference > 0.0);
}

TEST_CASE("the search along θx meets Fy and Mx from a start tilted the wrong way [property]") {
  const test::AnalyticContact model;
  const StaticEquilibriumSettings settings;
  const StaticLoad load = general_load();
  for (const double tilt : {-0.03, 0.0, 0.05}) {
    StaticEquilibrium result;
    SampleState state(model, settings, load, result);
    CHECK(search_theta_x(state, {0.0413, tilt}) == EquilibriumStatus::kConverged);
    CHECK(state.Fy_met());
    CHECK(state.Mx_met());
  }
}
