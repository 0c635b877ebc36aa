// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <atomic>
#include <limits>
#include <stdexcept>

#include "condyle/surrogate/hybrid_contact_model.hpp"
#include "support/random_pose.hpp"

using condyle::kMedial;
using condyle::Pose;
using condyle::SideOfBody;
using condyle::contact::ContactLoads;
using condyle::contact::ContactModel;
using condyle::contact::Derivatives;
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

}  // namespace

TEST_CASE("the reference is called where trust is below a half, counted and logged [property]") {
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
