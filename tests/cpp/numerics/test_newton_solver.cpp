// SPDX-License-Identifier: Apache-2.0
#include "condyle/numerics/newton_solver.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <string>

using namespace condyle::numerics;

// Every allocation of this program is counted, so that a test can hold the solver to its promise.
namespace {
std::atomic<long> allocations{0};
}
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

// A problem from two plain functions; the first unknown is a length, the others angles.
class Given : public EquilibriumProblem {
 public:
  using Residual = void (*)(const Unknowns&, Unknowns&);
  using Derivative = void (*)(const Unknowns&, Jacobian&);
  Given(int unknowns, Residual force, Derivative derivative)
      : size_(unknowns), residual_(force), derivative_(derivative) {}
  int size() const override { return size_; }
  LoadKind load_kind(int i) const override { return i == 0 ? LoadKind::kForce : LoadKind::kMoment; }
  std::string_view coordinate_name(int i) const override { return i == 0 ? "y" : "theta_x"; }
  void residual(const Unknowns& alpha, Unknowns& r) override { residual_(alpha, r); }
  void residual_and_jacobian(const Unknowns& alpha, Unknowns& r, Jacobian& J) override {
    residual_(alpha, r);
    derivative_(alpha, J);
  }

 private:
  int size_;
  Residual residual_;
  Derivative derivative_;
};

Unknowns values(std::initializer_list<double> list) {
  Unknowns v(static_cast<int>(list.size()));
  int i = 0;
  for (const double value : list) v[i++] = value;
  return v;
}

NewtonSettings loose_bounds() {
  NewtonSettings settings;
  settings.max_newton_step_m = 5.0;
  settings.max_newton_step_rad = 5.0;
  return settings;
}

// Minimum of Π = exp(x) + ½(x − 2θ)² + ¼θ⁴ − 3θ: smooth, convex, nothing special about it.
void smooth_residual(const Unknowns& a, Unknowns& r) {
  r[0] = -(std::exp(a[0]) + a[0] - 2.0 * a[1]);
  r[1] = -(-2.0 * (a[0] - 2.0 * a[1]) + a[1] * a[1] * a[1] - 3.0);
}
void smooth_jacobian(const Unknowns& a, Jacobian& J) {
  J << -(std::exp(a[0]) + 1.0), 2.0, 2.0, -(4.0 + 3.0 * a[1] * a[1]);
}

// A body of weight 37 N over a stiff floor at y = 0.4, F = 900 (0.4 − y)₊^1.5: nothing pushes back above it.
void floor_residual(const Unknowns& a, Unknowns& r) {
  r[0] = 900.0 * std::pow(std::max(0.0, 0.4 - a[0]), 1.5) - 37.0;
}
void floor_jacobian(const Unknowns& a, Jacobian& J) {
  J(0, 0) = -1350.0 * std::sqrt(std::max(0.0, 0.4 - a[0]));
}

}  // namespace

TEST_CASE("convergence is quadratic on a smooth problem [property]") {
  Given problem(2, smooth_residual, smooth_jacobian);
  NewtonSettings settings = loose_bounds();
  settings.force_tolerance = settings.moment_tolerance = 1e-13;
  const NewtonResult result = solve_newton(problem, values({0.7, 0.2}), settings);
  CHECK(result.converged());
  const auto& e = result.statistics.residual;
  REQUIRE(e.size() >= 5);
  // Order from three successive residuals above rounding (1e-13 tolerance: residual 1 is 1e-13).
  double order = 0.0;
  for (std::size_t k = 2; k < e.size(); ++k) {
    if (e[k] > 100.0) order = std::log(e[k] / e[k - 1]) / std::log(e[k - 1] / e[k - 2]);
  }
  INFO("order " << order);
  CHECK(order > 1.8);
  CHECK(order < 2.4);
}

TEST_CASE("finite differences find the same equilibrium as the analytic Jacobian [derivative]") {
  Given problem(2, smooth_residual, smooth_jacobian);
  NewtonSettings settings = loose_bounds();
  settings.force_tolerance = settings.moment_tolerance = 1e-9;
  const NewtonResult analytic = solve_newton(problem, values({0.7, 0.2}), settings);
  settings.jacobian = JacobianMethod::kFiniteDifferences;
  const NewtonResult differences = solve_newton(problem, values({0.7, 0.2}), settings);
  REQUIRE(analytic.converged());
  REQUIRE(differences.converged());
  // Residuals below 1e-9 with a stiffness of order 1.
  CHECK((analytic.alpha - differences.alpha).norm() < 1e-8);
  CHECK(differences.statistics.evaluations > analytic.statistics.evaluations);
}

TEST_CASE("start out of contact: the net force leads to the floor [property]") {
  Given problem(1, floor_residual, floor_jacobian);
  NewtonSettings settings;
  settings.max_newton_step_m = 0.1;
  const NewtonResult result = solve_newton(problem, values({1.9}), settings);
  CHECK(result.converged());
  // Closed form: depth (37/900)^(2/3), to the force tolerance over the stiffness there.
  const double depth = std::pow(37.0 / 900.0, 2.0 / 3.0);
  CHECK(std::abs(result.alpha[0] - (0.4 - depth)) < 0.01 / (1350.0 * std::sqrt(depth)));
  CHECK(result.statistics.regularised_steps > 0);
  for (const double step : result.statistics.step) CHECK(step <= 1.0 + 1e-12);
}

TEST_CASE("singular stiffness: a direction without stiffness or load stays where it is [property]") {
  Given problem(
      2,
      [](const Unknowns& a, Unknowns& r) {
        r[0] = -700.0 * (a[0] - 0.013);
        r[1] = 0.0;
      },
      [](const Unknowns&, Jacobian& J) { J << -700.0, 0.0, 0.0, 0.0; });
  NewtonSettings settings;
  const NewtonResult result = solve_newton(problem, values({0.011, 0.37}), settings);
  CHECK(result.converged());
  CHECK(std::abs(result.alpha[0] - 0.013) <= 0.01 / 700.0);
  CHECK(result.alpha[1] == doctest::Approx(0.37).epsilon(1e-12));
}

TEST_CASE("cycling start: where plain Newton jumps between 0 and 1 for ever [property]") {
  // r = −(x³ − 2x + 2): undamped Newton from 0 goes 0 → 1 → 0; the one root is −1.7692923542386314.
  Given problem(
      1, [](const Unknowns& a, Unknowns& r) { r[0] = -(a[0] * a[0] * a[0] - 2.0 * a[0] + 2.0); },
      [](const Unknowns& a, Jacobian& J) { J(0, 0) = -(3.0 * a[0] * a[0] - 2.0); });
  NewtonSettings settings = loose_bounds();
  settings.max_newton_step_m = 1.0;
  settings.force_tolerance = 1e-9;
  const NewtonResult result = solve_newton(problem, values({0.0}), settings);
  CHECK(result.converged());
  CHECK(std::abs(result.alpha[0] + 1.7692923542386314) < 1e-9);
}

TEST_CASE("a Jacobian that is wrong on one side of a corner is replaced by differences [property]") {
  // A spring that hardens 40-fold at the corner where the equilibrium is; the derivative given is of the wrong sign there.
  Given problem(
      1, [](const Unknowns& a, Unknowns& r) { r[0] = -(a[0] > 0.3 ? 83.0 : 2.1) * (a[0] - 0.3) + 0.4; },
      [](const Unknowns& a, Jacobian& J) { J(0, 0) = a[0] > 0.3 ? 5.0 : -2.1; });
  NewtonSettings settings = loose_bounds();
  const NewtonResult result = solve_newton(problem, values({0.31}), settings);
  CHECK(result.converged());
  CHECK(std::abs(result.alpha[0] - (0.3 + 0.4 / 83.0)) <= 0.01 / 83.0);
}

TEST_CASE("unreachable: a load beyond what the spring can carry ends in a status [error]") {
  Given problem(
      1, [](const Unknowns& a, Unknowns& r) { r[0] = 5.3 - 4.1 * std::tanh(a[0]); },
      [](const Unknowns& a, Jacobian& J) { J(0, 0) = -4.1 / std::pow(std::cosh(a[0]), 2); });
  NewtonSettings settings = loose_bounds();
  const NewtonResult result = solve_newton(problem, values({0.2}), settings);
  CHECK(!result.converged());
  CHECK(std::abs(result.residual[0]) >= 1.2 - 1e-9);
  CHECK(std::string(advice(result.status)).find("max_iterations") != std::string::npos);
}

TEST_CASE("not finite: a residual of NaN is a status, not a loop [error]") {
  Given problem(
      1, [](const Unknowns&, Unknowns& r) { r[0] = std::nan(""); },
      [](const Unknowns&, Jacobian& J) { J(0, 0) = 1.0; });
  const NewtonResult result = solve_newton(problem, values({0.2}), NewtonSettings{});
  CHECK(result.status == NewtonStatus::kNotFinite);
}

namespace {

// A spring whose rest follows where it stands, but is held while a step is looked for.
class Following : public EquilibriumProblem {
 public:
  int size() const override { return 1; }
  LoadKind load_kind(int) const override { return LoadKind::kForce; }
  std::string_view coordinate_name(int) const override { return "y"; }
  void residual(const Unknowns& a, Unknowns& r) override { r[0] = -310.0 * (a[0] - held_); }
  void residual_and_jacobian(const Unknowns& a, Unknowns& r, Jacobian& J) override {
    residual(a, r);
    J(0, 0) = -310.0;
  }
  bool renew(const Unknowns& a, Unknowns& r, Jacobian& J) override {
    ++renewals;
    at.push_back(a[0]);
    held_ = 0.0013 + 0.2 * a[0];
    residual_and_jacobian(a, r, J);
    return true;
  }
  int renewals = 0;
  std::vector<double> at;

 private:
  double held_ = 0.0;
};

}  // namespace

TEST_CASE("what a problem holds during a step is taken anew at every iterate [property]") {
  for (const auto method : {JacobianMethod::kAnalytic, JacobianMethod::kFiniteDifferences}) {
    Following problem;
    NewtonSettings settings;
    settings.jacobian = method;
    settings.force_tolerance = 1e-6;
    const NewtonResult result = solve_newton(problem, values({0.0007}), settings);
    REQUIRE(result.converged());
    // a = 0.0013 + 0.2 a, reached by the factor 0.2 a step, the start included.
    CHECK(std::abs(result.alpha[0] - 0.0013 / 0.8) < 1e-6 / (0.8 * 310.0) * 1.01);
    CHECK(problem.renewals == result.statistics.iterations + 1);
    CHECK(problem.at.front() == 0.0007);
    CHECK(problem.at.back() == result.alpha[0]);
  }
}

TEST_CASE("an iteration allocates nothing on the heap [property]") {
  Given problem(1, floor_residual, floor_jacobian);
  NewtonSettings settings;
  settings.max_newton_step_m = 0.02;
  const auto allocations_for = [&](double start, int* iterations) {
    const Unknowns alpha = values({start});
    const long before = allocations;
    const NewtonResult result = solve_newton(problem, alpha, settings);
    const long used = allocations - before;
    *iterations = result.statistics.iterations;
    return used;
  };
  int few = 0, many = 0;
  const long used_for_few = allocations_for(0.38, &few);
  const long used_for_many = allocations_for(0.9, &many);
  CHECK(many > few + 10);
  CHECK(used_for_many == used_for_few);
}

TEST_CASE("a caller's mistakes are named [error]") {
  Given problem(2, smooth_residual, smooth_jacobian);
  CHECK_THROWS_WITH_AS(solve_newton(problem, values({0.1}), NewtonSettings{}),
                       "solve_newton: start has 1 values for a problem of 2 unknowns (1 to 24)",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(solve_newton(problem, values({0.1, NAN}), NewtonSettings{}),
                       "solve_newton: start value of theta_x is nan: must be finite",
                       std::invalid_argument);
  NewtonSettings settings;
  settings.moment_tolerance = -3.0;
  CHECK_THROWS_WITH_AS(
      solve_newton(problem, values({0.1, 0.2}), settings),
      "Newton settings: moment_tolerance is -3.000000: must be finite and above 0",
      std::invalid_argument);
}
