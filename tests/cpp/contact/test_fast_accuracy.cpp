// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>

#include "condyle/contact/fast_accuracy.hpp"
#include "condyle/contact/fast_evaluation.hpp"
#include "condyle/geometry/mesh_file.hpp"
#include "contact/fast_fixture.hpp"
#include "support/shared_data.hpp"

namespace condyle::contact {
namespace {

// Another evaluation with its wrench scaled: a deviation known beforehand.
class Scaled final : public FaceEvaluation {
 public:
  Scaled(const FaceEvaluation& inner, double factor) : inner_(inner), factor_(factor) {}
  SideLoads evaluate(const Pose& pose, Side side, Derivatives derivatives) const override {
    SideLoads loads = inner_.evaluate(pose, side, derivatives);
    loads.wrench *= factor_;
    return loads;
  }
  FacePressure face_pressure(const Pose& pose, Side side) const override {
    return inner_.face_pressure(pose, side);
  }

 private:
  const FaceEvaluation& inner_;
  double factor_;
};

TEST_CASE("[oracle] a known deviation is reported as such") {
  const test::TorusPair pair(41, 1.5e-3, 20);
  const auto fast = make_fast_evaluation(pair.field, pair.compartments, ContactLaw{});
  const std::vector<Pose> poses(3, pair.pose);
  const AccuracyReport same = measure_accuracy(*fast, *fast, poses, 1);
  CHECK(same.sides == 6);
  CHECK(same.force_p99 == 0.0);
  CHECK(same.worst == 0.0);
  const AccuracyReport off = measure_accuracy(Scaled(*fast, 1.003), *fast, poses, 1);
  CHECK(off.force_median == doctest::Approx(0.003).epsilon(1e-9));
  CHECK(off.moment_p99 == doctest::Approx(0.003).epsilon(1e-9));
  CHECK(off.worst > 0.5);
  CHECK(off.worst_pose == pair.pose);
}

TEST_CASE("[error] an empty range of plausible poses is refused by name") {
  const test::TorusPair pair(41, 1.5e-3, 10);
  const auto fast = make_fast_evaluation(pair.field, pair.compartments, ContactLaw{});
  PlausiblePoses none;
  none.count = 0;
  CHECK_THROWS_WITH_AS(plausible_poses(*fast, none),
                       "plausible poses: count is 0.000000: must be at least 1",
                       std::invalid_argument);
  PlausiblePoses negative;
  negative.lowest_force = -1.0;
  CHECK_THROWS_AS(plausible_poses(*fast, negative), std::invalid_argument);
}

TEST_CASE("[property] fast is within its tolerance of exact on a real implant") {
  CONDYLE_REQUIRE_DATA(data);
  const auto implant = data / "implants" / "dm";
  const auto read = [&](const char* file) {
    return geometry::read_mesh(implant / file, geometry::LengthUnit::kMetre);
  };
  const geometry::TriangleMesh femur = read("femur_contact.stl");
  const Compartments compartments{compartment_faces(read("insert_contact_medial.stl")),
                                  compartment_faces(read("insert_contact_lateral.stl"))};
  FastSettings settings;
  settings.field.spacing = 0.5e-3;  // coarser than the default, for the time it takes
  settings.threads = 1;
  const auto fast = make_fast_evaluation(femur, compartments, ContactLaw{}, settings);
  const auto exact = make_exact_evaluation(femur, compartments, ContactLaw{});
  PlausiblePoses box;
  box.settled << 6.404e-3, 41.107e-3, -0.218e-3, 0, 0, 0;
  box.count = 60;
  const std::vector<Pose> poses = plausible_poses(*fast, box);
  const AccuracyReport report = measure_accuracy(*fast, *exact, poses, 1);
  CAPTURE(report.force_p99);
  CAPTURE(report.worst_pose.transpose());
  CHECK(report.sides > 80);
  // What is left is the mesh's facets, which the spline rounds: seen 0.06 % and 0.9 %, 1.3 × the
  // tolerance.
  CHECK(report.force_median < 0.0012);
  CHECK(report.moment_median < 0.0015);
  CHECK(report.force_tolerance_p99 < 2.0);
  CHECK(report.moment_tolerance_p99 < 2.0);
}

}  // namespace
}  // namespace condyle::contact
