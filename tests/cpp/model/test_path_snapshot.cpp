// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "condyle/model/path.hpp"
#include "condyle/model/path_route.hpp"
#include "condyle/model/path_snapshot.hpp"
#include "support/path_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

/// A path around cylinders on two bodies, all computed: the truth that its snapshots are held
/// against.
struct Truth {
  Truth() : model(test::path_model_description()), draw(61) {
    ModelDescription m = model.description();
    q = test::general_q(model, draw);
    description.points = {test::point("pelvis", {0.12, 0.06, 0.07}),
                          test::point("shank", {-0.13, -0.21, 0.04})};
    Kinematics at(model);
    at.set(q);
    m.wraps = {test::piercing_cylinder("upper", at, description.points[0], description.points[1],
                                       "pelvis", 0.3, 0.027, draw),
               test::piercing_cylinder("lower", at, description.points[0], description.points[1],
                                       "thigh", 0.7, 0.033, draw)};
    for (const auto& wrap : m.wraps) description.wraps.push_back({wrap.name, "hybrid", -1, -1});
    model = Model(m);
  }
  Model model;
  test::Draw draw;
  PathDescription description;
  Eigen::VectorXd q;
};

}  // namespace

TEST_CASE("at its instant a held path is the path, in length and gradient [property]") {
  const Truth truth;
  const Path path(truth.model, truth.description, "path");
  Kinematics kinematics(truth.model);
  PathWorkspace workspace;
  kinematics.set(truth.q);
  const PathSnapshot held = path.snapshot(kinematics, workspace);
  CHECK(held.points.size() == 6);
  CHECK(held.arc_excess > 1e-6);
  Eigen::VectorXd g(path.n_coordinates()), g_held(path.n_coordinates());
  const double L = path.gradient(kinematics, workspace, g);
  CHECK(std::abs(path.gradient(kinematics, workspace, g_held, &held) - L) < 1e-14);
  // The points of contact stand within 1e-12 m of where the length is stationary, over tangents of
  // some cm.
  CHECK((g - g_held).norm() < 1e-9);
}

TEST_CASE(
    "near its instant a held path is off by second order in length, by first in gradient "
    "[property]") {
  Truth truth;
  const Path path(truth.model, truth.description, "path");
  Kinematics kinematics(truth.model);
  PathWorkspace workspace;
  kinematics.set(truth.q);
  const PathSnapshot held = path.snapshot(kinematics, workspace);
  const Eigen::VectorXd direction = test::general_q(truth.model, truth.draw);
  std::array<double, 2> length_error{}, gradient_error{};
  for (std::size_t k = 0; k < 2; ++k) {
    const double h = k == 0 ? 2e-3 : 1e-3;
    kinematics.set(truth.q + h * direction);
    Eigen::VectorXd g(path.n_coordinates()), g_held(path.n_coordinates());
    const double L = path.gradient(kinematics, workspace, g);
    length_error[k] = path.gradient(kinematics, workspace, g_held, &held) - L;
    gradient_error[k] = (g_held - g).norm();
  }
  // A held line is never shorter than the taut one. Ratios 4 and 2, but for the next order, h
  // relative to angles of ~0.1.
  CHECK(length_error[1] > 0.0);
  CHECK(length_error[0] / length_error[1] == doctest::Approx(4.0).epsilon(0.05));
  CHECK(gradient_error[0] / gradient_error[1] == doctest::Approx(2.0).epsilon(0.05));
}

TEST_CASE("a held path's Hessian is that of its own length [derivative]") {
  const Truth truth;
  const Path path(truth.model, truth.description, "path");
  Kinematics kinematics(truth.model);
  PathWorkspace workspace;
  kinematics.set(truth.q);
  const PathSnapshot held = path.snapshot(kinematics, workspace);
  const auto n = path.n_coordinates();
  const std::vector<int> columns(path.coordinates().begin(), path.coordinates().end());
  Eigen::VectorXd g(n), ahead(n), behind(n);
  Eigen::MatrixXd H(n, n);
  path.hessian(kinematics, workspace, columns, g, H, &held);
  const double h = 1e-5;
  for (int i = 0; i < n; ++i) {
    Eigen::VectorXd q = truth.q;
    q[columns[static_cast<std::size_t>(i)]] += h;
    kinematics.set(q);
    path.gradient(kinematics, workspace, ahead, &held);
    q[columns[static_cast<std::size_t>(i)]] -= 2 * h;
    kinematics.set(q);
    path.gradient(kinematics, workspace, behind, &held);
    // h²/6 times fourth derivatives of up to 1e4, rounding 1e-16/h.
    CHECK(((ahead - behind) / (2 * h) - H.col(i)).norm() < 2e-7);
  }
  CHECK(H.norm() > 1e-2);
}

TEST_CASE("snapshots are found by name and time frame, and refused by name [error]") {
  PathSnapshots snapshots{"walk.json", {0.1, 0.2}, {}};
  const PathSnapshot line{{{0, Vector3(0.1, 0.2, 0.3)}, {-1, Vector3::Zero()}}, 0.003};
  snapshots.paths["vasmed_r"] = {line, line};
  snapshots.paths["vasmed_r"][1].arc_excess = 0.004;
  CHECK_NOTHROW(require_valid(snapshots, 4));
  CHECK(snapshots.find("vasmed_r", 1)->arc_excess == 0.004);
  CHECK(snapshots.find("vasmed_r", 2) == nullptr);
  CHECK(snapshots.find("soleus_r", 0) == nullptr);

  PathSnapshots wrong = snapshots;
  wrong.times[1] = 0.1;
  CHECK_THROWS_WITH_AS(require_valid(wrong, 4),
                       "walk.json: times[1] is 0.100000: must be finite and above the one before",
                       std::invalid_argument);
  wrong = snapshots;
  wrong.paths["vasmed_r"].pop_back();
  CHECK_THROWS_WITH_AS(require_valid(wrong, 4),
                       "walk.json: paths.vasmed_r: 1 snapshots: must be as many as times, 2",
                       std::invalid_argument);
  wrong = snapshots;
  wrong.paths["vasmed_r"][1].points[0].body = 4;
  CHECK_THROWS_WITH_AS(
      require_valid(wrong, 4),
      "walk.json: paths.vasmed_r[1]: points[0].body is 4: must be −1 (ground) to 3",
      std::invalid_argument);
  wrong = snapshots;
  wrong.paths["vasmed_r"][0].points.pop_back();
  CHECK_THROWS_AS(require_valid(wrong, 4), std::invalid_argument);
  wrong = snapshots;
  wrong.paths["vasmed_r"][0].arc_excess = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(require_valid(wrong, 4), std::invalid_argument);

  // A body that the path has nothing to do with.
  const Truth truth;
  const Path path(truth.model, truth.description, "muscle 'm'");
  Kinematics kinematics(truth.model);
  PathWorkspace workspace;
  const PathSnapshot elsewhere{{{3, Vector3::Zero()}, {0, Vector3::Zero()}}, 0.0};
  CHECK_THROWS_WITH_AS(path.length(kinematics, workspace, &elsewhere),
                       "muscle 'm': a snapshot holds a point to body 3: neither the path's points "
                       "nor its wraps are on that body",
                       std::invalid_argument);
}
