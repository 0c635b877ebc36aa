// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "condyle/contact/mesh_contact.hpp"
#include "condyle/geometry/mesh_file.hpp"
#include "condyle/io/table.hpp"
#include "contact/contact_fixtures.hpp"
#include "support/shared_data.hpp"

using namespace condyle;
using namespace condyle::contact;
using std::numbers::pi;

namespace {

constexpr double kModulus = 9.3e9;

MeshContact notched_contact(SideOfBody side = SideOfBody::kRight) {
  const InsertMeshes insert = test::dished_insert(44);
  if (side == SideOfBody::kRight) return {test::notched_femur(), insert, side};
  return {test::mirrored(test::notched_femur()),
          {test::mirrored(insert[kMedial]), test::mirrored(insert[kLateral])},
          side};
}

double total_energy(const MeshContact& contact, const Pose& pose) {
  const ContactDetail detail = contact.evaluate_detail(pose);
  return detail.sides[kMedial].energy + detail.sides[kLateral].energy;
}

const MeshContact& dm_contact(const std::filesystem::path& data) {
  static const MeshContact contact = [&] {
    const auto folder = data / "implants" / "dm";
    const auto unit = geometry::LengthUnit::kMetre;
    return MeshContact(
        geometry::read_mesh(folder / "femur_contact.stl", unit),
        split_insert(geometry::read_mesh(folder / "insert_contact.stl", unit), SideOfBody::kRight),
        SideOfBody::kRight);
  }();
  return contact;
}

Pose pose_of(const io::Table& table, std::size_t row) {
  Pose pose;
  int i = 0;
  for (const char* column : {"x", "y", "z", "theta_x", "theta_y", "theta_z"})
    pose[i++] = table.column(column)[row];
  return pose;
}

}  // namespace

TEST_CASE(
    "two spheres pressed into planes: volume, force and moment in closed form, error falling with "
    "the square of "
    "the mesh size") {
  // d = R − |c − s| over the plane, h = R − δ the centre's height above it:
  //   volume π δ² (R − 2δ/3), force K π δ² (R − δ) along y, through the centre.
  const double R[] = {0.0213, 0.0187};
  const Vector3 s[] = {{0.003, 0.005, -0.020}, {-0.002, 0.0034, 0.0215}};
  Pose pose;
  pose << 0.004, 0.0, 0.001, 0.02, -0.31, -0.47;
  const Matrix3 R_TF = rotation_TF(pose);
  pose[kY] = test::kPlaneHeight + R[0] - 0.0014 - (R_TF * s[0]).y();
  double worst_before = 0.0;
  for (const int levels : {3, 4}) {
    CAPTURE(levels);
    const auto femur = test::joined(test::shifted(test::sphere(R[0], levels), s[0]),
                                    test::shifted(test::sphere(R[1], levels), s[1]));
    const MeshContact contact(femur, test::plane_insert(110, 0.018), SideOfBody::kRight);
    const ContactDetail detail = contact.evaluate_detail(pose);
    double worst = 0.0;
    for (const Side side : {kMedial, kLateral}) {
      const Vector3 centre = pose.head<3>() + R_TF * s[side];
      const double depth = R[side] - (centre.y() - test::kPlaneHeight);
      REQUIRE(depth > 0.0005);
      const double volume = pi * depth * depth * (R[side] - 2.0 * depth / 3.0);
      const Vector3 force(0.0, kModulus * pi * depth * depth * (R[side] - depth), 0.0);
      const auto& found = detail.sides[side];
      // Edges of a sphere cut `levels` times are 1.2 R / 2^levels at most; its faces lie up to a
      // third of their square over 2R below it. The volume's slope over depth is 2/depth.
      const double edge = 1.2 * R[side] / (1 << levels), sag = edge * edge / (6.0 * R[side]);
      const double bound = 2.0 * sag / depth;
      CHECK(found.volume == doctest::Approx(volume).epsilon(bound));
      CHECK((found.wrench.head<3>() - force).norm() < bound * force.norm());
      CHECK((found.wrench.tail<3>() - (R_TF * s[side]).cross(force)).norm() <
            bound * force.norm() * R[side]);
      CHECK(std::abs(found.max_depth - depth) < 1.5 * sag + 1e-6);
      // Pressures act along directions up to acos(1 − δ/R) off the resultant's.
      CHECK(found.mean_pressure * found.area >= found.wrench[1]);
      CHECK(found.mean_pressure * found.area * (1.0 - depth / R[side]) <= found.wrench[1]);
      CHECK(found.peak_pressure == doctest::Approx(kModulus * found.max_depth).epsilon(1e-12));
      CHECK(
          (found.centre_of_pressure - Vector3(centre.x(), test::kPlaneHeight, centre.z())).norm() <
          2e-4);
      worst = std::max(worst, std::abs(found.volume / volume - 1.0));
    }
    if (levels == 4)
      CHECK(worst < 0.35 * worst_before);  // 1/4, and what the plane's own squares leave
    worst_before = worst;
    CHECK(detail.status == "ok");
  }
}

TEST_CASE(
    "the wrench is the gradient of the energy, and the stiffness that of the wrench, in general "
    "poses") {
  const MeshContact contact = notched_contact();
  test::Draw draw(101);
  for (int trial = 0; trial < 6; ++trial) {
    const Pose pose = test::pressed_pose(draw);
    const ContactLoads loads = contact.evaluate(pose, Derivatives::kStiffness);
    const double force = loads.total_wrench().head<3>().norm();
    REQUIRE(loads.wrench[kMedial][1] > 50.0);
    REQUIRE(loads.wrench[kLateral][1] > 50.0);
    REQUIRE(contact.evaluate_detail(pose).sides[kMedial].border_area == 0.0);
    CHECK(loads.total_wrench() == contact.evaluate(pose, Derivatives::kNone).total_wrench());
    const Vector6 generalised = generalised_force(pose, loads.total_wrench());
    Matrix6 stiffness;
    for (int i = 0; i < 6; ++i) {
      // The energy is C1 with second derivatives that jump where a face enters or changes feature:
      // a difference is off by the step times the jump, one face in a thousand of the stiffness at
      // a time: 1e-3 h/d = 1e-6 for d = 1 mm.
      const double h = i < 3 ? 2e-7 : 1e-5, arm = i < 3 ? 1.0 : 0.02;
      Pose ahead = pose, behind = pose;
      ahead[i] += h;
      behind[i] -= h;
      const double slope =
          (total_energy(contact, ahead) - total_energy(contact, behind)) / (2.0 * h);
      CHECK(std::abs(generalised[i] + slope) < 1e-5 * force * arm);
      stiffness.col(i) = (contact.evaluate(ahead, Derivatives::kNone).total_wrench() -
                          contact.evaluate(behind, Derivatives::kNone).total_wrench()) /
                         (2.0 * h);
    }
    // Here a jump shows in full: a few of thousand faces whose feature changes within the step.
    CHECK((stiffness - loads.total_stiffness()).norm() < 2e-3 * stiffness.norm());
    const Matrix6 q = generalised_stiffness(pose, loads.total_wrench(), loads.total_stiffness());
    CHECK((q - q.transpose()).norm() < 1e-10 * q.norm());
  }
}

TEST_CASE(
    "where the femur's frame stands does not matter: same force, moment about the new origin") {
  const MeshContact contact = notched_contact();
  test::Draw draw(7);
  const Pose pose = test::pressed_pose(draw);
  RigidTransform X_FG;  // a new femoral frame G, turned little enough for "lowest" to stay lowest
  X_FG.R = (Eigen::AngleAxisd(0.21, Vector3::UnitX()) * Eigen::AngleAxisd(-0.34, Vector3::UnitY()) *
            Eigen::AngleAxisd(0.17, Vector3::UnitZ()))
               .toRotationMatrix();
  X_FG.p = {0.013, -0.024, 0.031};
  const MeshContact other(test::moved(contact.femur(), X_FG.inverse()), contact.insert(),
                          SideOfBody::kRight);
  const RigidTransform X_TG = transform_TF(pose) * X_FG;
  const ContactLoads a = contact.evaluate(pose, Derivatives::kNone);
  const ContactLoads b = other.evaluate(pose_from_transform(X_TG), Derivatives::kNone);
  for (const Side side : {kMedial, kLateral}) {
    const Vector3 force = a.wrench[side].head<3>();
    const Vector3 moment = a.wrench[side].tail<3>() + (pose.head<3>() - X_TG.p).cross(force);
    // Depths of 1e-3 out of coordinates of 0.05 carry 1e-14 of rounding, summed over a thousand
    // faces.
    CHECK((b.wrench[side].head<3>() - force).norm() < 1e-11 * force.norm());
    CHECK((b.wrench[side].tail<3>() - moment).norm() < 1e-12 * force.norm());
  }
}

TEST_CASE(
    "the insert feels the opposite of the femur: forces balance with pressures on its faces") {
  const MeshContact contact = notched_contact();
  test::Draw draw(9);
  const Pose pose = test::pressed_pose(draw);
  const ContactDetail detail = contact.evaluate_detail(pose);
  for (const Side side : {kMedial, kLateral}) {
    const FacePressure faces = contact.face_pressure(pose, side);
    const SurfaceFaces insert = surface_faces(contact.insert()[side]);
    const auto& found = detail.sides[side];
    const double normal_force = faces.pressure.dot(insert.areas);
    CHECK(faces.depth.dot(insert.areas) == doctest::Approx(found.volume).epsilon(1e-12));
    CHECK((faces.depth.array() > 0.0).select(insert.areas, 0.0).sum() ==
          doctest::Approx(found.area).epsilon(1e-12));
    CHECK(faces.depth.maxCoeff() == found.max_depth);
    CHECK(faces.pressure.maxCoeff() == found.peak_pressure);
    CHECK(found.mean_pressure == doctest::Approx(normal_force / found.area).epsilon(1e-12));
    const Vector3 centre =
        insert.centroids.transpose() * faces.pressure.cwiseProduct(insert.areas) / normal_force;
    CHECK((centre - found.centre_of_pressure).norm() < 1e-15);
    // A force per face along one unit direction each: the resultant cannot exceed their sum.
    CHECK(found.wrench.head<3>().norm() <= normal_force * (1.0 + 1e-12));
    CHECK(found.wrench[1] > 0.9 * normal_force);
  }
}

TEST_CASE("out of contact everything is exactly zero") {
  const MeshContact contact = notched_contact();
  Pose pose = Pose::Zero();
  pose << 0.004, 0.03, -0.001, 0.02, -0.05, -0.4;
  const ContactLoads loads = contact.evaluate(pose, Derivatives::kStiffness);
  CHECK(loads.total_wrench() == Wrench::Zero());
  CHECK(loads.total_stiffness() == Matrix6::Zero());
  CHECK(!loads.implausible_depth);
  CHECK(loads.trust == 1.0);
  const ContactDetail detail = contact.evaluate_detail(pose);
  for (const auto& side : detail.sides) {
    CHECK(side.energy + side.volume + side.area + side.max_depth + side.mean_pressure +
              side.border_area ==
          0.0);
  }
  CHECK(detail.status == "ok");
}

TEST_CASE(
    "the mirror image of a right knee is a left knee with the same medial and lateral loads") {
  const MeshContact right = notched_contact(), left = notched_contact(SideOfBody::kLeft);
  test::Draw draw(13);
  for (int trial = 0; trial < 4; ++trial) {
    const Pose pose = test::pressed_pose(draw);
    const ContactLoads a = right.evaluate(pose, Derivatives::kNone),
                       b = left.evaluate(test::mirrored(pose), Derivatives::kNone);
    for (const Side side : {kMedial, kLateral}) {
      Wrench mirrored = a.wrench[side];
      for (const int i : {2, 3, 4}) mirrored[i] = -mirrored[i];
      CHECK((b.wrench[side] - mirrored).norm() < 1e-11 * mirrored.norm());
      CHECK(mirrored.norm() > 10.0);
    }
  }
}

TEST_CASE("overlap beyond the open border is reported and does not count") {
  // A plane femoral patch 12 mm wide pressed 1 mm into planes 22 mm wide.
  const auto down = [](double z) {
    return test::reversed(test::patch(0.0, z, 0.006, 6, [](double, double) { return 0.0; }));
  };
  const MeshContact contact(test::joined(down(-0.021), down(0.021)), test::plane_insert(44),
                            SideOfBody::kRight);
  Pose pose = Pose::Zero();
  pose[kX] = 0.004;
  pose[kY] = test::kPlaneHeight - 0.001;
  const ContactDetail detail = contact.evaluate_detail(pose);
  for (const auto& side : detail.sides) {
    CHECK(side.area == doctest::Approx(0.012 * 0.012).epsilon(1e-9));
    CHECK(side.border_area == doctest::Approx(0.022 * 0.022 - 0.012 * 0.012).epsilon(1e-9));
    CHECK(side.wrench[1] == doctest::Approx(kModulus * 0.001 * 0.012 * 0.012).epsilon(1e-9));
  }
  CHECK(detail.status ==
        "medial: 340 mm^2 of overlap beyond the femoral surface's border left out; "
        "lateral: 340 mm^2 of overlap beyond the femoral surface's border left out");
}

TEST_CASE("an overlap that is too deep, or comes out at the back, is flagged and finite") {
  const auto femur =
      test::joined(test::shifted(test::box({0.012, 0.005, 0.012}), {0.004, 0.0, -0.021}),
                   test::shifted(test::box({0.012, 0.005, 0.012}), {0.004, 0.0, 0.021}));
  const MeshContact contact(femur, test::plane_insert(10), SideOfBody::kRight);
  Pose pose = Pose::Zero();
  pose[kY] = test::kPlaneHeight + 0.005 - 0.0025;
  CHECK(contact.evaluate(pose, Derivatives::kStiffness).implausible_depth);
  CHECK(contact.evaluate_detail(pose).status ==
        "medial: depth 2.5 mm is more than the plausible 2 mm; "
        "lateral: depth 2.5 mm is more than the plausible 2 mm");
  pose[kY] = test::kPlaneHeight - 0.005 + 0.0015;  // the plane is 1.5 mm below the top of the boxes
  const ContactLoads through = contact.evaluate(pose, Derivatives::kStiffness);
  CHECK(through.implausible_depth);
  CHECK(through.total_wrench().allFinite());
  CHECK(through.total_stiffness().allFinite());
  CHECK(contact.evaluate_detail(pose).status ==
        "medial: overlap reaches a back face; lateral: overlap reaches a back face");
  pose[kY] = test::kPlaneHeight + 0.005 - 0.0015;
  CHECK(!contact.evaluate(pose, Derivatives::kStiffness).implausible_depth);
}

TEST_CASE("a batch is its poses one by one, whatever the number of threads") {
  const MeshContact contact = notched_contact();
  test::Draw draw(19);
  std::vector<Pose> poses;
  for (int i = 0; i < 24; ++i) poses.push_back(test::pressed_pose(draw));
  std::vector<ContactLoads> one(poses.size()), three(poses.size());
  contact.evaluate_batch(poses, Derivatives::kStiffness, 1, one);
  contact.evaluate_batch(poses, Derivatives::kStiffness, 3, three);
  const auto details = contact.evaluate_details(poses, 3);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CHECK(one[i].wrench == three[i].wrench);
    CHECK(one[i].stiffness == three[i].stiffness);
    CHECK(one[i].wrench[kMedial] == contact.evaluate(poses[i], Derivatives::kNone).wrench[kMedial]);
    CHECK(details[i].sides[kLateral].wrench == one[i].wrench[kLateral]);
  }
  poses[5][kThetaY] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(contact.evaluate_details(poses, 1),
                       "row 5: pose: theta_y is nan: must be finite", std::invalid_argument);
  CHECK_THROWS_AS(contact.face_pressure(poses[5], kMedial), std::invalid_argument);
}

TEST_CASE("settings out of range and unknown names are refused") {
  MeshContactSettings settings;
  settings.plausible_depth = -0.002;
  CHECK_THROWS_WITH_AS(
      MeshContact(test::notched_femur(), test::plane_insert(4), SideOfBody::kRight, {}, settings),
      "plausible_depth is -0.002000 m: must be finite and greater than 0", std::invalid_argument);
  CHECK_THROWS_WITH_AS(evaluation_from_name("rough"),
                       "evaluation is 'rough': must be 'exact' or 'fast'", std::invalid_argument);
  for (const Evaluation e : {Evaluation::kExact, Evaluation::kFast})
    CHECK(evaluation_from_name(name(e)) == e);
}

TEST_CASE("the real implant: loads agree with those of two independent programs") {
  CONDYLE_REQUIRE_DATA(data);
  const io::Table table = io::read_table(data / "checks" / "dm_loads.csv");
  const MeshContact& contact = dm_contact(data);
  REQUIRE(table.row_count() == 20);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    CAPTURE(row);
    const ContactDetail detail = contact.evaluate_detail(pose_of(table, row));
    CHECK(detail.status == "ok");
    for (const Side side : {kMedial, kLateral}) {
      const auto column = [&](const char* what) {
        return table.column(std::string(name(side)) + "_" + what)[row];
      };
      const Vector3 force(column("Fx"), column("Fy"), column("Fz")),
          moment(column("Mx"), column("My"), column("Mz"));
      const auto& found = detail.sides[side];
      // The file carries six digits, and its two makers agree within 4e-6.
      CHECK((found.wrench.head<3>() - force).cwiseAbs().maxCoeff() <= 1e-4 * force.norm() + 0.01);
      CHECK((found.wrench.tail<3>() - moment).cwiseAbs().maxCoeff() <=
            1e-4 * moment.norm() + 0.001);
      CHECK(std::abs(found.volume - column("volume")) <= 1e-4 * column("volume"));
      CHECK(std::abs(found.area - column("area")) <= 1e-4 * column("area"));
      CHECK(std::abs(found.max_depth - column("max_depth")) <= 1e-4 * column("max_depth"));
      if (force.norm() == 0.0) CHECK(found.wrench == Wrench::Zero());
    }
  }
}

TEST_CASE("the real implant mirrored is a left knee with the same loads") {
  CONDYLE_REQUIRE_DATA(data);
  const MeshContact& right = dm_contact(data);
  const MeshContact left(
      test::mirrored(right.femur()),
      {test::mirrored(right.insert()[kMedial]), test::mirrored(right.insert()[kLateral])},
      SideOfBody::kLeft);
  const io::Table table = io::read_table(data / "checks" / "dm_poses.csv");
  for (std::size_t row = 0; row < table.row_count(); row += 3) {
    const Pose pose = pose_of(table, row);
    const ContactLoads a = right.evaluate(pose, Derivatives::kNone),
                       b = left.evaluate(test::mirrored(pose), Derivatives::kNone);
    for (const Side side : {kMedial, kLateral}) {
      Wrench mirrored = a.wrench[side];
      for (const int i : {2, 3, 4}) mirrored[i] = -mirrored[i];
      // Rounding, and ties between neighbouring features that fall the other way: both below 1e-14
      // m in depth.
      CHECK((b.wrench[side] - mirrored).norm() <= 1e-9 * mirrored.norm());
    }
  }
}
