// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "condyle/model/path_route.hpp"
#include "support/path_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// One body that does not move, with two parallel cylinders of radii 0.03 and 0.02 along z, 0.2
/// apart in x.
ModelDescription two_cylinders() {
  ModelDescription m;
  m.name = "belt";
  m.wraps = {test::cylinder("left", kGround, {-0.1, 0.0, 0.0}, Vector3::Zero(), 0.03),
             test::cylinder("right", kGround, {0.1, 0.0, 0.0}, Vector3::Zero(), 0.02)};
  return m;
}

PathDescription over(const Vector3& from, const Vector3& to, std::vector<std::string> wraps) {
  PathDescription p;
  p.points = {test::point(kGround, from), test::point(kGround, to)};
  for (const std::string& wrap : wraps) p.wraps.push_back({wrap, "hybrid", -1, -1});
  return p;
}

}  // namespace

TEST_CASE("over two parallel cylinders the line is the belt's, also where it climbs [oracle]") {
  const Model model(two_cylinders());
  Kinematics kinematics(model);
  kinematics.set(Eigen::VectorXd(0));
  // From the left over both to the right: tangents of each end, two arcs, and the outer tangent
  // between the circles.
  const Vector3 a(-0.25, 0.011, -0.02), b(0.21, 0.007, 0.05);
  const double gap = 0.2, rise = 0.03 - 0.02;
  const double between = std::sqrt(gap * gap - rise * rise), lean = std::asin(rise / gap);
  const auto end = [](const Vector3& p, double x, double r) {
    const double dx = std::abs(p.x() - x), rho = std::hypot(dx, p.y());
    // Angle of the outward tangent point's radius from the vertical.
    const double from_vertical = 0.5 * std::numbers::pi + std::atan2(-p.y(), dx) - std::acos(r / rho);
    return std::pair(std::sqrt(rho * rho - r * r), from_vertical);
  };
  const auto [run_a, angle_a] = end(a, -0.1, 0.03);
  const auto [run_b, angle_b] = end(b, 0.1, 0.02);
  const double s = run_a + 0.03 * (angle_a + lean) + between + 0.02 * (angle_b - lean) + run_b;
  PathWorkspace workspace;
  for (const auto& order :
       {std::vector<std::string>{"left", "right"}, std::vector<std::string>{"right", "left"}}) {
    const Path path(model, over(a, b, order), "belt");
    // Points of contact within 1e-12 m of standing still: length by second order.
    CHECK(std::abs(path.length(kinematics, workspace) - std::hypot(s, 0.07)) < 1e-14);
    CHECK(workspace.spans.size() == 2);
    CHECK(workspace.n_free == 1);
  }
}

TEST_CASE(
    "nodes are in order, spans join them, and the free node is on the straight part [property]") {
  const Model model(two_cylinders());
  Kinematics kinematics(model);
  kinematics.set(Eigen::VectorXd(0));
  const Path path(model, over({-0.25, 0.011, -0.02}, {0.21, 0.007, 0.05}, {"left", "right"}),
                  "belt");
  PathWorkspace w;
  path.length(kinematics, w);
  REQUIRE(w.spans.size() == 2);
  CHECK(w.spans[0].a == 0);
  CHECK(w.spans[0].b == w.spans[1].a);
  CHECK(w.spans[0].length + w.spans[1].length == doctest::Approx(w.length).epsilon(1e-15));
  const PathNode& free = w.nodes[at(w.spans[0].b)];
  CHECK(free.free == 0);
  // Stationary in the free node: the two spans pull it opposite ways.
  const Vector3 before = w.X_GC[0].R * w.spans[0].line.by_b,
                behind = w.X_GC[1].R * w.spans[1].line.by_a;
  CHECK((before + behind).norm() < 1e-10);
  CHECK(std::abs(free.sideways[0].dot(before)) < 1e-10);
}

TEST_CASE(
    "a cylinder takes the segment that it is pierced by before one that it forces aside "
    "[property]") {
  ModelDescription m = two_cylinders();
  m.wraps.resize(1);
  m.wraps[0].quadrant = "y";
  const Model model(m);
  Kinematics kinematics(model);
  kinematics.set(Eigen::VectorXd(0));
  // First segment below the cylinder (on the wrong side), second one through it.
  PathDescription p = over({-0.3, -0.1, 0.0}, {0.0, -0.09, 0.0}, {"left"});
  p.points.push_back(test::point(kGround, {-0.16, 0.07, 0.0}));
  PathWorkspace w;
  const Path both(model, p, "path");
  both.length(kinematics, w);
  REQUIRE(w.spans.size() == 2);
  CHECK(w.spans[0].cylinder == -1);
  CHECK(w.spans[1].cylinder == 0);
  // Without the second segment, the first is forced around.
  p.points.pop_back();
  const Path first(model, p, "path");
  const double forced = first.length(kinematics, w);
  CHECK(w.spans[0].cylinder == 0);
  CHECK(forced > Vector3(0.3, 0.01, 0.0).norm() + 0.05);
}

TEST_CASE("an end inside a cylinder leaves the segment straight [property]") {
  const Model model(two_cylinders());
  Kinematics kinematics(model);
  kinematics.set(Eigen::VectorXd(0));
  const Vector3 a(-0.25, 0.01, 0.0), b(-0.09, 0.01, 0.03);
  const Path path(model, over(a, b, {"left", "right"}), "path");
  PathWorkspace w;
  CHECK(path.length(kinematics, w) == doctest::Approx((b - a).norm()).epsilon(1e-15));
  CHECK(held_slot(path, {-1, Vector3::Zero()}) == 0);
}
