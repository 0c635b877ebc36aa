// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "condyle/model/path.hpp"
#include "condyle/model/path_route.hpp"
#include "support/path_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

using test::point;

/// The paths of these tests, each of another kind.
PathDescription path_of_kind(int kind) {
  PathDescription p;
  const auto moving = [] {
    PathPointDescription moves = point("shank", {0.031, -0.052, 0.017});
    moves.moving[0] = {{"flexion", Function::polynomial({0.001, 0.013, -0.009})}};
    moves.moving[2] = {
        {"flexion", Function::spline(FunctionKind::kSimmSpline, {-1.1, -0.3, 0.4, 1.3},
                                     {0.004, -0.003, 0.006, 0.001})},
        {"rotation", Function::linear(0.021)}};
    return moves;
  };
  switch (kind) {
    case 0:
      p.points = {point("thigh", {0.03, -0.21, 0.02}), point("shank", {-0.02, -0.11, 0.04})};
      break;
    case 1:  // three bodies, and ground
      p.points = {point("ground", {0.31, 0.22, 0.13}),  point("pelvis", {0.05, 0.02, 0.07}),
                  point("pelvis", {0.02, -0.06, 0.08}), point("thigh", {0.04, -0.3, 0.03}),
                  point("patella", {0.05, 0.03, 0.01}), point("shank", {0.03, -0.09, 0.01})};
      break;
    case 2:  // moving point in the middle and at the end
      p.points = {point("pelvis", {0.02, -0.06, 0.08}), moving(), moving(),
                  point("patella", {0.05, 0.03, 0.01})};
      p.points[2].body = "thigh";
      p.points[2].location = Vector3(0.04, -0.33, -0.02);
      std::swap(p.points[0], p.points[1]);
      break;
    case 3:  // conditional, present throughout
      p.points = {point("pelvis", {0.02, -0.06, 0.08}), point("thigh", {0.06, -0.25, 0.03}),
                  point("shank", {-0.02, -0.11, 0.04})};
      p.points[1].condition_coordinate = "flexion";
      p.points[1].condition_min = -2.0;
      p.points[1].condition_max = 2.0;
      break;
    default:
      break;
  }
  return p;
}

/// Gradient and Hessian of a path against central differences. @return largest entries seen, to
/// know they are not zero.
std::array<double, 2> check_derivatives(const Model& model, const Path& path,
                                        const Eigen::VectorXd& q,
                                        const PathSnapshot* held = nullptr) {
  Kinematics kinematics(model);
  PathWorkspace workspace;
  const auto n = path.n_coordinates();
  std::vector<int> columns(path.coordinates().begin(), path.coordinates().end());
  const auto gradient_at = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd g(n);
    kinematics.set(at);
    path.gradient(kinematics, workspace, g, held);
    return g;
  };
  Eigen::VectorXd g(n);
  Eigen::MatrixXd H(n, n);
  kinematics.set(q);
  const double L = path.hessian(kinematics, workspace, columns, g, H, held);
  CHECK(L == path.length(kinematics, workspace, held));
  CHECK((g - gradient_at(q)).norm() <= 1e-15 * n);
  const double h = 1e-5;
  for (int i = 0; i < n; ++i) {
    Eigen::VectorXd ahead = q, behind = q;
    ahead[path.coordinates()[static_cast<std::size_t>(i)]] += h;
    behind[path.coordinates()[static_cast<std::size_t>(i)]] -= h;
    kinematics.set(ahead);
    const double L_ahead = path.length(kinematics, workspace, held);
    kinematics.set(behind);
    const double L_behind = path.length(kinematics, workspace, held);
    // Truncation h²·L‴/6 with L‴ up to some 100 m, rounding 1e-16/h.
    CHECK(std::abs((L_ahead - L_behind) / (2 * h) - g[i]) < 3e-9);
    // The gradient's fourth-order neighbours: up to some 1e4 m.
    const Eigen::VectorXd column = (gradient_at(ahead) - gradient_at(behind)) / (2 * h);
    CHECK((column - H.col(i)).lpNorm<Eigen::Infinity>() < 2e-7);
  }
  return {g.lpNorm<Eigen::Infinity>(), H.lpNorm<Eigen::Infinity>()};
}

}  // namespace

TEST_CASE("gradient and Hessian are the length's, for every kind of point [derivative]") {
  const Model model(test::path_model_description());
  test::Draw draw(41);
  for (int kind = 0; kind < 4; ++kind) {
    CAPTURE(kind);
    const Path path(model, path_of_kind(kind), "path");
    for (int pose = 0; pose < 3; ++pose) {
      const auto largest = check_derivatives(model, path, test::general_q(model, draw));
      CHECK(largest[0] > 1e-2);
      CHECK(largest[1] > 1e-2);
    }
  }
}

namespace {

/// A model with cylinders that a path pierces at a pose, and the path.
struct WrappedCase {
  Model model;
  PathDescription path;
  Eigen::VectorXd q;
};

/// @param kind 0: a cylinder on a third body; 1: on the first point's body; 2: two cylinders on one
/// segment, on two bodies; 3: three of them, and a moving end; 4: one cylinder and via points.
WrappedCase wrapped_case(int kind, int seed) {
  test::Draw draw(static_cast<std::uint64_t>(100 * kind + seed));
  ModelDescription m = test::path_model_description();
  const Model bare(m);
  WrappedCase c{bare, {}, test::general_q(bare, draw)};
  Kinematics at(bare);
  at.set(c.q);
  auto& points = c.path.points;
  points = {point("pelvis", {0.12, 0.06, 0.07}), point("shank", {-0.13, -0.21, 0.04})};
  if (kind == 3) {
    points[1].moving[0] = {{"flexion", Function::polynomial({0.001, 0.013, -0.009})}};
    points[1].moving[1] = {{"tilt", Function::linear(0.017)}};
  }
  if (kind == 4) points.insert(points.begin(), point("ground", {0.3, 0.2, 0.1}));
  const auto &p = points[points.size() - 2], &q = points.back();
  const auto add = [&](const char* body, double fraction, double radius) {
    const std::string name = "cylinder " + std::to_string(m.wraps.size());
    m.wraps.push_back(test::piercing_cylinder(name, at, p, q, body, fraction, radius, draw));
    c.path.wraps.push_back({name, "hybrid", -1, -1});
  };
  switch (kind) {
    case 1:
      add("pelvis", 0.4, 0.031);
      break;
    case 2:
      add("pelvis", 0.3, 0.027), add("thigh", 0.7, 0.033);
      break;
    case 3:
      add("thigh", 0.25, 0.024), add("pelvis", 0.5, 0.021), add("shank", 0.78, 0.027);
      break;
    default:
      add("thigh", 0.55, 0.031);
  }
  c.model = Model(m);
  return c;
}

int times_wrapped(const PathWorkspace& workspace) {
  int n = 0;
  for (const PathSpan& span : workspace.spans) n += span.cylinder >= 0;
  return n;
}

}  // namespace

TEST_CASE(
    "gradient and Hessian are the length's around one, two and three cylinders [derivative]") {
  for (int kind = 0; kind < 5; ++kind) {
    for (int seed = 0; seed < 3; ++seed) {
      CAPTURE(kind);
      CAPTURE(seed);
      const WrappedCase c = wrapped_case(kind, seed);
      const Path path(c.model, c.path, "path");
      Kinematics kinematics(c.model);
      PathWorkspace workspace;
      kinematics.set(c.q);
      path.length(kinematics, workspace);
      // The two outer ones of three may lift the line off the one between.
      CHECK(times_wrapped(workspace) >=
            static_cast<int>(c.path.wraps.size()) - (kind == 3 ? 1 : 0));
      check_derivatives(c.model, path, c.q);
    }
  }
}

TEST_CASE(
    "a taut path pulls on nothing as a whole: moving all bodies together changes nothing "
    "[property]") {
  for (int kind = 0; kind < 4; ++kind) {
    WrappedCase c = wrapped_case(kind, 7);
    for (auto& point : c.path.points) point.moving = {};
    const Path path(c.model, c.path, "path");
    Kinematics kinematics(c.model);
    PathWorkspace workspace;
    kinematics.set(c.q);
    const double L = path.length(kinematics, workspace);
    // No coordinate of the root is asked about, and none has an effect.
    for (const char* root : {"list", "turn", "tilt", "px", "py", "pz"}) {
      const int coordinate = c.model.coordinate(root);
      CHECK(path.coordinate_index(coordinate) == -1);
      c.q[coordinate] += 0.3;
    }
    kinematics.set(c.q);
    CHECK(std::abs(path.length(kinematics, workspace) - L) < 1e-14);
  }
}

TEST_CASE("a path read backwards is the same path [property]") {
  for (int kind = 0; kind < 5; ++kind) {
    WrappedCase c = wrapped_case(kind, 11);
    const Path path(c.model, c.path, "path");
    std::reverse(c.path.points.begin(), c.path.points.end());
    const Path reversed(c.model, c.path, "reversed");
    Kinematics kinematics(c.model);
    PathWorkspace workspace;
    kinematics.set(c.q);
    Eigen::VectorXd g(path.n_coordinates()), r(path.n_coordinates());
    const double L = path.gradient(kinematics, workspace, g);
    // Where the cylinders' order is another, the passes end elsewhere within 1e-12 m of the point
    // of contact.
    CHECK(std::abs(reversed.gradient(kinematics, workspace, r) - L) < 1e-14);
    CHECK((g - r).norm() < 1e-10);
  }
}

TEST_CASE(
    "length and gradient are continuous through touch-down along a motion, the Hessian is not "
    "[property]") {
  const WrappedCase c = wrapped_case(0, 3);
  const Path path(c.model, c.path, "path");
  Kinematics kinematics(c.model);
  PathWorkspace workspace;
  // The cylinder is left by moving the pelvis' end around it: find where, by bisection in hip_x and
  // hip_z.
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(c.model.n_coordinates());
  direction[c.model.coordinate("hip_x")] = 0.7;
  direction[c.model.coordinate("hip_z")] = 1.3;
  direction[c.model.coordinate("flexion")] = -0.9;
  const auto wraps_at = [&](double s) {
    kinematics.set(c.q + s * direction);
    path.length(kinematics, workspace);
    return times_wrapped(workspace) > 0;
  };
  double on = 0.0, off = 0.0;
  for (double s = 0.01; s < 1.5 && off == 0.0; s += 0.01) {
    if (!wraps_at(s)) off = s;
    if (!wraps_at(-s)) off = -s;
  }
  REQUIRE(off != 0.0);
  while (std::abs(off - on) > 1e-9) (wraps_at(0.5 * (on + off)) ? on : off) = 0.5 * (on + off);
  const auto n = path.n_coordinates();
  const std::vector<int> columns(path.coordinates().begin(), path.coordinates().end());
  Eigen::VectorXd g_on(n), g_off(n);
  Eigen::MatrixXd H_on(n, n), H_off(n, n);
  REQUIRE(wraps_at(on));
  const double L_on = path.hessian(kinematics, workspace, columns, g_on, H_on);
  REQUIRE(!wraps_at(off));
  const double L_off = path.hessian(kinematics, workspace, columns, g_off, H_off);
  // 1e-9 of motion times first and second derivatives of order 1.
  CHECK(std::abs(L_on - L_off) < 5e-9);
  CHECK((g_on - g_off).norm() < 5e-8);
  CHECK((H_on - H_off).norm() > 1e-3);
}

TEST_CASE(
    "points come and go with their condition, and wraps keep to their range of points [property]") {
  ModelDescription m = test::path_model_description();
  PathDescription p = path_of_kind(3);
  p.points[1].condition_min = 0.1;
  p.points[1].condition_max = 0.4;
  PathDescription without = p;
  without.points.erase(without.points.begin() + 1);
  PathDescription always = p;
  always.points[1].condition_coordinate.reset();
  const Model model(m);
  const Path path(model, p, "path"), absent(model, without, "path"), present(model, always, "path");
  Kinematics kinematics(model);
  PathWorkspace workspace;
  test::Draw draw(43);
  Eigen::VectorXd q = test::general_q(model, draw);
  for (const auto& [flexion, is_present] :
       {std::pair(0.05, false), std::pair(0.1 - 0.9e-5, true), std::pair(0.1 - 1.1e-5, false),
        std::pair(0.25, true), std::pair(0.4 + 0.9e-5, true), std::pair(0.45, false)}) {
    CAPTURE(flexion);
    q[model.coordinate("flexion")] = flexion;
    kinematics.set(q);
    CHECK(path.length(kinematics, workspace) ==
          (is_present ? present : absent).length(kinematics, workspace));
  }
  CHECK(present.length(kinematics, workspace) > absent.length(kinematics, workspace) + 1e-4);

  // The cylinder of kind 4 is on the second segment: a range of the first one does not reach it.
  WrappedCase c = wrapped_case(4, 2);
  for (const auto& [first, last, wraps] :
       {std::tuple(-1, -1, 1), std::tuple(1, 2, 1), std::tuple(0, 1, 0)}) {
    c.path.wraps[0].first_point = first;
    c.path.wraps[0].last_point = last;
    const Path ranged(c.model, c.path, "path");
    Kinematics at(c.model);
    at.set(c.q);
    ranged.length(at, workspace);
    CHECK(times_wrapped(workspace) == wraps);
  }
}

TEST_CASE(
    "a coordinate that follows another counts as that one, and L̇ is the length's rate "
    "[derivative]") {
  const Model model(test::path_model_description());
  PathDescription p;
  p.points = {point("thigh", {0.05, -0.3, 0.03}), point("patella", {0.05, 0.03, 0.01})};
  const Path path(model, p, "path");
  CHECK(path.coordinate_index(model.coordinate("pat_flexion")) == -1);
  REQUIRE(path.coordinate_index(model.coordinate("flexion")) >= 0);
  test::Draw draw(44);
  check_derivatives(model, path, test::general_q(model, draw));

  for (const int kind : {1, 2}) {
    const Path moving(model, path_of_kind(kind), "path");
    Kinematics kinematics(model);
    PathWorkspace workspace;
    const Eigen::VectorXd q = test::general_q(model, draw), qd = 3.0 * test::general_q(model, draw);
    const double h = 1e-6;
    kinematics.set(q + h * qd);
    const double ahead = moving.length(kinematics, workspace);
    kinematics.set(q - h * qd);
    const double behind = moving.length(kinematics, workspace);
    kinematics.set(q, qd, Eigen::VectorXd::Zero(q.size()));
    Eigen::VectorXd g(moving.n_coordinates());
    moving.gradient(kinematics, workspace, g);
    // Rounding 1e-16/h, truncation h²·|qd|³·L‴/6.
    CHECK(std::abs((ahead - behind) / (2 * h) - moving.velocity(kinematics, g)) < 2e-9);
  }
}

TEST_CASE(
    "surfaces that are not computed are named, and those that are inactive are not [property]") {
  WrappedCase c = wrapped_case(0, 1);
  ModelDescription m = c.model.description();
  m.wraps.push_back(m.wraps[0]);
  m.wraps[1].name = "ball";
  m.wraps[1].kind = WrapKind::kSphere;
  m.wraps[0].active = false;
  c.path.wraps.push_back({"ball", "hybrid", -1, -1});
  const Model model(m);
  const Path path(model, c.path, "path");
  CHECK(path.wraps_ignored() == std::vector<std::string>{"ball"});
  CHECK(path.cylinders().empty());
  Kinematics kinematics(model);
  PathWorkspace workspace;
  kinematics.set(c.q);
  const Vector3 a = kinematics.X_GB(0) * c.path.points[0].location,
                b = kinematics.X_GB(2) * c.path.points[1].location;
  CHECK(path.length(kinematics, workspace) == doctest::Approx((b - a).norm()).epsilon(1e-15));
}

TEST_CASE("a path that cannot be is refused, naming owner and field [error]") {
  const Model model(test::path_model_description());
  const auto message = [&](const PathDescription& p) -> std::string {
    try {
      const Path path(model, p, "muscle 'vasmed_r'");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  PathDescription p = path_of_kind(0);
  p.points.pop_back();
  CHECK(message(p) == "muscle 'vasmed_r': path.points: 1: must be at least 2");
  p = path_of_kind(0);
  p.points[1].body = "femur";
  CHECK(message(p).starts_with("muscle 'vasmed_r': path.points[1].body: "));
  CHECK(message(p).find("femur") != std::string::npos);
  p = path_of_kind(3);
  p.points[1].condition_min = 3.0;
  CHECK(message(p).starts_with("muscle 'vasmed_r': path.points[1].condition: min is 3.000000"));
  p = path_of_kind(0);
  p.wraps.push_back({"KnExt", "hybrid", -1, -1});
  CHECK(message(p) ==
        "muscle 'vasmed_r': path.wraps[0].wrap is 'KnExt': the model has no wrapping surface of "
        "that name");
  WrappedCase c = wrapped_case(0, 1);
  c.path.wraps[0].last_point = 2;
  CHECK_THROWS_WITH_AS(
      Path(c.model, c.path, "muscle 'm'"),
      "muscle 'm': path.wraps[0]: first_point -1, last_point 2: must be ascending and at most 1",
      std::invalid_argument);
  const Path path(model, path_of_kind(0), "muscle 'm'");
  Kinematics kinematics(model);
  PathWorkspace workspace;
  Eigen::VectorXd g(path.n_coordinates() + 1);
  CHECK_THROWS_AS(path.gradient(kinematics, workspace, g), std::invalid_argument);
}
