// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "condyle/model/kinematics.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

Matrix3 turn(double angle, const Vector3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

RigidTransform frame(const FrameDescription& f) {
  return {turn(f.orientation_xyz.x(), Vector3::UnitX()) *
              turn(f.orientation_xyz.y(), Vector3::UnitY()) *
              turn(f.orientation_xyz.z(), Vector3::UnitZ()),
          f.translation};
}

double amount(const ModelDescription& d, const AxisDescription& axis, const Eigen::VectorXd& q) {
  double m = axis.constant;
  for (const TermDescription& term : axis.terms) {
    for (std::size_t c = 0; c < d.coordinates.size(); ++c) {
      if (d.coordinates[c].name == term.coordinate) m += term.function(q[static_cast<int>(c)])[0];
    }
  }
  return m;
}

// X_GB by the description's words alone: frames, slides in the parent frame, body-fixed turns, up
// to ground.
RigidTransform placement_by_hand(const ModelDescription& d, const std::string& body,
                                 const Eigen::VectorXd& q) {
  if (body == kGround) return {};
  for (const JointDescription& joint : d.joints) {
    if (joint.child.body != body) continue;
    RigidTransform across;
    for (const AxisDescription& axis : joint.translations) {
      across.p += amount(d, axis, q) * axis.axis.normalized();
    }
    for (const AxisDescription& axis : joint.rotations) {
      across.R = across.R * turn(amount(d, axis, q), axis.axis);
    }
    return placement_by_hand(d, joint.parent.body, q) * frame(joint.parent) * across *
           frame(joint.child).inverse();
  }
  throw std::logic_error("no joint of " + body);
}

Vector3 vee(const Matrix3& W) { return {W(2, 1), W(0, 2), W(1, 0)}; }

}  // namespace

TEST_CASE("placements are products of frames, slides and turns [oracle]") {
  test::Draw draw(11);
  for (std::uint64_t seed : {1, 2, 3}) {
    const Model model(test::random_model(seed));
    Kinematics kinematics(model);
    const test::Motion motion(draw, model.n_coordinates());
    kinematics.set(motion.q(0.3));
    for (int b = 0; b < model.n_bodies(); ++b) {
      const auto& name = model.description().bodies[static_cast<std::size_t>(b)].name;
      const RigidTransform by_hand = placement_by_hand(model.description(), name, kinematics.q());
      CAPTURE(name);
      // Some 40 products of rounded matrices of size 1.
      CHECK((kinematics.X_GB(b).R - by_hand.R).norm() < 1e-14);
      CHECK((kinematics.X_GB(b).p - by_hand.p).norm() < 2e-14);
    }
    CHECK(kinematics.X_GB(-1).R == Matrix3::Identity());
  }
}

TEST_CASE("dependent coordinates follow, whatever is given for them [property]") {
  const Model model(test::random_model(5));
  Kinematics kinematics(model);
  test::Draw draw(12);
  const test::Motion motion(draw, model.n_coordinates());
  Eigen::VectorXd q = motion.q(0.1);
  q[model.coordinate("q10")] = NAN;
  kinematics.set(q);
  const auto& couplings = model.couplings();
  const double q9 = couplings[0].function(q[model.coordinate("q3")])[0];
  CHECK(kinematics.q()[model.coordinate("q9")] == q9);
  CHECK(kinematics.q()[model.coordinate("q10")] == couplings[1].function(q9)[0]);
  for (const TermNow& term : kinematics.terms()) CHECK_FALSE(model.dependent(term.coordinate));
  CHECK(kinematics.coordinate(model.coordinate("q10")).independent == model.coordinate("q3"));
  CHECK(kinematics.coordinate(model.coordinate("q4")).independent == model.coordinate("q4"));
  CHECK(kinematics.coordinate(model.coordinate("q4")).slope == 1.0);
}

TEST_CASE(
    "twists and their rates are the derivatives of placements, through splines and couplings "
    "[derivative]") {
  test::Draw draw(13);
  for (std::uint64_t seed : {1, 2, 3}) {
    const Model model(test::random_model(seed));
    Kinematics now(model), later(model), earlier(model);
    const test::Motion motion(draw, model.n_coordinates());
    const double t = 0.37, h = 1e-5;
    const auto set = [&](Kinematics& k, double time) {
      k.set(motion.q(time), motion.qd(time), motion.qdd(time));
    };
    set(now, t), set(later, t + h), set(earlier, t - h);
    // Central differences: h² times a third derivative of some 1e3, and eps/h = 2e-11.
    const double tolerance = 1e-6;
    const auto close = [&](const Vector3& a, const Vector3& b) {
      return (a - b).norm() < tolerance * (1.0 + b.norm());
    };
    CHECK(((later.q() - earlier.q()) / (2 * h) - now.qd()).norm() < tolerance);
    CHECK(((later.qd() - earlier.qd()) / (2 * h) - now.qdd()).norm() < 10 * tolerance);
    for (int b = 0; b < model.n_bodies(); ++b) {
      const Matrix3 R_rate = (later.X_GB(b).R - earlier.X_GB(b).R) / (2 * h);
      const Vector3 p_rate = (later.X_GB(b).p - earlier.X_GB(b).p) / (2 * h);
      CHECK(now.twist(b).w.norm() > 0.1);
      CHECK(close(now.twist(b).w, vee(R_rate * now.X_GB(b).R.transpose())));
      CHECK(close(now.point_velocity(b, now.X_GB(b).p), p_rate));
      CHECK(close(now.twist_rate(b).w, (later.twist(b).w - earlier.twist(b).w) / (2 * h)));
      CHECK(close(now.twist_rate(b).v, (later.twist(b).v - earlier.twist(b).v) / (2 * h)));
    }
    CHECK(now.twist(-1).v.norm() == 0.0);
  }
}

TEST_CASE("a point's velocity is the sum over its axes of derivative times rate [property]") {
  const Model model(test::random_model(6));
  Kinematics kinematics(model);
  test::Draw draw(14);
  const test::Motion motion(draw, model.n_coordinates());
  kinematics.set(motion.q(0.2), motion.qd(0.2), motion.qdd(0.2));
  const Vector3 p = test::random_vector(draw, 2.0);
  for (int b = 0; b < model.n_bodies(); ++b) {
    Vector3 sum = Vector3::Zero();
    for (int a : model.axes_to(b)) {
      for (const TermNow& term : kinematics.terms(a)) {
        CHECK(term.axis == a);
        sum += kinematics.point_derivative(a, p) * term.slope * kinematics.qd()[term.coordinate];
      }
    }
    CHECK((sum - kinematics.point_velocity(b, p)).norm() < 1e-12 * (1.0 + sum.norm()));
  }
}

TEST_CASE(
    "slopes, curvatures and third derivatives of terms and coordinates are differences of one "
    "another [derivative]") {
  const Model model(test::random_model(7));
  Kinematics now(model), later(model), earlier(model);
  test::Draw draw(15);
  const test::Motion motion(draw, model.n_coordinates());
  const double h = 1e-5;
  for (int c = 0; c < model.n_coordinates(); ++c) {
    if (model.dependent(c)) continue;
    const Eigen::VectorXd q = motion.q(0.45), step = h * Eigen::VectorXd::Unit(q.size(), c);
    now.set(q), later.set(q + step), earlier.set(q - step);
    for (std::size_t k = 0; k < now.terms().size(); ++k) {
      const TermNow &term = now.terms()[k], &up = later.terms()[k], &down = earlier.terms()[k];
      if (term.coordinate != c) continue;
      CHECK(std::abs((up.slope - down.slope) / (2 * h) - term.curvature) < 1e-7);
      CHECK(std::abs((up.curvature - down.curvature) / (2 * h) - term.third) < 1e-6);
    }
    for (int d = 0; d < model.n_coordinates(); ++d) {
      const CoordinateNow& follows = now.coordinate(d);
      if (follows.independent != c) continue;
      CHECK(std::abs((later.q()[d] - earlier.q()[d]) / (2 * h) - follows.slope) < 1e-8);
    }
  }
}

TEST_CASE("placing without rates stands still [property]") {
  const Model model(test::random_model(8));
  Kinematics kinematics(model);
  test::Draw draw(16);
  const test::Motion motion(draw, model.n_coordinates());
  kinematics.set(motion.q(0.2), motion.qd(0.2), motion.qdd(0.2));
  CHECK(kinematics.twist(0).w.norm() > 0.0);
  const RigidTransform moving = kinematics.X_GB(0);
  kinematics.set(motion.q(0.2));
  CHECK(kinematics.twist(0).w.norm() == 0.0);
  CHECK(kinematics.twist_rate(0).v.norm() == 0.0);
  CHECK(kinematics.qd().norm() == 0.0);
  CHECK(kinematics.X_GB(0).R == moving.R);
}

TEST_CASE("coordinates of another number or without value are refused by name [error]") {
  ModelDescription d = test::random_model(9);
  d.source = "walker.json";
  const Model model(d);
  Kinematics kinematics(model);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(11);
  CHECK_THROWS_WITH_AS(kinematics.set(q.head(10)),
                       "walker.json: q has 10 values; the model has 11 coordinates",
                       std::invalid_argument);
  Eigen::VectorXd bad = q;
  bad[4] = NAN;
  CHECK_THROWS_WITH_AS(kinematics.set(bad),
                       "walker.json: q of coordinate 'q4' is nan; it must be finite",
                       std::invalid_argument);
  Eigen::VectorXd moved = q;
  moved[0] = 0.3;
  CHECK_THROWS_WITH_AS(kinematics.set(moved, q, bad),
                       "walker.json: qdd of coordinate 'q4' is nan; it must be finite",
                       std::invalid_argument);
  CHECK(kinematics.q()[0] == 0.0);  // as it was
}
