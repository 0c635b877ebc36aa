// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "condyle/fdk/muscle_equilibrium.hpp"
#include "fdk/leg_model.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// A configuration with both sides and most ligaments loaded, and no coordinate at zero.
numerics::Unknowns general_alpha() {
  numerics::Unknowns alpha(5);
  alpha << 0.006, -0.023, 0.0017, 0.0006, -0.0012;
  return alpha;
}

std::string message_of(const model::ModelDescription& description) {
  const model::Model model(description);
  try {
    const MuscleEquilibrium problem(model, {}, {});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

// Largest difference between analytic and central differences, of the row's largest entry.
double jacobian_error(MuscleEquilibrium& problem, const numerics::Unknowns& alpha, double h) {
  const int n = problem.size();
  numerics::Unknowns r(n), ahead(n), behind(n);
  numerics::Jacobian J(n, n), differences(n, n);
  for (int j = 0; j < n; ++j) {
    numerics::Unknowns moved = alpha;
    moved[j] += h;
    problem.residual(moved, ahead);
    moved[j] -= 2 * h;
    problem.residual(moved, behind);
    differences.col(j) = (ahead - behind) / (2 * h);
  }
  problem.residual_and_jacobian(alpha, r, J);
  double worst = 0.0;
  for (int i = 0; i < n; ++i) {
    worst = std::max(worst, (J.row(i) - differences.row(i)).cwiseAbs().maxCoeff() /
                                J.row(i).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "the Jacobian is that of the residual: contact, ligaments, moment arms, recruitment, "
    "dynamics") {
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleSettings settings;
  SUBCASE("cubic criterion") {}
  SUBCASE("quadratic criterion") { settings.recruitment.criterion.exponent = 2.0; }
  SUBCASE("min-max") { settings.recruitment.criterion.min_max = true; }
  SUBCASE("constant strengths") { settings.strength = model::StrengthModel::kConstant; }
  SUBCASE("reserves") { settings.reserve_moment = 20.0; }
  bool coupled = false;
  SUBCASE("coupled through α") { coupled = true; }
  MuscleEquilibrium problem(model, settings, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.42, 650.0, 0.05);
  problem.set_frame(instant.motion());
  numerics::Unknowns r(5);
  numerics::Jacobian J(5, 5);
  problem.residual_and_jacobian(general_alpha(), r, J);
  if (coupled) {
    problem.follow_sharing(1, 1.0, 0.05);
    const numerics::Unknowns before = r;
    REQUIRE(problem.renew(general_alpha(), r, J));
    REQUIRE(problem.frame().used_coupling().cwiseAbs().maxCoeff() > 1e-3);
    REQUIRE((r - before).cwiseAbs().maxCoeff() > 1.0);
    CHECK_FALSE(problem.renew(general_alpha(), r, J));  // once, as was asked for
  }
  // It is a pose in which everything acts.
  REQUIRE(problem.recruited()->converged());
  REQUIRE(problem.contacts()[0].loads().wrench[kMedial].norm() > 50.0);
  REQUIRE(problem.contacts()[0].loads().wrench[kLateral].norm() > 50.0);
  REQUIRE(problem.frame().strand_loads().force.maxCoeff() > 10.0);
  REQUIRE(problem.recruited()->forces.maxCoeff() > 100.0);
  // Along α's own equilibrium nothing changes but strengths and moment arms.
  REQUIRE(problem.frame().force_derivative().cwiseAbs().maxCoeff() > (coupled ? 1.0 : 100.0));
  // Steps of 1e-7 m on a contact whose stiffness changes within millimetres: (h/1 mm)² = 1e-8, and
  // rounding ε·(1e4 N)/h/(1e6 N/m) = 2e-11.
  CHECK(jacobian_error(problem, general_alpha(), 1e-7) < 1e-6);
}

TEST_CASE("the residual is what public functions of model, recruitment and contact give") {
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem(model, {}, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.3);
  problem.set_frame(instant.motion());
  numerics::Unknowns r(5);
  problem.residual(general_alpha(), r);

  Eigen::VectorXd q = instant.q;
  for (int i = 0; i < 5; ++i)
    q[problem.force_dependent()[static_cast<std::size_t>(i)]] = general_alpha()[i];
  model::Kinematics kinematics(model);
  kinematics.set(q, instant.qd, instant.qdd);
  model::InverseDynamics dynamics(model);
  Eigen::VectorXd given = Eigen::VectorXd::Zero(model.n_coordinates());
  const RigidTransform X_GF = kinematics.X_GB(model.body("thigh")) * test::thigh_F();
  const RigidTransform X_GT = kinematics.X_GB(model.body("shank")) * test::shank_T();
  const Wrench w =
      knee.evaluate(pose_from_transform(X_GT.inverse() * X_GF), contact::Derivatives::kNone)
          .total_wrench();
  const Vector3 force = X_GT.R * w.head<3>(), moment = X_GT.R * w.tail<3>();
  add_generalised_force(kinematics, model.body("thigh"), force, X_GF.p, moment, given);
  add_generalised_force(kinematics, model.body("shank"), -force, X_GF.p, -moment, given);
  const model::Strands strands(model);
  model::StrandWorkspace strand_loads(strands);
  strands.add_forces(kinematics, strand_loads, given);
  add_spring_force(kinematics, given);
  given += problem.frame().moment_arms() * problem.frame().muscle_forces();
  const Eigen::VectorXd net = given - dynamics.compute(kinematics, instant.loads);
  for (int i = 0; i < 5; ++i) {
    CAPTURE(problem.coordinate_name(i));
    CHECK(r[i] == doctest::Approx(net[problem.force_dependent()[static_cast<std::size_t>(i)]])
                      .epsilon(1e-10)
                      .scale(100.0));
  }
  CHECK(std::abs(net[test::kFlexion]) < 1e-6);  // muscles balance it
}

TEST_CASE("what was evaluated is not evaluated again, and recruitment alone where only C is new") {
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem(model, {}, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.42, 650.0, 0.05);
  problem.set_frame(instant.motion());
  numerics::Unknowns r(5), again(5);
  numerics::Jacobian J(5, 5), J_again(5, 5);
  problem.residual_and_jacobian(general_alpha(), r, J);
  problem.follow_sharing(1, 1.0, 0.05);
  REQUIRE(problem.renew(general_alpha(), r, J));
  const double contact_seconds = problem.seconds()[static_cast<std::size_t>(Phase::kContact)];
  problem.residual_and_jacobian(general_alpha(), again, J_again);
  CHECK(problem.seconds()[static_cast<std::size_t>(Phase::kContact)] == contact_seconds);
  CHECK(again == r);
  CHECK(J_again == J);
  // The same from nothing, with that C.
  const Eigen::MatrixXd C = problem.frame().used_coupling();
  MuscleEquilibrium fresh(model, {}, {&contact, 1});
  fresh.set_frame(instant.motion());
  fresh.use_coupling(C);
  fresh.residual_and_jacobian(general_alpha(), again, J_again);
  CHECK((again - r).norm() <= 1e-9 * r.norm());
  CHECK((J_again - J).norm() <= 1e-9 * J.norm());
  // A softer contact, another time frame and another α are.
  problem.soften_contact(0.5);
  problem.residual_and_jacobian(general_alpha(), again, J_again);
  CHECK((again - r).norm() > 1.0);
}

TEST_CASE("a load that muscles cannot carry is named, and the residual stays finite") {
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const BodyContactDescription contact = test::leg_contact(knee);
  MuscleEquilibrium problem(model, {}, {&contact, 1});
  const FrameInstant instant = test::leg_instant(model, 0.42, 650.0, 1.1);
  problem.set_frame(instant.motion());
  numerics::Unknowns r(5);
  numerics::Jacobian J(5, 5);
  problem.residual_and_jacobian(general_alpha(), r, J);
  CHECK(problem.recruited()->status == recruitment::RecruitmentStatus::kInfeasible);
  CHECK(problem.recruitment_message().find("flexion") != std::string::npos);
  CHECK(r.allFinite());
  CHECK(J.allFinite());
}

TEST_CASE("models that have nothing to solve for, or ask for the impossible, are refused by name") {
  model::ModelDescription description = test::leg_model_description();
  CHECK(message_of(description).empty());
  description.couplings.push_back({"tz", "flexion", model::Function::linear(0.001)});
  CHECK(message_of(description) ==
        "model 'leg': coordinate 'tz' is force-dependent and follows another; it must be one of "
        "both");
  description = test::leg_model_description();
  for (auto& coordinate : description.coordinates) coordinate.role = model::CoordinateRole::kDriven;
  CHECK(message_of(description) ==
        "model 'leg': no coordinate has the role force_dependent: nothing to solve for");
  const model::Model model(test::leg_model_description());
  const test::AnalyticContact knee;
  const std::vector<BodyContactDescription> twice(2, test::leg_contact(knee));
  CHECK_THROWS_WITH_AS(MuscleEquilibrium(model, {}, twice),
                       "contact 'tibiofemoral': two contacts have that name",
                       std::invalid_argument);
}
