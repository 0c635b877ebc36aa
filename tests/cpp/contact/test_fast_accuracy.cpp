// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "condyle/contact/fast_accuracy.hpp"
#include "condyle/contact/mesh_contact.hpp"
#include "condyle/geometry/mesh_file.hpp"
#include "support/shared_data.hpp"

namespace condyle::contact {
namespace {

// Two pillars, stiffer the deeper; the lateral one only where the femur is tilted towards it.
class Pillars final : public ContactModel {
 public:
  explicit Pillars(double scale = 1.0, double lateral_offset = 0.0)
      : scale_(scale), lateral_offset_(lateral_offset) {}
  SideOfBody side_of_body() const override { return SideOfBody::kRight; }
  ContactLoads evaluate(const Pose& pose, Derivatives) const override {
    ContactLoads loads;
    for (const Side side : {kMedial, kLateral}) {
      const double arm = side == kMedial ? -0.023 : 0.021;
      const double depth = kTop + arm * std::sin(pose[kThetaX]) - pose[kY];
      if (depth <= 0.0) continue;
      const double force = 3.1e9 * depth * depth + 1.7e5 * depth;
      loads.wrench[side] << 0.07 * force, force, 0.0, -arm * force, 0.0, 0.004 * force;
      loads.wrench[side] *= scale_;
      if (side == kLateral) loads.wrench[side][2] += lateral_offset_;
    }
    return loads;
  }
  static constexpr double kTop = 0.0413;

 private:
  double scale_, lateral_offset_;
};

PlausiblePoses some_poses() {
  PlausiblePoses box;
  box.settled << 0.0052, 0.0398, -0.0021, 0, 0, 0;
  box.count = 300;
  return box;
}

TEST_CASE("[oracle] a known deviation is reported as such, for sides and totals, at any load") {
  const auto poses = plausible_poses(Pillars(), some_poses(), 1);
  const AccuracyReport same = measure_accuracy(Pillars(), Pillars(), poses, 1);
  CHECK(same.total.count == 300);
  CHECK(same.total.force.worst == 0.0);
  CHECK(same.sides.moment.tolerance_worst == 0.0);

  const AccuracyReport off = measure_accuracy(Pillars(1.003), Pillars(), poses, 2);
  for (const WrenchDeviations* part : {&off.sides, &off.total}) {
    CHECK(part->force.median == doctest::Approx(0.003).epsilon(1e-9));
    CHECK(part->moment.p99 == doctest::Approx(0.003).epsilon(1e-9));
    // 0.3 % of a large force is 1.5 of the tolerance, less its absolute part.
    CHECK(part->force.tolerance_worst > 1.0);
    CHECK(part->force.tolerance_worst < 1.5);
    CHECK(part->force.tolerance_p99 <= part->force.tolerance_worst);
  }
  CHECK(off.sides.count > off.total.count);
  int in_ranges = 0;
  double before = 0.0;
  for (const LoadRange& range : off.by_load) {
    in_ranges += range.total.count;
    // The more load, the less the absolute part of the tolerance hides.
    CHECK(range.total.force.tolerance_worst > before);
    before = range.total.force.tolerance_worst;
  }
  CHECK(in_ranges == off.total.count);
}

TEST_CASE("[oracle] the worst pose is where error over tolerance is largest") {
  const auto poses = plausible_poses(Pillars(), some_poses(), 1);
  const Pillars exact, fast(1.0, 2.5);
  const AccuracyReport report = measure_accuracy(fast, exact, poses, 1);
  double worst = 0.0;
  Pose at = Pose::Zero();
  for (const Pose& pose : poses) {
    const double force = exact.evaluate(pose, {}).total_wrench().head<3>().norm();
    const bool lateral = !exact.evaluate(pose, {}).wrench[kLateral].isZero();
    const double ratio = lateral ? 2.5 / (0.002 * force + 0.5) : 0.0;
    if (ratio > worst) {
      worst = ratio;
      at = pose;
    }
  }
  CHECK(report.total.force.tolerance_worst == doctest::Approx(worst).epsilon(1e-9));
  CHECK(report.total.worst_pose == at);
}

TEST_CASE(
    "[property] plausible poses lie in their box and carry loads evenly spread in magnitude") {
  const Pillars model;
  const PlausiblePoses box = some_poses();
  const auto poses = plausible_poses(model, box, 1);
  REQUIRE(poses.size() == 300);
  CHECK(plausible_poses(model, box, 3) == poses);
  int below_geometric_mean = 0;
  for (const Pose& pose : poses) {
    CHECK(std::abs(pose[kX] - box.settled[kX]) <= box.x);
    CHECK(std::abs(pose[kZ] - box.settled[kZ]) <= box.z);
    CHECK(std::abs(pose[kThetaX]) <= box.theta_x);
    CHECK(std::abs(pose[kThetaY]) <= box.theta_y);
    CHECK(pose[kThetaZ] <= 0.0);
    CHECK(pose[kThetaZ] >= -box.flexion);
    const double force = model.evaluate(pose, Derivatives::kNone).total_wrench()[kY];
    CHECK(force >= 0.99 * box.lowest_force);
    CHECK(force <= 1.01 * box.highest_force);
    if (force < std::sqrt(box.lowest_force * box.highest_force)) ++below_geometric_mean;
  }
  // Binomial of 300 and ½: four standard deviations are 35.
  CHECK(std::abs(below_geometric_mean - 150) < 35);
}

TEST_CASE("poses that never carry their load are left out") {
  class Nothing final : public ContactModel {
    SideOfBody side_of_body() const override { return SideOfBody::kLeft; }
    ContactLoads evaluate(const Pose&, Derivatives) const override { return {}; }
  };
  CHECK(plausible_poses(Nothing(), some_poses(), 1).empty());
  CHECK(measure_accuracy(Nothing(), Nothing(), {}, 1).total.count == 0);
}

TEST_CASE("[error] an empty range of plausible poses is refused by name") {
  PlausiblePoses none;
  none.count = 0;
  CHECK_THROWS_WITH_AS(plausible_poses(Pillars(), none),
                       "plausible poses: count is 0.000000: must be at least 1",
                       std::invalid_argument);
  PlausiblePoses negative;
  negative.lowest_force = -1.0;
  CHECK_THROWS_AS(plausible_poses(Pillars(), negative), std::invalid_argument);
}

TEST_CASE("[property] fast is within its tolerance of exact on a real implant") {
  CONDYLE_REQUIRE_DATA(data);
  const auto implant = data / "implants" / "dm";
  const auto read = [&](const char* file) {
    return geometry::read_mesh(implant / file, geometry::LengthUnit::kMetre);
  };
  const geometry::TriangleMesh femur = read("femur_contact.stl");
  const InsertMeshes insert{read("insert_contact_medial.stl"), read("insert_contact_lateral.stl")};
  MeshContactSettings settings;
  const MeshContact exact(femur, insert, SideOfBody::kRight, ContactLaw{}, settings);
  settings.pair.evaluation = Evaluation::kFast;
  settings.pair.field.spacing = 0.5e-3;  // coarser than the default, for the time it takes
  settings.pair.threads = 1;
  const MeshContact fast(femur, insert, SideOfBody::kRight, ContactLaw{}, settings);
  PlausiblePoses box;
  box.settled << 6.404e-3, 41.107e-3, -0.218e-3, 0, 0, 0;
  box.count = 60;
  const std::vector<Pose> poses = plausible_poses(fast, box, 1);
  CHECK(poses.size() == 60);
  const AccuracyReport report = measure_accuracy(fast, exact, poses, 1);
  CAPTURE(report.sides.force.p99);
  CAPTURE(report.sides.worst_pose.transpose());
  CHECK(report.sides.count > 80);
  // What is left is the mesh's facets, which the spline rounds: seen 0.06 % and 0.9 %, 1.3 × the
  // tolerance.
  CHECK(report.sides.force.median < 0.0012);
  CHECK(report.sides.moment.median < 0.0015);
  CHECK(report.sides.force.tolerance_p99 < 2.0);
  CHECK(report.total.moment.tolerance_p99 < 2.0);
}

}  // namespace
}  // namespace condyle::contact
