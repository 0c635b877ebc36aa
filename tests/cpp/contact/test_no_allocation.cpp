// SPDX-License-Identifier: Apache-2.0
// The fast contact allocates nothing per pose. In a program of its own, because it counts what
// operator new is asked for. The exact one is not held to it: CGAL's closest-point search allocates
// a queue for each query.
#include <doctest/doctest.h>

#include <array>
#include <span>
#include <vector>

#include "condyle/contact/mesh_contact.hpp"
#include "contact/contact_fixtures.hpp"
#include "support/count_allocations.hpp"

namespace condyle::contact {
namespace {

MeshContact some_contact(Integration integration) {
  MeshContactSettings settings;
  settings.pair.evaluation = Evaluation::kFast;
  settings.pair.integration = integration;
  settings.pair.field.spacing = 0.8e-3;
  settings.pair.threads = 1;
  return MeshContact(test::notched_femur(), test::dished_insert(24), SideOfBody::kRight,
                     ContactLaw{}, settings);
}

TEST_CASE("the counter counts") {
  CHECK(test::count_allocations([] { std::vector<double>(7).front() += 1.0; }) == 1);
}

TEST_CASE("a pose allocates nothing, alone or in a batch, over either body or both") {
  test::Draw draw(17);
  std::vector<Pose> poses;
  for (int i = 0; i < 40; ++i) poses.push_back(test::pressed_pose(draw));
  std::vector<double> wrench(poses.size() * 12), stiffness(poses.size() * 72);
  std::vector<double> trust(poses.size());
  std::array<bool, 40> implausible{};
  std::vector<ContactLoads> loads(poses.size());
  for (const auto integration : {Integration::kFixed, Integration::kMoving, Integration::kBoth}) {
    CAPTURE(static_cast<int>(integration));
    const MeshContact contact = some_contact(integration);
    double force = 0.0;
    CHECK(test::count_allocations([&] {
            for (const Pose& pose : poses) {
              force += contact.evaluate(pose, Derivatives::kStiffness).total_wrench()[kY];
            }
          }) == 0);
    CHECK(force > 100.0);  // they were in contact
    const LoadSpans spans{wrench, stiffness, {}, trust, implausible};
    CHECK(test::count_allocations([&] { contact.evaluate_into(poses, 1, spans); }) == 0);
    CHECK(test::count_allocations(
              [&] { contact.evaluate_batch(poses, Derivatives::kStiffness, 1, loads); }) == 0);
    // Threads cost some each, poses none.
    const std::span<double> few = std::span(wrench).first(48);
    const long fixed = test::count_allocations(
        [&] { contact.evaluate_into(std::span(poses).first(4), 2, {.wrench = few}); });
    CHECK(test::count_allocations([&] { contact.evaluate_into(poses, 2, {.wrench = wrench}); }) ==
          fixed);
  }
}

}  // namespace
}  // namespace condyle::contact
