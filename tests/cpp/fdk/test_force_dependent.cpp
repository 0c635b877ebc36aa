// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "condyle/fdk/force_dependent.hpp"
#include "fdk/leg_model.hpp"

using namespace condyle;
using namespace condyle::fdk;
using numerics::Unknowns;

namespace {

struct Leg {
  model::Model model{test::leg_model_description()};
  test::AnalyticContact knee;
  BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem{model, {}, {&contact, 1}};
  FrameInstant instant = test::leg_instant(model, 0.35);
};

Unknowns alpha_of(double adduction, double rotation, double tx, double ty, double tz) {
  Unknowns alpha(5);
  alpha << adduction, rotation, tx, ty, tz;
  return alpha;
}

}  // namespace

TEST_CASE("the same equilibrium from five starts, within tolerance when computed anew") {
  Leg leg;
  ForceDependentSettings settings;
  double apart_at_most = 0.0;
  SUBCASE("muscles share as if α were driven: one equilibrium") {
    settings.max_sharing_updates = 0;
    apart_at_most = 1e-5;
  }
  // C has settled within 0.1 N and 5 mNm: over the softest stiffness (100 Nm/rad about y), 5e-5 rad.
  SUBCASE("muscles share with what α gives") { apart_at_most = 1e-4; }
  const std::vector<Unknowns> starts{
      alpha_of(0, 0, 0, 0, 0), alpha_of(0.03, -0.05, 0.004, 0.001, 0.003),
      alpha_of(-0.02, 0.06, -0.005, -0.006, -0.002),  // out of contact
      alpha_of(0.01, 0.02, 0.002, 0.0025, 0.001),     // deep
      alpha_of(-0.04, -0.08, 0.006, -0.002, 0.004)};
  Unknowns first;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    CAPTURE(i);
    const ForceDependentRecord record =
        solve_force_dependent(leg.problem, leg.instant, {&starts[i], 1}, nullptr, settings);
    INFO(record.message);
    REQUIRE(record.status == ForceDependentStatus::kConverged);
    Unknowns r(5);
    leg.problem.set_frame(leg.instant.motion());
    leg.problem.residual(record.alpha, r);
    for (int k = 0; k < 5; ++k) {
      const bool force = leg.problem.load_kind(k) == numerics::LoadKind::kForce;
      CHECK(std::abs(r[k]) <= (force ? 0.01 : 5e-4));
    }
    if (i == 0) {
      first = record.alpha;
      CHECK(leg.problem.contacts()[0].loads().wrench[kMedial][kY] > 100.0);
      CHECK(leg.problem.contacts()[0].loads().wrench[kLateral][kY] > 100.0);
      continue;
    }
    // Both are within their own last Newton step of the equilibrium, which is quadratically less
    // than `remaining`; the residuals' tolerance bounds these.
    const Unknowns apart = (record.alpha - first).cwiseAbs();
    CHECK(apart.maxCoeff() < apart_at_most);
    CHECK(record.remaining_m < 1e-5);
  }
}

TEST_CASE("convergence is quadratic on the record") {
  Leg leg;
  ForceDependentSettings settings;
  // Near the floor of rounding, so that several steps are in the quadratic range.
  settings.newton.force_tolerance = 1e-7;
  settings.newton.moment_tolerance = 1e-8;
  settings.max_sharing_updates = 0;  // one Newton iteration, one record
  const Unknowns start = Unknowns::Zero(5);
  const ForceDependentRecord record =
      solve_force_dependent(leg.problem, leg.instant, {&start, 1}, nullptr, settings);
  REQUIRE(record.status == ForceDependentStatus::kConverged);
  CHECK(record.attainable_force < settings.newton.force_tolerance);
  const auto& e = record.history;
  REQUIRE(e.size() >= 4);
  // e₊ = C e²: from each of the last two steps to the next, the order log e₊/e over log e/e₋, 2 but
  // for what is left of the asymptote. Scaled residuals above 1e7·tolerance are not yet in it.
  int quadratic = 0;
  for (std::size_t k = 2; k < e.size(); ++k) {
    if (e[k - 2] > 1e9 || e[k] < 1e-1) continue;
    const double order = std::log(e[k] / e[k - 1]) / std::log(e[k - 1] / e[k - 2]);
    if (order > 1.6) ++quadratic;
  }
  // From a thousand tolerances to below one in one step: what only a quadratic rate does here.
  const bool last = e[e.size() - 1] <= 1.0 && e[e.size() - 2] > 10.0;
  CHECK((quadratic >= 1 || last));
  CHECK(record.iterations <= 15);
}

TEST_CASE("finite differences lead to the same place as the analytic Jacobian") {
  Leg leg;
  const Unknowns start = Unknowns::Zero(5);
  const ForceDependentRecord analytic =
      solve_force_dependent(leg.problem, leg.instant, {&start, 1});
  ForceDependentSettings settings;
  settings.newton.jacobian = numerics::JacobianMethod::kFiniteDifferences;
  settings.newton.perturbation = 1e-7;
  const ForceDependentRecord differences =
      solve_force_dependent(leg.problem, leg.instant, {&start, 1}, nullptr, settings);
  REQUIRE(differences.converged());
  CHECK((analytic.alpha - differences.alpha).cwiseAbs().maxCoeff() < 1e-5);
  CHECK(differences.evaluations > 3 * analytic.evaluations);
}

TEST_CASE("muscles that pull on a floating patella are recruited through what it gives") {
  const model::Model model(test::patella_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem(model, {}, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.35, 650.0, 0.05);
  const Unknowns start = Unknowns::Zero(7);
  ForceDependentSettings settings;
  settings.max_sharing_updates = 0;
  const ForceDependentRecord alone =
      solve_force_dependent(problem, instant, {&start, 1}, nullptr, settings);
  CHECK_FALSE(alone.converged());
  const ForceDependentRecord record = solve_force_dependent(problem, instant, {&start, 1});
  INFO(record.message);
  REQUIRE(record.status == ForceDependentStatus::kConverged);
  CHECK(record.sharing_change <= settings.sharing_tolerance);
  CHECK(problem.frame().muscle_forces().head<2>().minCoeff() > 100.0);
  // Flexion is in equilibrium because α is: C passes on no more than α's tolerances.
  CHECK(std::abs(problem.frame().residual()[test::kFlexion]) < 0.01);
  CHECK(problem.frame().moment_arms().row(test::kFlexion).head<2>().isZero(0.0));
}

TEST_CASE("with what α gives, muscles share at an optimum over forces and α together") {
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleSettings muscles;
  muscles.strength = model::StrengthModel::kConstant;
  MuscleEquilibrium problem(model, muscles, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.35, 650.0, 0.05);
  const Unknowns start = Unknowns::Zero(5);
  ForceDependentSettings settings;
  settings.max_sharing_updates = 0;
  REQUIRE(solve_force_dependent(problem, instant, {&start, 1}, nullptr, settings).converged());
  const double alone = problem.recruited()->objective;
  const ForceDependentRecord record = solve_force_dependent(problem, instant, {&start, 1});
  REQUIRE(record.converged());
  CHECK(record.sharing_updates >= 1);
  CHECK(problem.recruited()->objective <= alone);
  CHECK(std::abs(problem.frame().residual()[test::kFlexion]) < 0.01);
}

TEST_CASE(
    "a jump is reached by substeps in time or over a softer contact, and what failed is said") {
  Leg leg;
  const Unknowns start = Unknowns::Zero(5);
  const ForceDependentRecord first = solve_force_dependent(leg.problem, leg.instant, {&start, 1});
  REQUIRE(first.converged());
  const Anchor anchor{leg.instant, first.alpha, {}};
  const FrameInstant far = test::leg_instant(leg.model, 0.9, 1100.0);
  ForceDependentSettings settings;
  settings.newton.max_iterations = 4;
  settings.max_substeps = 1;
  settings.softer_contact.clear();
  const ForceDependentRecord failed =
      solve_force_dependent(leg.problem, far, {&first.alpha, 1}, &anchor, settings);
  REQUIRE(failed.status == ForceDependentStatus::kNotConverged);
  CHECK(failed.message.find(failed.worst_name) != std::string::npos);
  CHECK(failed.message.find("remain on") != std::string::npos);
  CHECK(leg.problem.alpha() == failed.alpha);  // what was reached is kept
  settings.max_substeps = 64;
  const ForceDependentRecord stepped =
      solve_force_dependent(leg.problem, far, {&first.alpha, 1}, &anchor, settings);
  REQUIRE(stepped.converged());
  CHECK(stepped.approach == Approach::kSubsteps);
  CHECK(stepped.substeps > 1);
  const ForceDependentRecord straight = solve_force_dependent(leg.problem, far, {&start, 1});
  REQUIRE(straight.converged());
  CHECK((stepped.alpha - straight.alpha).cwiseAbs().maxCoeff() < 1e-4);  // as C has settled
}

TEST_CASE("where sharing leads nowhere, an equilibrium with muscles that share as if α were driven") {
  Leg leg;
  const Unknowns start = Unknowns::Zero(5);
  ForceDependentSettings settings;
  settings.newton.force_tolerance = 1e-6;
  settings.newton.moment_tolerance = 1e-7;
  settings.max_sharing_updates = 0;
  const ForceDependentRecord driven =
      solve_force_dependent(leg.problem, leg.instant, {&start, 1}, nullptr, settings);
  REQUIRE(driven.converged());
  // From there no step is needed without C, and more than one with it.
  settings.max_sharing_updates = ForceDependentSettings{}.max_sharing_updates;
  settings.newton.max_iterations = 1;
  settings.softer_contact.clear();
  const ForceDependentRecord record =
      solve_force_dependent(leg.problem, leg.instant, {&driven.alpha, 1}, nullptr, settings);
  INFO(record.message);
  REQUIRE(record.status == ForceDependentStatus::kConverged);
  CHECK(name(record.approach) == "uncoupled");
  CHECK_FALSE(record.sharing_settled);
  CHECK((record.alpha - driven.alpha).cwiseAbs().maxCoeff() < 1e-6);
  CHECK(leg.problem.frame().used_coupling().isZero(0.0));
}

TEST_CASE("an equilibrium without C that muscles cannot carry is not taken for one") {
  const model::Model model(test::patella_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem(model, {}, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.35, 650.0, 0.05);
  const Unknowns start = Unknowns::Zero(7);
  ForceDependentSettings settings;
  settings.newton.max_iterations = 2;
  settings.softer_contact.clear();
  const ForceDependentRecord record =
      solve_force_dependent(problem, instant, {&start, 1}, nullptr, settings);
  CHECK(record.status == ForceDependentStatus::kNotConverged);
  CHECK(name(record.approach) == "start");
}

TEST_CASE("between two time frames loads act as their mixed wrenches") {
  Leg leg;
  const FrameInstant a = leg.instant, b = test::leg_instant(leg.model, 0.9, 1100.0);
  const FrameInstant half = between(a, b, 0.25);
  CHECK((half.q - (0.75 * a.q + 0.25 * b.q)).norm() < 1e-15);
  const auto tau = [&](const std::vector<model::ExternalLoad>& loads) {
    model::Kinematics kinematics(leg.model);
    kinematics.set(a.q);
    Eigen::VectorXd found = Eigen::VectorXd::Zero(leg.model.n_coordinates());
    add_generalised_force(kinematics, loads[0], found);
    return found;
  };
  const Eigen::VectorXd mixed = 0.75 * tau(a.loads) + 0.25 * tau(b.loads);
  CHECK((tau(half.loads) - mixed).norm() < 1e-12 * mixed.norm());
}

TEST_CASE("a seated start puts the first touch of the contact between the bodies") {
  Leg leg;
  const Unknowns away = alpha_of(0.02, 0.05, 0.006, -0.01, 0.004);
  const Unknowns seated = seated_start(leg.problem, leg.instant, away, 0);
  leg.problem.set_frame(leg.instant.motion());
  leg.problem.place(seated);
  const Pose pose = leg.problem.contacts()[0].pose(leg.problem.frame().kinematics());
  CHECK(std::abs(pose[kThetaX]) < 1e-8);
  CHECK(std::abs(pose[kThetaY]) < 1e-8);
  // First touch, but for the little that θz changed on the way to it: loaded 20 µm lower, not so 20
  // µm higher.
  Pose higher = pose, lower = pose;
  higher[kY] += 2e-5;
  lower[kY] -= 2e-5;
  CHECK(leg.knee.evaluate(higher, contact::Derivatives::kNone).total_wrench()[kY] == 0.0);
  CHECK(leg.knee.evaluate(lower, contact::Derivatives::kNone).total_wrench()[kY] > 0.0);
  CHECK_THROWS_WITH_AS(seated_start(leg.problem, leg.instant, away, 1),
                       "seated start: contact 1 of 1", std::invalid_argument);
}

TEST_CASE("settings that cannot be meant are refused by name") {
  Leg leg;
  const Unknowns start = Unknowns::Zero(5);
  ForceDependentSettings settings;
  settings.softer_contact = {0.5, 0.2};
  CHECK_THROWS_WITH_AS(
      solve_force_dependent(leg.problem, leg.instant, {&start, 1}, nullptr, settings),
      "force-dependent settings: softer_contact is 0.2: must be above 0, below 1 and rising",
      std::invalid_argument);
  CHECK_THROWS_WITH_AS(solve_force_dependent(leg.problem, leg.instant, {}),
                       "force-dependent kinematics: no start is given", std::invalid_argument);
}
