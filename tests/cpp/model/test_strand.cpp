// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "condyle/model/strand.hpp"
#include "support/path_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

using test::point;

LigamentDescription ligament(const std::string& name, std::vector<PathPointDescription> points) {
  LigamentDescription l;
  l.name = name;
  l.stiffness = 731.0;
  l.transition_strain = 0.057;
  l.damping = 0.0031;
  l.path.points = std::move(points);
  return l;
}

/// Strands of every kind: straight between several pairs of bodies in both directions, through a
/// point on the same body, over three bodies, from ground, with a moving end, around a cylinder.
struct Fixture {
  /// @param strains of the strands at q, taken in turn.
  explicit Fixture(std::vector<double> strains, std::uint64_t seed = 91) : draw(seed) {
    ModelDescription m = test::path_model_description();
    const Model bare(m);
    q = test::general_q(bare, draw);
    const auto on_thigh = [&] {
      return point("thigh", {draw(-0.04, 0.04), draw(-0.4, -0.3), draw(-0.04, 0.04)});
    };
    const auto on_shank = [&] {
      return point("shank", {draw(-0.04, 0.04), draw(-0.1, -0.03), draw(-0.04, 0.04)});
    };
    for (int k = 0; k < 4; ++k)
      m.ligaments.push_back(
          ligament("tibiofemoral " + std::to_string(k), {on_thigh(), on_shank()}));
    m.ligaments.push_back(ligament("downwards", {on_shank(), on_thigh()}));
    m.ligaments.push_back(ligament("over an edge", {on_thigh(), on_thigh(), on_shank()}));
    m.ligaments.push_back(
        ligament("patellar", {point("patella", {0.05, -0.03, 0.01}), on_shank()}));
    m.ligaments.back().law = LigamentLaw::kLinear;
    m.ligaments.back().stiffness = 21700.0;
    m.ligaments.push_back(
        ligament("patellofemoral", {point("patella", {0.05, 0.03, 0.04}), on_thigh()}));
    m.ligaments.push_back(
        ligament("band", {point("pelvis", {0.02, -0.06, 0.08}), on_thigh(), on_shank()}));
    m.ligaments.push_back(ligament(
        "tether", {point("ground", {0.31, 0.22, 0.13}), point("pelvis", {0.05, 0.02, 0.07})}));
    m.ligaments.push_back(ligament("sliding", {on_thigh(), on_shank()}));
    m.ligaments.back().path.points[1].moving[1] = {
        {"flexion", Function::polynomial({0.003, 0.013, -0.009})}};
    const auto from = point("pelvis", {0.12, 0.06, 0.07}),
               to = point("shank", {-0.13, -0.21, 0.04});
    Kinematics kinematics(bare);
    kinematics.set(q);
    m.wraps = {test::piercing_cylinder("roll", kinematics, from, to, "thigh", 0.55, 0.031, draw)};
    m.ligaments.push_back(ligament("wrapped", {from, to}));
    m.ligaments.back().path.wraps = {{"roll", "hybrid", -1, -1}};
    PathWorkspace workspace;
    for (auto& l : m.ligaments) l.slack_length = 1.0;
    const Model with_wrap(m);
    Kinematics now(with_wrap);
    now.set(q);
    for (std::size_t i = 0; i < m.ligaments.size(); ++i) {
      const Path path(with_wrap, m.ligaments[i].path, m.ligaments[i].name);
      m.ligaments[i].slack_length =
          path.length(now, workspace) / (1.0 + strains[i % strains.size()]);
    }
    model = std::make_unique<Model>(m);
  }
  test::Draw draw;
  Eigen::VectorXd q;
  std::unique_ptr<Model> model;
};

struct Answer {
  Eigen::VectorXd tau;
  Eigen::MatrixXd stiffness;
  double energy;
};

Answer answer(const Strands& strands, StrandWorkspace& workspace, Kinematics& kinematics) {
  Answer a;
  a.tau = Eigen::VectorXd::Zero(kinematics.model().n_coordinates());
  a.stiffness =
      Eigen::MatrixXd::Zero(a.tau.size(), static_cast<Eigen::Index>(workspace.columns().size()));
  strands.add_forces_and_stiffness(kinematics, workspace, a.tau, a.stiffness);
  a.energy = strands.energy(workspace);
  return a;
}

std::vector<int> free_coordinates(const Model& model) {
  std::vector<int> columns;
  for (int c = 0; c < model.n_coordinates(); ++c) {
    if (!model.dependent(c)) columns.push_back(c);
  }
  return columns;
}

}  // namespace

TEST_CASE("generalised force is minus the energy's slope, stiffness is the force's [derivative]") {
  // Slack, toe and linear, none within 1e-3 of a border.
  for (const std::vector<double>& strains :
       {std::vector<double>{0.021, 0.131, 0.083, -0.03, 0.044}, std::vector<double>{0.11}}) {
    const Fixture f(strains);
    const Strands strands(*f.model);
    const auto columns = free_coordinates(*f.model);
    StrandWorkspace workspace(strands, columns);
    Kinematics kinematics(*f.model);
    kinematics.set(f.q);
    const Answer now = answer(strands, workspace, kinematics);
    const double h = 1e-6, scale = now.stiffness.lpNorm<Eigen::Infinity>();
    CHECK(scale > 100.0);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      CAPTURE(i);
      Eigen::VectorXd ahead = f.q, behind = f.q;
      ahead[columns[i]] += h;
      behind[columns[i]] -= h;
      kinematics.set(ahead);
      const Answer a = answer(strands, workspace, kinematics);
      kinematics.set(behind);
      const Answer b = answer(strands, workspace, kinematics);
      // Energies of some 10 J: rounding 1e-15/h; truncation h²/6 times third derivatives of up to
      // 1e6 × 1/0.03.
      CHECK(std::abs((a.energy - b.energy) / (2 * h) + now.tau[columns[i]]) < 1e-6);
      const Eigen::VectorXd column = (a.tau - b.tau) / (2 * h);
      CHECK((column - now.stiffness.col(static_cast<Eigen::Index>(i))).lpNorm<Eigen::Infinity>() <
            3e-8 * scale);
    }
  }
}

TEST_CASE(
    "the sums over pairs are the strands one by one, and chosen columns are columns of the whole "
    "[property]") {
  const Fixture f({0.021, 0.131, -0.02, 0.083});
  const Strands strands(*f.model);
  const auto columns = free_coordinates(*f.model);
  StrandWorkspace workspace(strands, columns);
  Kinematics kinematics(*f.model);
  const Eigen::VectorXd qd = f.q.reverse();
  kinematics.set(f.q, qd, Eigen::VectorXd::Zero(qd.size()));
  const Answer all = answer(strands, workspace, kinematics);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(all.tau.size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(all.stiffness.rows(), all.stiffness.cols());
  PathWorkspace scratch;
  int taut = 0;
  for (int i = 0; i < strands.size(); ++i) {
    const Path& path = strands[i].path;
    Eigen::VectorXd g(path.n_coordinates());
    Eigen::MatrixXd H(path.n_coordinates(), static_cast<Eigen::Index>(columns.size()));
    const double L = path.hessian(kinematics, scratch, columns, g, H);
    const LigamentTension t = tension(strands[i].law, L);
    CHECK(std::abs(workspace.length[i] - L) < 1e-15);
    CHECK(std::abs(workspace.velocity[i] - path.velocity(kinematics, g)) < 1e-14);
    CHECK(std::abs(workspace.strain[i] - t.strain) < 1e-13);
    CHECK(std::abs(workspace.force[i] - t.force) < 1e-9);
    taut += t.force > 0.0;
    for (int k = 0; k < path.n_coordinates(); ++k) {
      const int c = path.coordinates()[static_cast<std::size_t>(k)];
      tau[c] -= t.force * g[k];
      for (std::size_t j = 0; j < columns.size(); ++j) {
        const int own = path.coordinate_index(columns[j]);
        if (own < 0) continue;
        const auto column = static_cast<Eigen::Index>(j);
        K(c, column) -= t.by_length * g[k] * g[own] + t.force * H(k, column);
      }
    }
  }
  CHECK(taut == 9);
  CHECK((tau - all.tau).norm() < 1e-13 * tau.norm());
  CHECK((K - all.stiffness).norm() < 1e-13 * K.norm());

  const std::vector<int> few{columns[10], columns[7]};
  StrandWorkspace small(strands, few);
  const Answer part = answer(strands, small, kinematics);
  CHECK((part.stiffness.col(0) - all.stiffness.col(10)).norm() < 1e-14 * K.norm());
  CHECK((part.stiffness.col(1) - all.stiffness.col(7)).norm() < 1e-14 * K.norm());
  Eigen::VectorXd alone = Eigen::VectorXd::Zero(tau.size());
  strands.add_forces(kinematics, small, alone);
  CHECK((alone - all.tau).norm() < 1e-14 * tau.norm());
}

TEST_CASE("around a closed loop of postures ligaments do no work [property]") {
  // All well inside their linear regions: the integrand is smooth and periodic, the trapezoid rule
  // exact to rounding.
  const Fixture f({0.31});
  const Strands strands(*f.model);
  StrandWorkspace workspace(strands);
  Kinematics kinematics(*f.model);
  test::Draw draw(93);
  const Eigen::VectorXd a = 0.05 * test::general_q(*f.model, draw),
                        b = 0.05 * test::general_q(*f.model, draw);
  double work = 0.0, gross = 0.0;
  const int steps = 48;
  for (int k = 0; k < steps; ++k) {
    const double s = 2.0 * std::numbers::pi * k / steps;
    kinematics.set(f.q + std::cos(s) * a + std::sin(s) * b);
    Eigen::VectorXd tau = Eigen::VectorXd::Zero(f.q.size());
    strands.add_forces(kinematics, workspace, tau);
    const double power = tau.dot(-std::sin(s) * a + std::cos(s) * b);
    work += power * 2.0 * std::numbers::pi / steps;
    gross += std::abs(power) * 2.0 * std::numbers::pi / steps;
  }
  CHECK(gross > 0.1);
  CHECK(std::abs(work) < 1e-12 * gross);
}

TEST_CASE("held strands pull as the paths that they hold, and let go again [property]") {
  const Fixture f({0.07});
  const Strands strands(*f.model);
  const auto columns = free_coordinates(*f.model);
  StrandWorkspace workspace(strands, columns);
  Kinematics kinematics(*f.model);
  kinematics.set(f.q);
  const Answer computed = answer(strands, workspace, kinematics);
  PathSnapshots snapshots{"test", {0.1, 0.2}, {}};
  PathWorkspace scratch;
  for (int i = 0; i < strands.size(); ++i) {
    if (strands[i].name == "sliding") continue;  // held, its point would not slide
    const PathSnapshot now = strands[i].path.snapshot(kinematics, scratch);
    PathSnapshot other = now;
    other.arc_excess += 0.01;
    snapshots.paths[strands[i].name] = {other, now};
  }
  workspace.hold(snapshots, 1);
  const Answer held = answer(strands, workspace, kinematics);
  CHECK((held.tau - computed.tau).norm() < 1e-9 * computed.tau.norm());
  // The Hessian of the wrapped strand is that of the held line: another, but not by much.
  CHECK((held.stiffness - computed.stiffness).norm() > 1e-9 * computed.stiffness.norm());
  CHECK((held.stiffness - computed.stiffness).norm() < 0.2 * computed.stiffness.norm());
  const Eigen::VectorXd length = workspace.length;
  workspace.hold(snapshots, 0);
  answer(strands, workspace, kinematics);
  CHECK((workspace.length - length).sum() ==
        doctest::Approx(0.01 * (strands.size() - 1)).epsilon(1e-9));
  for (int i = 0; i < strands.size(); ++i) workspace.hold(i, nullptr);
  const Answer again = answer(strands, workspace, kinematics);
  CHECK((again.stiffness - computed.stiffness).norm() == 0.0);
}

TEST_CASE(
    "damping adds c times the strain rate where a strand is stretched and lengthens [property]") {
  const Fixture f({0.07, -0.02});
  const Strands strands(*f.model);
  StrandWorkspace workspace(strands);
  Kinematics kinematics(*f.model);
  test::Draw draw(95);
  kinematics.set(f.q, -test::general_q(*f.model, draw), Eigen::VectorXd::Zero(f.q.size()));
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(f.q.size()), damped = tau;
  strands.add_forces(kinematics, workspace, tau);
  const Eigen::VectorXd elastic = workspace.force;
  strands.add_forces(kinematics, workspace, damped, StrandDamping::kBlankevoort);
  int resisting = 0;
  double power = 0.0;
  for (int i = 0; i < strands.size(); ++i) {
    const double expected =
        damping(strands[i].law, workspace.length[i], workspace.velocity[i]).force;
    CHECK(std::abs(workspace.force[i] - elastic[i] - expected) < 1e-12 * (1.0 + elastic[i]));
    resisting += expected > 0.0;
    power -= expected * workspace.velocity[i];
  }
  CHECK(resisting > 0);
  // Damping takes energy out, as much as its tensions say.
  CHECK((damped - tau).dot(kinematics.qd()) == doctest::Approx(power).epsilon(1e-6));
  CHECK(power < 0.0);
}

TEST_CASE("strands that cannot be are refused by name, and wraps not computed are named [error]") {
  const Fixture f({0.07});
  ModelDescription m = f.model->description();
  m.wraps[0].kind = WrapKind::kSphere;
  CHECK(Strands(Model(m)).wraps_ignored() == std::vector<std::string>{"wrapped: roll"});
  const Strands strands(*f.model);
  CHECK(strands.wraps_ignored().empty());
  CHECK_THROWS_WITH_AS(StrandWorkspace(strands, std::vector<int>{99}),
                       "ligament strands: column 0 is coordinate 99: must be 0 to 14",
                       std::invalid_argument);
  StrandWorkspace workspace(strands);
  Kinematics kinematics(*f.model);
  Eigen::VectorXd tau(3);
  CHECK_THROWS_WITH_AS(strands.add_forces(kinematics, workspace, tau),
                       "ligament strands: the number of generalised forces is 3: must be 15",
                       std::invalid_argument);
  CHECK_THROWS_AS(workspace.hold(99, nullptr), std::invalid_argument);
}
