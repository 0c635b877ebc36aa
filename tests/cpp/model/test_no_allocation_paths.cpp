// SPDX-License-Identifier: Apache-2.0
// Paths and ligament strands allocate nothing once their workspaces have seen them.
#include <doctest/doctest.h>

#include "condyle/model/strand.hpp"
#include "support/count_allocations.hpp"
#include "support/path_model.hpp"

using namespace condyle;
using namespace condyle::model;

TEST_CASE("paths and strands allocate nothing at a time frame [property]") {
  CHECK(test::count_allocations([] { std::vector<double>(7).front() += 1.0; }) == 1);
  test::Draw draw(97);
  ModelDescription m = test::path_model_description();
  const Model bare(m);
  const Eigen::VectorXd q = test::general_q(bare, draw);
  Kinematics there(bare);
  there.set(q);
  const auto from = test::point("pelvis", {0.12, 0.06, 0.07});
  const auto to = test::point("shank", {-0.13, -0.21, 0.04});
  m.wraps = {test::piercing_cylinder("upper", there, from, to, "pelvis", 0.3, 0.027, draw),
             test::piercing_cylinder("lower", there, from, to, "thigh", 0.7, 0.033, draw)};
  for (int k = 0; k < 3; ++k) {
    LigamentDescription l;
    l.name = "strand " + std::to_string(k);
    l.stiffness = 731.0;
    l.slack_length = 0.05;
    l.path.points = {from, to};
    if (k == 1) l.path.points[1].moving[0] = {{"flexion", Function::linear(0.02)}};
    if (k == 2) l.path.wraps = {{"upper", "hybrid", -1, -1}, {"lower", "hybrid", -1, -1}};
    m.ligaments.push_back(l);
  }
  const Model model(m);
  const Strands strands(model);
  const std::vector<int> columns{model.coordinate("flexion"), model.coordinate("tz")};
  StrandWorkspace workspace(strands, columns);
  Kinematics kinematics(model);
  PathWorkspace scratch;
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(q.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(q.size(), 2);
  const Path& path = strands[2].path;
  Eigen::VectorXd gradient(path.n_coordinates());
  Eigen::MatrixXd hessian(path.n_coordinates(), 2);
  kinematics.set(q);
  path.length(kinematics, scratch);
  PathSnapshots snapshots{"test", {0.1}, {}};
  for (int i = 0; i < 3; ++i) {
    snapshots.paths[strands[i].name] = {strands[i].path.snapshot(kinematics, scratch)};
  }
  const Eigen::VectorXd next = 1.01 * q;
  const auto frame = [&] {
    strands.add_forces(kinematics, workspace, tau);
    strands.add_forces_and_stiffness(kinematics, workspace, tau, stiffness);
  };
  // Once: the axes that the columns move, and room for the longest snapshot.
  frame();
  workspace.hold(snapshots, 0);
  for (int i = 0; i < 3; ++i) workspace.hold(i, nullptr);
  CHECK(test::count_allocations([&] {
          kinematics.set(next);
          path.length(kinematics, scratch);
          path.gradient(kinematics, scratch, gradient);
          path.hessian(kinematics, scratch, columns, gradient, hessian);
          frame();
          workspace.hold(snapshots, 0);
          frame();
        }) == 0);
  CHECK(tau.norm() > 0.0);
}
