// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/knee_simulator.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "fdk/analytic_contact.hpp"

using namespace condyle;
using namespace condyle::fdk;

namespace {

// A stride in the manner of a gait simulator: two load peaks in stance, flexion to 58° in swing.
LoadCase stride(std::size_t rows) {
  LoadCase c;
  const double pi = std::acos(-1.0);
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(rows - 1);
    const double stance = t < 0.6 ? std::sin(pi * t / 0.6) : 0.0;
    const double swing = t > 0.45 ? std::sin(pi * (t - 0.45) / 0.55) : 0.0;
    c.time.push_back(t);
    c.flexion.push_back(0.27 * std::sin(3.0 * stance) * stance + 1.0 * swing * swing);
    c.axial_force.push_back(168.0 + 2300.0 * stance * (1.2 - 0.9 * std::pow(stance, 4)));
    c.ap_force.push_back(-190.0 * stance * std::cos(4.0 * t) + 25.0);
    c.ie_torque.push_back(5.2 * stance * stance - 0.6);
  }
  return c;
}

void check_residuals(const contact::ContactModel& model, const LoadCase& c, const KneeSimulation& s) {
  for (std::size_t i = 0; i < c.size(); ++i) {
    INFO("time frame " << i << ": " << summary(s));
    const KneeFrame& frame = s.frames[i];
    REQUIRE(frame.status == FrameStatus::kConverged);
    CHECK(frame.pose[kThetaZ] == -c.flexion[i]);
    // From the public pieces, written out: contact, then applied loads and springs by their formulas.
    const auto loads = model.evaluate(frame.pose, contact::Derivatives::kNone);
    const KneeLoad load{c.axial_force[i], c.ap_force[i], c.ie_torque[i]};
    const Wrench w = loads.total_wrench() +
                     applied_wrench(load, model.side_of_body(), s.axial_offset, frame.pose);
    Vector6 Q = generalised_force(frame.pose, w);
    Q[kX] -= 30e3 * (frame.pose[kX] - *s.restraint.reference_x);
    Q[kThetaY] -= 34.377 * (frame.pose[kThetaY] - *s.restraint.reference_theta_y);
    for (const int k : {kX, kY, kZ}) CHECK(std::abs(Q[k]) <= 0.01 + 1e-9);
    for (const int k : {kThetaX, kThetaY}) CHECK(std::abs(Q[k]) <= 5e-4 + 1e-9);
    CHECK((Q.head<5>() - frame.residual).norm() < 1e-8);
  }
}

}  // namespace

TEST_CASE("every time frame of a stride is in equilibrium [property]") {
  const test::AnalyticContact model;
  const LoadCase c = stride(101);
  const KneeSimulation s = simulate_knee(model, c);
  CHECK(s.converged());
  CHECK(summary(s) == "101 of 101 time frames converged");
  check_residuals(model, c, s);
  long evaluations = 0;
  for (const KneeFrame& frame : s.frames) evaluations += frame.evaluations;
  MESSAGE("evaluations a time frame: " << double(evaluations) / 101.0);
  CHECK(evaluations < 101 * 12);
}

TEST_CASE("coarse time frames need continuation and still converge [property]") {
  const test::AnalyticContact model;
  const LoadCase c = stride(9);
  check_residuals(model, c, simulate_knee(model, c));
}

TEST_CASE("flat in the coronal plane: no stiffness in z, and still an equilibrium [property]") {
  test::KneeShape shape;
  shape.coronal_radius = 1e9;
  const test::AnalyticContact model(shape);
  const LoadCase c = stride(51);
  const KneeSimulation s = simulate_knee(model, c);
  check_residuals(model, c, s);
  for (const KneeFrame& frame : s.frames) CHECK(std::abs(frame.pose[kZ]) < 0.01);
}

TEST_CASE("a left knee moves as the mirror image of a right one [property]") {
  const test::AnalyticContact right;
  test::KneeShape shape;
  shape.side_of_body = SideOfBody::kLeft;
  const test::AnalyticContact left(shape);
  const LoadCase c = stride(26);
  const KneeSimulation a = simulate_knee(right, c), b = simulate_knee(left, c);
  REQUIRE(a.converged());
  for (std::size_t i = 0; i < c.size(); ++i) {
    Pose mirrored = a.frames[i].pose;
    for (const int k : {kZ, kThetaX, kThetaY}) mirrored[k] = -mirrored[k];
    // The same iterations but for rounding, amplified by the softest direction: 1e-12 N over 1e2 N/m.
    CHECK((b.frames[i].pose - mirrored).norm() < 1e-9);
    for (int side = 0; side < kSides; ++side) {
      Wrench w = a.frames[i].loads.wrench[static_cast<std::size_t>(side)];
      for (const int k : {2, 3, 4}) w[k] = -w[k];
      CHECK((b.frames[i].loads.wrench[static_cast<std::size_t>(side)] - w).norm() < 1e-3);
    }
    const ClinicalKinematics& u = a.frames[i].clinical;
    const ClinicalKinematics& v = b.frames[i].clinical;
    CHECK(u.flexion == doctest::Approx(v.flexion));
    CHECK(std::abs(u.tibial_external_rotation - v.tibial_external_rotation) < 1e-9);
    CHECK(std::abs(u.adduction - v.adduction) < 1e-9);
  }
}

TEST_CASE("the medial side carries more where the axial line lies medially [property]") {
  const test::AnalyticContact model;
  const LoadCase c = stride(21);
  const KneeSimulation s = simulate_knee(model, c);
  for (const KneeFrame& frame : s.frames) {
    CHECK(frame.loads.wrench[kMedial][1] > frame.loads.wrench[kLateral][1]);
  }
}

TEST_CASE("the loads' signs: anterior force draws the tibia forward, inward torque turns it in [property]") {
  const test::AnalyticContact model;
  LoadCase c{{0.0, 1.0}, {0.2, 0.2}, {600.0, 600.0}, {0.0, 0.0}, {0.0, 0.0}};
  const KneeFrame rest = simulate_knee(model, c).frames[1];
  c.ap_force = {60.0, 60.0};
  const KneeFrame drawn = simulate_knee(model, c).frames[1];
  CHECK(drawn.clinical.anterior_tibial_translation >
        rest.clinical.anterior_tibial_translation + 1e-4);
  c.ap_force = {0.0, 0.0};
  c.ie_torque = {3.0, 3.0};
  const KneeFrame turned = simulate_knee(model, c).frames[1];
  CHECK(turned.clinical.tibial_external_rotation < rest.clinical.tibial_external_rotation - 0.01);
}

TEST_CASE("ligaments instead of springs hold the knee, too [property]") {
  const test::AnalyticContact model;
  const LoadCase c = stride(41);
  KneeSimulatorSettings settings;
  settings.restraint.ap_stiffness = settings.restraint.ie_stiffness = 0.0;
  settings.ligaments = model::default_ligaments(SideOfBody::kRight, settled_pose(model, 0.0).pose);
  const KneeSimulation s = simulate_knee(model, c, settings);
  INFO(summary(s));
  REQUIRE(s.converged());
  for (std::size_t i = 0; i < c.size(); ++i) {
    const KneeFrame& frame = s.frames[i];
    Wrench w = frame.loads.total_wrench() +
               applied_wrench({c.axial_force[i], c.ap_force[i], c.ie_torque[i]},
                              SideOfBody::kRight, s.axial_offset, frame.pose);
    for (const auto& ligament : settings.ligaments) w += model::ligament_wrench(ligament, frame.pose);
    const Vector6 Q = generalised_force(frame.pose, w);
    CHECK(Q.head<3>().cwiseAbs().maxCoeff() <= 0.01 + 1e-9);
    CHECK(Q.segment<2>(3).cwiseAbs().maxCoeff() <= 5e-4 + 1e-9);
  }
}

TEST_CASE("a path there and back ends where it began: no energy is made [property]") {
  // Frictionless and elastic: the state depends on the load alone, so the work over a closed load path is nil.
  const test::AnalyticContact model;
  LoadCase c;
  const int half = 20;
  for (int i = 0; i <= 2 * half; ++i) {
    const double u = 1.0 - std::abs(i - half) / double(half);
    c.time.push_back(0.01 * i);
    c.flexion.push_back(0.1 + 0.5 * u);
    c.axial_force.push_back(300.0 + 1500.0 * u);
    c.ap_force.push_back(-70.0 * u);
    c.ie_torque.push_back(2.0 * u);
  }
  const KneeSimulation s = simulate_knee(model, c);
  REQUIRE(s.converged());
  for (int i = 0; i <= half; ++i) {
    const KneeFrame& there = s.frames[static_cast<std::size_t>(i)];
    const KneeFrame& back = s.frames[static_cast<std::size_t>(2 * half - i)];
    // Residual tolerance over the softest stiffness: 0.01 N over F/b = 300/0.31 N/m in z.
    CHECK((there.pose - back.pose).cwiseAbs().maxCoeff() < 2.0 * 0.01 / (300.0 / 0.31));
    // dU = −Q·dpose by the stiffness just crossed: energies agree as the poses do.
    CHECK(std::abs(model.energy(there.pose) - model.energy(back.pose)) < 1e-4);
  }
}

TEST_CASE("loads that nothing can carry are reported with residual and worst coordinate [error]") {
  const test::AnalyticContact model;
  LoadCase c = stride(5);
  c.ap_force[2] = 4000.0;  // far more than dish and spring hold on the insert
  KneeSimulatorSettings settings;
  settings.max_substeps = 8;
  settings.restraint.ap_stiffness = 0.0;
  const KneeSimulation s = simulate_knee(model, c, settings);
  CHECK(!s.converged());
  CHECK(s.frames[2].status == FrameStatus::kNotConverged);
  CHECK(s.frames[2].residual.cwiseAbs().maxCoeff() > 0.01);
  CHECK(summary(s).find("first not converged: time frame 2, residual") != std::string::npos);
  CHECK(s.frames[1].status == FrameStatus::kConverged);
  CHECK(s.frames[3].status == FrameStatus::kConverged);
  CHECK(std::string(advice(FrameStatus::kNotConverged)).find("max_substeps") != std::string::npos);
}

TEST_CASE("depth beyond what is plausible is flagged, not hidden [error]") {
  test::KneeShape shape;
  shape.stiffness = 4e6;
  const test::AnalyticContact soft(shape);
  const KneeSimulation s = simulate_knee(soft, stride(11));
  CHECK(s.implausible > 0);
  CHECK(summary(s).find("deeper than plausible") != std::string::npos);
}

TEST_CASE("settings out of range are named [error]") {
  const test::AnalyticContact model;
  KneeSimulatorSettings settings;
  settings.insert_width = 74.0;  // mm
  CHECK_THROWS_WITH_AS(simulate_knee(model, stride(3), settings),
                       "knee simulator settings: insert_width is 74.000000: must be above 0 and "
                       "below 0.3 [m]",
                       std::invalid_argument);
}
