// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "condyle/model/inverse_dynamics.hpp"
#include "support/random_model.hpp"
#include "support/small_models.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

Eigen::VectorXd vector(std::initializer_list<double> values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

// τ of a model at q, q̇, q̈.
Eigen::VectorXd tau(const Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
                    const Eigen::VectorXd& qdd, std::span<const ExternalLoad> loads = {}) {
  Kinematics kinematics(model);
  kinematics.set(q, qd, qdd);
  return InverseDynamics(model).compute(kinematics, loads);
}

// Kinetic energy, and with potential energy, from placements and twists alone.
struct Energy {
  double kinetic = 0.0, potential = 0.0;
};
Energy energy(const Kinematics& kinematics) {
  Energy e;
  const ModelDescription& d = kinematics.model().description();
  for (int b = 0; b < kinematics.model().n_bodies(); ++b) {
    const BodyDescription& body = d.bodies[static_cast<std::size_t>(b)];
    const RigidTransform& X = kinematics.X_GB(b);
    const Vector3 centre = X * body.mass_centre;
    const Vector3 w = X.R.transpose() * kinematics.twist(b).w;
    const Vector6& J = body.inertia;
    Matrix3 inertia;
    inertia << J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2];
    e.kinetic += 0.5 * body.mass * kinematics.point_velocity(b, centre).squaredNorm() +
                 0.5 * w.dot(inertia * w);
    e.potential -= body.mass * d.gravity.dot(centre);
  }
  return e;
}

std::vector<ExternalLoad> random_loads(test::Draw& draw, const Model& model) {
  std::vector<ExternalLoad> loads;
  for (const char* body : {"boot", "patella", "trunk", "ground"}) {
    loads.push_back({model.body(body), test::random_vector(draw, 90.0),
                     test::random_vector(draw, 1.0), test::random_vector(draw, 20.0)});
  }
  return loads;
}

}  // namespace

TEST_CASE("a double pendulum needs what Lagrange's equations say [oracle]") {
  // Links of length l1 in the x-y plane, mass centres c1, c2 down each link, angles from the
  // downward vertical.
  const double m1 = 2.3, m2 = 1.7, l1 = 0.43, c1 = 0.21, c2 = 0.27, I1 = 0.031, I2 = 0.022, g = 9.7;
  ModelDescription d;
  d.gravity = {0.0, -g, 0.0};
  const auto fill = [](BodyDescription& body, double mass, double centre, double inertia) {
    body.mass = mass;
    body.mass_centre = {0.0, -centre, 0.0};
    body.inertia << inertia, 0.5 * inertia, inertia, 0.0, 0.0, 0.0;
  };
  fill(test::add_link(d, "a", kGround, {0.1, 0.9, -0.3}, {0, 0, 1}, true), m1, c1, I1);
  fill(test::add_link(d, "b", "a", {0.0, -l1, 0.0}, {0, 0, 1}, true), m2, c2, I2);
  const double a = 0.7, b = -1.1, ad = 2.1, bd = -1.3, add = 4.7, bdd = -3.9;
  const Eigen::VectorXd t = tau(Model(d), vector({a, b}), vector({ad, bd}), vector({add, bdd}));
  // b is measured from link a: with the absolute angle p = a + b,
  //   τ_b = (I2 + m2 c2²) p̈ + m2 l1 c2 (ä cos b + ȧ² sin b) + m2 g c2 sin p
  //   τ_a = τ_b + (I1 + m1 c1² + m2 l1²) ä + m2 l1 c2 (p̈ cos b − ṗ² sin b)
  //         + (m1 c1 + m2 l1) g sin a
  const double p = a + b, pd = ad + bd, pdd = add + bdd, k = m2 * l1 * c2;
  const double tau_b = (I2 + m2 * c2 * c2) * pdd + k * (add * std::cos(b) + ad * ad * std::sin(b)) +
                       m2 * g * c2 * std::sin(p);
  const double tau_a = tau_b + (I1 + m1 * c1 * c1 + m2 * l1 * l1) * add +
                       k * (pdd * std::cos(b) - pd * pd * std::sin(b)) +
                       (m1 * c1 + m2 * l1) * g * std::sin(a);
  // Some twenty roundings of terms of size 10.
  CHECK(std::abs(t[0] - tau_a) < 1e-13);
  CHECK(std::abs(t[1] - tau_b) < 1e-13);
}

TEST_CASE("a heavy symmetric top in steady precession needs nothing [oracle]") {
  // Euler angles z-x-z from ground, z up; the top's mass centre at height l on its axis, I about it
  // I1, I1, I3.
  const double m = 1.9, l = 0.13, I1 = 0.017, I3 = 0.009, g = 9.7;
  ModelDescription d;
  d.gravity = {0.0, 0.0, -g};
  test::add_link(d, "precession", kGround, {0, 0, 0}, {0, 0, 1}, true);
  test::add_link(d, "nutation", "precession", {0, 0, 0}, {1, 0, 0}, true);
  BodyDescription& top = test::add_link(d, "spin", "nutation", {0, 0, 0}, {0, 0, 1}, true);
  top.mass = m;
  top.mass_centre = {0.0, 0.0, l};
  top.inertia << I1, I1, I3, 0.0, 0.0, 0.0;
  const Model model(d);
  const double theta = 0.61, precession = 3.7, about_tip = I1 + m * l * l;
  // I3 (s + Ω cosθ) Ω = m g l + (I1 + m l²) Ω² cosθ
  const double spin =
      (m * g * l + about_tip * precession * precession * std::cos(theta)) / (I3 * precession) -
      precession * std::cos(theta);
  const Eigen::VectorXd q = vector({0.4, theta, 1.3}), none = vector({0, 0, 0});
  CHECK(tau(model, q, vector({precession, 0, spin}), none).norm() < 1e-13);
  // A faster spin lifts the top: it has to be held down by I3 δs Ω sinθ.
  const Eigen::VectorXd held = tau(model, q, vector({precession, 0, spin + 11.0}), none);
  CHECK(held[1] == doctest::Approx(I3 * 11.0 * precession * std::sin(theta)).epsilon(1e-12));
}

TEST_CASE(
    "a slider on a turntable on a moving base feels Coriolis and centrifugal forces [oracle]") {
  const double m = 1.3, I = 0.21;
  ModelDescription d;
  d.gravity = {0.0, -9.7, 0.0};
  test::add_link(d, "base", kGround, {0, 0.3, 0}, {1, 0, 0}, false);
  test::add_link(d, "table", "base", {0, 0, 0}, {0, 1, 0}, true).inertia << 0.6 * I, I, 0.6 * I, 0,
      0, 0;
  test::add_link(d, "slider", "table", {0, 0.1, 0}, {1, 0, 0}, false).mass = m;
  const double a = 0.9, r = 0.31, ad = 2.7, rd = -0.8, xdd = 3.3, add = -1.9, rdd = 2.2;
  const Eigen::VectorXd t =
      tau(Model(d), vector({0.2, a, r}), vector({1.7, ad, rd}), vector({xdd, add, rdd}));
  const double c = std::cos(a), s = std::sin(a);
  CHECK(t[2] == doctest::Approx(m * (rdd + xdd * c - r * ad * ad)).epsilon(1e-13));
  CHECK(
      t[1] ==
      doctest::Approx(m * (r * r * add + 2 * r * rd * ad - xdd * r * s) + I * add).epsilon(1e-13));
  CHECK(t[0] ==
        doctest::Approx(m * (xdd + rdd * c - 2 * rd * ad * s - r * add * s - r * ad * ad * c))
            .epsilon(1e-13));
}

TEST_CASE(
    "power of the generalised forces is the rate of energy, through splines and couplings "
    "[property]") {
  test::Draw draw(51);
  for (std::uint64_t seed : {52, 53, 54}) {
    const Model model(test::random_model(seed));
    Kinematics kinematics(model);
    InverseDynamics dynamics(model);
    const test::Motion motion(draw, model.n_coordinates());
    const auto total = [&](double t) {
      kinematics.set(motion.q(t), motion.qd(t), motion.qdd(t));
      const Energy e = energy(kinematics);
      return e.kinetic + e.potential;
    };
    const double h = 1e-4;
    for (double t = 0.05; t < 2.0; t += 0.19) {
      // Five points: h⁴ times a fifth derivative of some 1e6, and rounding eps·1e3/h = 2e-9; where
      // a spline's third derivative jumps within, h times a jump of some 1e3 in the second
      // derivative of the energy: rare, and seen if wrong.
      const double rate =
          (8.0 * (total(t + h) - total(t - h)) - total(t + 2 * h) + total(t - 2 * h)) / (12.0 * h);
      total(t);
      const double power = dynamics.compute(kinematics).dot(kinematics.qd());
      CAPTURE(t);
      CHECK(std::abs(power) > 1e-3);
      CHECK(std::abs(power - rate) < 1e-7 * (100.0 + std::abs(rate)));
    }
  }
}

TEST_CASE(
    "columns of unit accelerations are a mass matrix: symmetric, positive, ½ q̇ᵀM q̇ the kinetic "
    "energy [property]") {
  const Model model(test::random_model(55, false));
  const int n = model.n_coordinates();
  test::Draw draw(56);
  const test::Motion motion(draw, n);
  const Eigen::VectorXd q = motion.q(0.2), qd = motion.qd(0.2), none = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd still = tau(model, q, none, none);
  Eigen::MatrixXd M(n, n);
  for (int c = 0; c < n; ++c) M.col(c) = tau(model, q, none, Eigen::VectorXd::Unit(n, c)) - still;
  CHECK((M - M.transpose()).norm() < 1e-12 * M.norm());
  Kinematics kinematics(model);
  kinematics.set(q, qd, none);
  CHECK(0.5 * qd.dot(M * qd) == doctest::Approx(energy(kinematics).kinetic).epsilon(1e-11));
  CHECK(M.diagonal().minCoeff() > 0.0);
}

TEST_CASE("a world that glides changes nothing; one that falls takes gravity away [property]") {
  ModelDescription d = test::random_model(57);
  for (const char* slide : {"glide_x", "glide_y", "glide_z"}) {
    const std::string name = slide;
    test::add_link(d, name,
                   name == "glide_x"   ? "ground"
                   : name == "glide_y" ? "glide_x"
                                       : "glide_y",
                   {0.1, 0.2, 0.3}, Vector3::Unit(name.back() - 'x'), false);
  }
  for (JointDescription& joint : d.joints) {
    if (joint.name == "to_trunk") joint.parent.body = "glide_z";
  }
  const Model model(d);
  const int n = model.n_coordinates();
  test::Draw draw(58);
  const test::Motion motion(draw, n);
  Eigen::VectorXd q = motion.q(0.2), qd = motion.qd(0.2), qdd = motion.qdd(0.2);
  qdd.tail(3).setZero();
  const Eigen::VectorXd before = tau(model, q, qd, qdd);
  q.tail(3) += Vector3(2.1, -0.7, 1.4);
  qd.tail(3) += Vector3(3.1, 2.2, -4.3);
  // Twists at ground's origin lose some digits where bodies are metres off and fast.
  CHECK((tau(model, q, qd, qdd) - before).norm() < 1e-11 * before.norm());

  qdd.tail(3) = d.gravity;
  const Eigen::VectorXd falling = tau(model, q, qd, qdd);
  d.gravity.setZero();
  qdd.tail(3).setZero();
  const Eigen::VectorXd weightless = tau(Model(d), q, qd, qdd);
  CHECK((before - weightless).norm() > 1.0);
  CHECK((falling - weightless).norm() < 1e-11 * before.norm());
}

TEST_CASE(
    "external loads take their generalised force away; the floor carries what stands on it "
    "[property]") {
  const Model model(test::random_model(59));
  test::Draw draw(60);
  const test::Motion motion(draw, model.n_coordinates());
  const Eigen::VectorXd q = motion.q(0.2), qd = motion.qd(0.2), qdd = motion.qdd(0.2);
  const std::vector<ExternalLoad> loads = random_loads(draw, model);
  Kinematics kinematics(model);
  kinematics.set(q, qd, qdd);
  Eigen::VectorXd worth = Eigen::VectorXd::Zero(model.n_coordinates());
  for (const ExternalLoad& load : loads) add_generalised_force(kinematics, load, worth);
  const Eigen::VectorXd taken = tau(model, q, qd, qdd) - tau(model, q, qd, qdd, loads);
  CHECK(worth.norm() > 1.0);
  CHECK((taken - worth).norm() < 1e-12 * worth.norm());

  ModelDescription d;
  BodyDescription& body = test::add_link(d, "lift", kGround, {0.2, 0.1, 0.3}, {0, 1, 0}, false);
  body.mass = 3.1;
  const ExternalLoad floor{0, {0.0, 3.1 * 9.80665, 0.0}, {0.7, 0.0, 0.1}, Vector3::Zero()};
  CHECK(tau(Model(d), vector({0.3}), vector({0.0}), vector({0.0}))[0] ==
        doctest::Approx(3.1 * 9.80665));
  CHECK(std::abs(tau(Model(d), vector({0.3}), vector({0.0}), vector({0.0}), {&floor, 1})[0]) <
        1e-14);
}

TEST_CASE("a coupled coordinate's load goes to the one it follows, by virtual work [property]") {
  const ModelDescription coupled = test::random_model(61);
  const ModelDescription free = test::random_model(61, false);
  const Model model(coupled), free_model(free);
  test::Draw draw(62);
  const test::Motion motion(draw, model.n_coordinates());
  Kinematics kinematics(model);
  kinematics.set(motion.q(0.2), motion.qd(0.2), motion.qdd(0.2));
  const Eigen::VectorXd together = InverseDynamics(model).compute(kinematics);
  const Eigen::VectorXd apart = tau(free_model, kinematics.q(), kinematics.qd(), kinematics.qdd());
  Eigen::VectorXd gathered = Eigen::VectorXd::Zero(model.n_coordinates());
  for (int c = 0; c < model.n_coordinates(); ++c) {
    gathered[kinematics.coordinate(c).independent] += kinematics.coordinate(c).slope * apart[c];
  }
  CHECK(std::abs(apart[model.coordinate("q10")]) > 1e-3);
  CHECK(together[model.coordinate("q10")] == 0.0);
  CHECK((together - gathered).norm() < 1e-12 * gathered.norm());
}

TEST_CASE("the derivative by coordinates is that of the forces [derivative]") {
  test::Draw draw(63);
  for (std::uint64_t seed : {64, 65, 66}) {
    const Model model(test::random_model(seed));
    const int n = model.n_coordinates();
    const test::Motion motion(draw, n);
    const std::vector<ExternalLoad> loads = random_loads(draw, model);
    const Eigen::VectorXd q = motion.q(0.7), qd = motion.qd(0.7), qdd = motion.qdd(0.7);
    std::vector<int> all(static_cast<std::size_t>(n));
    std::iota(all.rbegin(), all.rend(), 0);
    Kinematics kinematics(model);
    InverseDynamics dynamics(model);
    kinematics.set(q, qd, qdd);
    dynamics.compute(kinematics, loads);
    Eigen::MatrixXd derivative(n, n);
    dynamics.derivative(kinematics, all, derivative);
    const double h = 1e-6, scale = derivative.norm();
    CHECK(scale > 100.0);
    for (int column = 0; column < n; ++column) {
      const int c = all[static_cast<std::size_t>(column)];
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, c);
      const Eigen::VectorXd difference =
          (tau(model, q + step, qd, qdd, loads) - tau(model, q - step, qd, qdd, loads)) / (2 * h);
      CAPTURE(c);
      // Rounding eps·τ/h ~ 1e-7 of τ's size; h² times a third derivative is below it.
      CHECK((difference - derivative.col(column)).norm() < 1e-7 * scale);
      if (model.dependent(c)) {
        CHECK(derivative.col(column).norm() == 0.0);
      } else if (c != model.coordinate("q6")) {
        CHECK(derivative.col(column).norm() > 1e-3);
      }
    }
  }
}

TEST_CASE(
    "a chosen column is the same alone, and at rest as in a motion without rates [property]") {
  const Model model(test::random_model(67));
  const int n = model.n_coordinates();
  test::Draw draw(68);
  const test::Motion motion(draw, n);
  Kinematics kinematics(model);
  InverseDynamics dynamics(model);
  const Eigen::VectorXd q = motion.q(0.7), none = Eigen::VectorXd::Zero(n);
  kinematics.set(q);
  const Eigen::VectorXd still = dynamics.compute(kinematics);
  CHECK(still == tau(model, q, none, none));
  const std::vector<int> two{model.coordinate("q8"), model.coordinate("q2")}, one{two[1]};
  Eigen::MatrixXd pair(n, 2), alone(n, 1);
  dynamics.derivative(kinematics, two, pair);
  dynamics.derivative(kinematics, one, alone);
  CHECK(pair.col(1) == alone.col(0));
  CHECK(alone.norm() > 0.0);
}

TEST_CASE("loads and coordinates that the model has not are refused [error]") {
  ModelDescription d = test::random_model(69);
  d.source = "walker.json";
  const Model model(d);
  Kinematics kinematics(model);
  InverseDynamics dynamics(model);
  std::vector<ExternalLoad> loads(2);
  loads[1].body = 7;
  CHECK_THROWS_WITH_AS(dynamics.compute(kinematics, loads),
                       "walker.json: external load 1: body is 7; the model has bodies 0 to 6 and "
                       "ground, -1",
                       std::invalid_argument);
  loads[1].body = 2;
  loads[1].point_G.y() = NAN;
  CHECK_THROWS_WITH_AS(
      dynamics.compute(kinematics, loads),
      "walker.json: external load 1: point_G is (0.000000, nan, 0.000000); it must "
      "be finite",
      std::invalid_argument);
  dynamics.compute(kinematics);
  const std::vector<int> chosen{3, 11};
  Eigen::MatrixXd derivative(11, 2), wrong(11, 1);
  CHECK_THROWS_WITH_AS(dynamics.derivative(kinematics, chosen, derivative),
                       "inverse dynamics: coordinate is 11; the model has 0 to 10",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(dynamics.derivative(kinematics, chosen, wrong),
                       "inverse dynamics: derivative is 11 × 1; it must be 11 × 2",
                       std::invalid_argument);
}
