// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "condyle/surrogate/hybrid_contact_model.hpp"
#include "support/random_pose.hpp"

using condyle::kMedial;
using condyle::Pose;
using condyle::SideOfBody;
using condyle::contact::ContactLoads;
using condyle::contact::ContactModel;
using condyle::contact::Derivatives;
using condyle::kLateral;
using condyle::Vector6;
using condyle::Wrench;
using condyle::surrogate::HybridContactModel;

namespace {

/// Fy is `force`; trusted where x < 0.37.
class Known final : public ContactModel {
 public:
  Known(double force, double untrusted, SideOfBody side = SideOfBody::kLeft)
      : force_(force), untrusted_(untrusted), side_(side) {}
  SideOfBody side_of_body() const override { return side_; }
  ContactLoads evaluate(const Pose& pose, Derivatives) const override {
    ++calls;
    ContactLoads loads;
    loads.wrench[kMedial][1] = force_;
    loads.trust = pose[0] < 0.37 ? 0.83 : untrusted_;
    return loads;
  }
  mutable std::atomic<int> calls = 0;

 private:
  double force_, untrusted_;
  SideOfBody side_;
};

Vector6 six(double a, double b, double c, double d, double e, double f) {
  return (Vector6() << a, b, c, d, e, f).finished();
}

// Trust falls by 1 over 4 µm of y, as where a load limits it: 0.5 at the pose 0.
const Vector6 kSlope = six(310.0, 2.5e5, -170.0, 23.0, -11.0, 7.0);

/// Loads that grow with the square of the depth, and a trust that is linear between 0 and 1.
class Elastic final : public ContactModel {
 public:
  explicit Elastic(double scale, bool reference) : scale_(scale), reference_(reference) {}
  SideOfBody side_of_body() const override { return SideOfBody::kRight; }
  ContactLoads evaluate(const Pose& pose, Derivatives derivatives) const override {
    ++calls;
    ContactLoads loads;
    const Vector6 along = six(0.11, -1.0, 0.07, 0.013, -0.002, 0.004);
    for (const auto side : {kMedial, kLateral}) {
      const double depth = 2e-4 * (1 + side) + along.dot(pose);
      const Wrench per_square = scale_ * six(-0.3e9, 2.1e10, 0.4e9, 3.1e8, -1.7e7, 2.3e7);
      loads.wrench[side] = per_square * depth * depth;
      if (derivatives == Derivatives::kStiffness) {
        loads.stiffness[side] = 2.0 * depth * per_square * along.transpose();
      }
      if (!reference_) loads.error[side] = six(1.5, 23.0, 2.5, 0.3, 0.07, 0.05) * (1 + side);
    }
    loads.trust = reference_ ? 1.0 : std::clamp(0.5 + kSlope.dot(pose), 0.0, 1.0);
    loads.implausible_depth = reference_ && pose[2] > 1e-4;
    return loads;
  }
  mutable std::atomic<int> calls = 0;

 private:
  double scale_;
  bool reference_;
};

struct Knee {
  std::shared_ptr<const Elastic> surrogate = std::make_shared<Elastic>(1.02, false);
  std::shared_ptr<const Elastic> reference = std::make_shared<Elastic>(1.0, true);
  HybridContactModel hybrid{surrogate, reference};
};

/// A general pose at which the surrogate's trust is `trust`.
Pose pose_of_trust(double trust, condyle::test::Draw& draw) {
  Pose pose;
  for (int i = 0; i < 3; ++i) pose[i] = draw(-2e-5, 2e-5);
  for (int i = 3; i < 6; ++i) pose[i] = draw(-1e-3, 1e-3);
  pose[1] += (trust - 0.5 - kSlope.dot(pose)) / kSlope[1];
  return pose;
}

}  // namespace

TEST_CASE("the reference is called where trust is low, counted and logged [property]") {
  const auto surrogate = std::make_shared<Known>(310.0, 0.21);
  const auto reference = std::make_shared<Known>(290.0, 1.0);
  const HybridContactModel hybrid(surrogate, reference);
  CHECK(hybrid.side_of_body() == SideOfBody::kLeft);
  condyle::test::Draw draw(77);
  std::vector<Pose> poses(2500);
  std::uint64_t outside = 0;
  for (Pose& pose : poses) {
    for (int i = 0; i < 6; ++i) pose[i] = draw(-1.3, 1.7);
    outside += pose[0] >= 0.37;
  }
  for (const int threads : {1, 3}) {
    std::vector<ContactLoads> loads(poses.size());
    const auto before = hybrid.reference_calls();
    hybrid.evaluate_batch(poses, Derivatives::kNone, threads, loads);
    CHECK(hybrid.reference_calls() - before == outside);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      wrong += loads[i].wrench[kMedial][1] != (poses[i][0] < 0.37 ? 310.0 : 290.0);
      wrong += loads[i].trust < 0.5;
    }
    CHECK(wrong == 0);
  }
  CHECK(reference->calls == static_cast<int>(2 * outside));
  const auto log = hybrid.log();
  CHECK(log.size() == HybridContactModel::kLogged);
  for (const auto& call : log) CHECK(call.trust == 0.21);
  CHECK(log.front().pose[0] >= 0.37);
}

TEST_CASE("between the levels loads are blended, outside they are one model's own [property]") {
  const Knee knee;
  condyle::test::Draw draw(5);
  for (int draws = 0; draws < 200; ++draws) {
    const double trust = draw(0.3, 1.0);
    const Pose pose = pose_of_trust(trust, draw);
    const ContactLoads found = knee.hybrid.evaluate(pose, Derivatives::kStiffness);
    const ContactLoads known = knee.surrogate->evaluate(pose, Derivatives::kStiffness);
    const ContactLoads truth = knee.reference->evaluate(pose, Derivatives::kStiffness);
    if (trust < 0.499 || trust > 0.751) {
      const ContactLoads& own = trust < 0.5 ? truth : known;
      CHECK(found.wrench == own.wrench);
      CHECK(found.stiffness == own.stiffness);
      CHECK(found.error == own.error);
      CHECK(found.trust == own.trust);
      continue;
    }
    const double s = std::clamp(4.0 * known.trust - 2.0, 0.0, 1.0);
    const double weight = s * s * (3.0 - 2.0 * s);
    for (const auto side : {kMedial, kLateral}) {
      const Wrench expected = (1.0 - weight) * truth.wrench[side] + weight * known.wrench[side];
      CHECK((found.wrench[side] - expected).norm() <= 1e-12 * expected.norm());
      // How far the blend is from the reference is within its bound where the surrogate's is.
      CHECK((found.error[side] - weight * known.error[side]).norm() <= 1e-12);
    }
    CHECK(found.trust == doctest::Approx(1.0 - weight * (1.0 - known.trust)).epsilon(1e-12));
    CHECK(found.trust >= 0.5);
    CHECK(found.implausible_depth == truth.implausible_depth);
  }
}

TEST_CASE("the wrench is continuous across both levels, and so is its slope [property]") {
  const Knee knee;
  condyle::test::Draw draw(6);
  // The two models are some 30 N apart; over 1e-7 of trust each changes by some µN.
  constexpr double kApart = 1e-7;
  for (const double level : {HybridContactModel::kTrusted, HybridContactModel::kTrustedAlone}) {
    for (int draws = 0; draws < 20; ++draws) {
      const Pose below = pose_of_trust(level - kApart, draw);
      Pose above = below;
      above[1] += 2.0 * kApart / kSlope[1];
      const ContactLoads low = knee.hybrid.evaluate(below, Derivatives::kStiffness);
      const ContactLoads high = knee.hybrid.evaluate(above, Derivatives::kStiffness);
      const Pose at = pose_of_trust(level, draw);
      const double jump = std::abs(knee.surrogate->evaluate(at, Derivatives::kNone).wrench[0][1] -
                                   knee.reference->evaluate(at, Derivatives::kNone).wrench[0][1]);
      CHECK(jump > 10.0);
      for (const auto side : {kMedial, kLateral}) {
        CHECK((high.wrench[side] - low.wrench[side]).cwiseAbs().maxCoeff() < 2e-4);
        // Halfway into the band the blend adds some 6·jump·slope = 4e7 N/m to the same entry.
        CHECK(std::abs(high.stiffness[side](1, 1) - low.stiffness[side](1, 1)) < 1e3);
      }
    }
  }
}

TEST_CASE("the stiffness of a blend is the derivative of its wrench [derivative]") {
  const Knee knee;
  condyle::test::Draw draw(7);
  double largest_part = 0.0;
  for (int draws = 0; draws < 40; ++draws) {
    const Pose pose = pose_of_trust(draw(0.52, 0.73), draw);
    const ContactLoads found = knee.hybrid.evaluate(pose, Derivatives::kStiffness);
    for (int j = 0; j < 6; ++j) {
      const double step = j < 3 ? 1e-10 : 1e-9;  // 1e-8 m already feels the weight's curvature
      Pose forth = pose, back = pose;
      forth[j] += step;
      back[j] -= step;
      const ContactLoads plus = knee.hybrid.evaluate(forth, Derivatives::kNone);
      const ContactLoads minus = knee.hybrid.evaluate(back, Derivatives::kNone);
      for (const auto side : {kMedial, kLateral}) {
        const Vector6 expected = (plus.wrench[side] - minus.wrench[side]) / (forth[j] - back[j]);
        const Vector6 difference = found.stiffness[side].col(j) - expected;
        // Rounding of some kN over the step, of 1e3 N/m and much more.
        const double limit = 1e-5 * expected.norm() + 2e-12 / step;
        CHECK(difference.norm() <= limit);
      }
    }
    const ContactLoads frozen = knee.reference->evaluate(pose, Derivatives::kStiffness);
    const double ratio = found.stiffness[kMedial](1, 1) / frozen.stiffness[kMedial](1, 1);
    largest_part = std::max(largest_part, std::abs(ratio - 1.0));
  }
  // What trust adds is no small thing.
  CHECK(largest_part > 0.2);
}

TEST_CASE("Newton finds the loads that a jump would step over [property]") {
  const Knee knee;
  const auto force = [&](const ContactModel& model, const Pose& pose) {
    return model.evaluate(pose, Derivatives::kNone).total_wrench()[1];
  };
  condyle::test::Draw draw(8);
  const Pose border = pose_of_trust(0.5, draw);
  const double low = force(*knee.reference, border), high = force(*knee.surrogate, border);
  REQUIRE(high > low + 20.0);
  // Above the border the reference bears less than `low`, below it the surrogate more than `high`.
  for (const double share : {0.1, 0.5, 0.9}) {
    const double wanted = low + share * (high - low);
    Pose pose = border;
    int iterations = 0;
    double residual = 0.0;
    for (; iterations < 12; ++iterations) {
      const ContactLoads loads = knee.hybrid.evaluate(pose, Derivatives::kStiffness);
      residual = loads.total_wrench()[1] - wanted;
      if (std::abs(residual) < 1e-9) break;
      pose[1] -= residual / loads.total_stiffness()(1, 1);
    }
    CHECK(std::abs(residual) < 1e-9);
    CHECK(iterations <= 8);
  }
}

TEST_CASE("calls in the band count, and a batch is the same as one by one [property]") {
  const Knee knee;
  condyle::test::Draw draw(9);
  std::vector<Pose> poses(300);
  std::vector<double> trusts;
  for (Pose& pose : poses) {
    pose = pose_of_trust(draw(0.2, 1.2), draw);
    const double trust = knee.surrogate->evaluate(pose, Derivatives::kNone).trust;
    if (trust < 0.75) trusts.push_back(trust);
  }
  REQUIRE(trusts.size() > 100);
  REQUIRE(trusts.size() < poses.size() - 50);
  std::vector<ContactLoads> alone;
  for (const Pose& pose : poses) {
    alone.push_back(knee.hybrid.evaluate(pose, Derivatives::kStiffness));
  }
  CHECK(knee.hybrid.evaluations() == poses.size());
  CHECK(knee.hybrid.reference_calls() == trusts.size());
  CHECK(knee.reference->calls == static_cast<int>(trusts.size()));
  for (const int threads : {1, 3}) {
    const HybridContactModel other(knee.surrogate, knee.reference);
    std::vector<ContactLoads> loads(poses.size());
    other.evaluate_batch(poses, Derivatives::kStiffness, threads, loads);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      wrong += loads[i].wrench != alone[i].wrench || loads[i].stiffness != alone[i].stiffness ||
               loads[i].error != alone[i].error || loads[i].trust != alone[i].trust;
    }
    CHECK(wrong == 0);
    CHECK(other.evaluations() == poses.size());
    CHECK(other.reference_calls() == trusts.size());
    const auto log = other.log();
    REQUIRE(log.size() == trusts.size());
    for (std::size_t i = 0; i < log.size(); ++i) CHECK(log[i].trust == trusts[i]);
  }
}

TEST_CASE("a trust that is not a number is none [property]") {
  const auto surrogate = std::make_shared<Known>(310.0, std::numeric_limits<double>::quiet_NaN());
  const auto reference = std::make_shared<Known>(290.0, 1.0);
  const HybridContactModel hybrid(surrogate, reference);
  const Pose pose = Pose::Constant(0.51);
  const ContactLoads loads = hybrid.evaluate(pose, Derivatives::kStiffness);
  CHECK(loads.wrench[kMedial][1] == 290.0);
  CHECK(loads.trust == 1.0);
}

TEST_CASE("unknown trust and unlike models are refused [error]") {
  const auto good = std::make_shared<Known>(1.5, 1.0);
  const auto right = std::make_shared<Known>(1.5, 1.0, SideOfBody::kRight);
  CHECK_THROWS_WITH_AS(HybridContactModel(good, nullptr),
                       "hybrid contact: a surrogate and a reference are needed",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(HybridContactModel(good, right),
                       "hybrid contact: the surrogate is of a left knee, the reference of a right",
                       std::invalid_argument);
}
