// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "condyle/geometry/mesh_file.hpp"
#include "condyle/geometry/mesh_repair.hpp"
#include "condyle/geometry/overlap_volume.hpp"
#include "geometry/shapes.hpp"
#include "support/random_pose.hpp"
#include "support/shared_data.hpp"

using namespace condyle;
using namespace condyle::geometry;

namespace {

// Rounding: corners of solids of a few centimetres, a general pose away, carry some 1e-17 m each;
// an overlap of a few millimetres is then good to 1e-14, and sums of a few thousand parts to 1e-12.
constexpr double kRounding = 1e-12;

RigidTransform general_placement(std::uint64_t seed) {
  test::Draw draw(seed);
  return transform_TF(test::general_pose(draw));
}

// The overlap of a, placed by X, with b, where both solids are given in frames of their own that
// lie in a general pose to the ones they were made in; the centroid comes back in b's first frame.
OverlapVolume overlap_in_general_pose(const TriangleMesh& a, const TriangleMesh& b,
                                      const RigidTransform& X) {
  const RigidTransform P = general_placement(3), Q = general_placement(8);
  auto result = overlap_volume(OverlapSolid(test::moved(a, P)), OverlapSolid(test::moved(b, Q)),
                               Q * X * P.inverse());
  result.centroid = Q.inverse() * result.centroid;
  return result;
}

Matrix3 rotation(double angle, const Vector3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

// Volume and first moment of the part of a mesh below y = level, by clipping its faces one by one;
// tetrahedra to a point of the plane, so that the cut itself adds nothing.
double volume_below(const TriangleMesh& mesh, double level) {
  const Vector3 apex(0.0, level, 0.0);
  double sixfold = 0.0;
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    std::vector<Vector3> kept;
    for (int k = 0; k < 3; ++k) {
      const Vector3 p = Vector3(mesh.vertices.row(mesh.faces(f, k))) - apex;
      const Vector3 q = Vector3(mesh.vertices.row(mesh.faces(f, (k + 1) % 3))) - apex;
      if (p.y() < 0.0) kept.push_back(p);
      if ((p.y() < 0.0) != (q.y() < 0.0)) kept.push_back(p + (q - p) * (p.y() / (p.y() - q.y())));
    }
    for (std::size_t k = 2; k < kept.size(); ++k) {
      sixfold += kept[0].dot(kept[k - 1].cross(kept[k]));
    }
  }
  return sixfold / 6.0;
}

std::string refusal(const TriangleMesh& mesh) {
  try {
    OverlapSolid solid(mesh, "femur");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// A prism over a polygon in (x, y), |z| < half, its ends cut by the given triangles.
TriangleMesh prism(const std::vector<std::pair<double, double>>& outline,
                   const std::vector<Eigen::Vector3i>& ends, double half) {
  std::vector<Vector3> v;
  std::vector<Eigen::Vector3i> f;
  const int n = static_cast<int>(outline.size());
  for (const double z : {-half, half}) {
    for (const auto& [x, y] : outline) v.emplace_back(x, y, z);
  }
  for (const auto& t : ends) {
    f.insert(f.end(), {{t[2], t[1], t[0]}, {t[0] + n, t[1] + n, t[2] + n}});
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    f.insert(f.end(), {{i, j, j + n}, {i, j + n, i + n}});
  }
  return test::mesh_of(v, f);
}

}  // namespace

TEST_CASE("two boxes, faces parallel: the box of the overlapping lengths, in its middle") {
  const Vector3 a(0.013, 0.021, 0.008), b(0.017, 0.009, 0.011), shift(0.022, -0.026, 0.014);
  const auto overlap =
      overlap_in_general_pose(test::box(a), test::box(b), {Matrix3::Identity(), shift});
  const Vector3 low = (shift - a).cwiseMax(-b), high = (shift + a).cwiseMin(b);
  CHECK(overlap.volume == doctest::Approx((high - low).prod()).epsilon(kRounding));
  CHECK((overlap.centroid - 0.5 * (low + high)).norm() < kRounding * 0.05);
  CHECK(overlap.status == OverlapStatus::kOk);
  CHECK(overlap.self_intersections == 0);
}

TEST_CASE("faces that lie in one plane: same box, stacked boxes, a box let into another") {
  const Vector3 a(0.013, 0.021, 0.008);
  const OverlapSolid box(test::box(a));
  const auto same = overlap_volume(box, box, {});
  CHECK(same.volume == doctest::Approx(8.0 * a.prod()).epsilon(kRounding));
  const auto stacked = overlap_volume(box, box, {Matrix3::Identity(), {0.0, 2.0 * a.y(), 0.0}});
  CHECK(stacked.volume == 0.0);
  const Vector3 b(0.004, 0.0105, 0.008);
  const auto flush =
      overlap_volume(OverlapSolid(test::box(b)), box, {Matrix3::Identity(), {0.003, 0.0105, 0.0}});
  CHECK(flush.volume == doctest::Approx(8.0 * b.prod()).epsilon(kRounding));
}

TEST_CASE("an edge pressed into a plane: the triangle of its depth times its length") {
  const double angle = 0.43, depth = 1.3e-3;
  const Vector3 half(0.013, 0.009, 0.008);
  const Matrix3 R = rotation(angle, Vector3::UnitZ());
  // The box's lowest edge, by `depth` below the top of a block.
  const double reach = half.x() * std::sin(angle) + half.y() * std::cos(angle);
  const auto overlap = overlap_in_general_pose(test::box(half), test::box({0.05, 0.03, 0.04}),
                                               {R, {0.002, 0.03 + reach - depth, 0.011}});
  const double section = 0.5 * depth * depth * (std::tan(angle) + 1.0 / std::tan(angle));
  CHECK(overlap.volume == doctest::Approx(section * 2.0 * half.z()).epsilon(kRounding * 10));
}

TEST_CASE("a corner pressed into a plane: a tetrahedron, δ³/(6 n₁n₂n₃), and its centroid") {
  const double depth = 1.7e-3;
  const Matrix3 R = rotation(0.7, {0.9, 0.2, 0.6});
  const Vector3 half(0.013, 0.021, 0.008), n = R.transpose() * Vector3::UnitY();
  REQUIRE(n.cwiseAbs().minCoeff() > 0.1);
  const Vector3 corner = -n.cwiseSign().cwiseProduct(half);  // the lowest one, in the box's frame
  const Vector3 p(0.001, 0.03 - depth - (R * corner).y(), -0.004);
  const auto overlap =
      overlap_in_general_pose(test::box(half), test::box({0.05, 0.03, 0.04}), {R, p});
  const double expected = std::pow(depth, 3) / (6.0 * std::abs(n.prod()));
  CHECK(overlap.volume == doctest::Approx(expected).epsilon(kRounding * 10));
  const Vector3 legs = depth * n.cwiseInverse();  // along the box's edges, to the plane
  CHECK((overlap.centroid - (R * (corner + 0.25 * legs) + p)).norm() < 1e-15);
}

TEST_CASE("a faceted ball pressed into a block: its faces clipped, and in the limit the cap") {
  const double radius = 0.021, depth = 1.9e-3;
  const double cap = std::numbers::pi * depth * depth * (radius - depth / 3.0);
  const Matrix3 R = rotation(0.9, {0.3, -0.5, 0.8});
  double error_before = 0.0;
  for (int level = 2; level <= 5; ++level) {
    CAPTURE(level);
    const auto ball = test::sphere(radius, level);
    const auto overlap = overlap_in_general_pose(ball, test::box({0.05, 0.03, 0.04}),
                                                 {R, {0.004, 0.03 + radius - depth, 0.007}});
    const double clipped = volume_below(test::moved(ball, {R, Vector3::Zero()}), depth - radius);
    CHECK(overlap.volume == doctest::Approx(clipped).epsilon(kRounding * 10));
    const double error = cap - overlap.volume;
    CHECK(error > 0.0);  // inscribed
    // Flat facets miss the sphere by h²: a quarter a level, but for where the rim falls.
    if (level > 2) CHECK(error_before / error == doctest::Approx(4.0).epsilon(0.25));
    error_before = error;
  }
  CHECK(error_before < 0.01 * cap);
}

TEST_CASE("swapping the solids changes nothing but the frame of the centroid") {
  const OverlapSolid ball(test::sphere(0.021, 3)), box(test::box({0.013, 0.021, 0.008}));
  const RigidTransform X{rotation(0.6, {0.3, 0.8, -0.4}), {0.011, 0.024, 0.006}};
  const auto one = overlap_volume(ball, box, X), other = overlap_volume(box, ball, X.inverse());
  CHECK(one.volume > 1e-7);
  CHECK(one.volume == doctest::Approx(other.volume).epsilon(kRounding));
  CHECK((one.centroid - X * other.centroid).norm() < 1e-15);
}

TEST_CASE("disjoint solids overlap by exactly nothing, also where their boxes meet") {
  const auto ball = test::sphere(0.021, 3);
  for (const double apart : {0.0125, 0.05}) {
    const RigidTransform X{rotation(0.6, {0.3, 0.8, -0.4}),
                           (0.042 + apart * 1e-3) * Vector3(1, 1, 1).normalized()};
    const auto overlap = overlap_volume(OverlapSolid(ball), OverlapSolid(ball), X);
    CHECK(overlap.volume == 0.0);
    CHECK(overlap.centroid == Vector3::Zero());
    CHECK(overlap.status == OverlapStatus::kOk);
  }
  const RigidTransform far{Matrix3::Identity(), {0.3, 0.0, 0.0}};
  CHECK(overlap_volume(OverlapSolid(ball), OverlapSolid(ball), far).volume == 0.0);
}

TEST_CASE("a solid within another overlaps by its own volume; in a void, by nothing") {
  const auto outer = test::box({0.04, 0.05, 0.03}), ball = test::sphere(0.011, 2);
  const RigidTransform X{rotation(0.6, {0.3, 0.8, -0.4}), {0.011, 0.014, 0.006}};
  const double volume = OverlapSolid(ball).volume();
  CHECK(overlap_in_general_pose(ball, outer, X).volume == doctest::Approx(volume).epsilon(1e-12));
  CHECK(overlap_in_general_pose(outer, ball, X.inverse()).volume ==
        doctest::Approx(volume).epsilon(1e-12));

  const auto hollow = test::joined(
      outer, test::reversed(test::shifted(test::sphere(0.02, 2), {0.011, 0.014, 0.006})));
  CHECK(OverlapSolid(hollow).volume() ==
        doctest::Approx(OverlapSolid(outer).volume() - OverlapSolid(test::sphere(0.02, 2)).volume())
            .epsilon(kRounding));
  CHECK(overlap_in_general_pose(ball, hollow, X).volume == 0.0);
}

TEST_CASE("parts add up") {
  const auto ball = test::sphere(0.011, 3), block = test::box({0.05, 0.03, 0.04});
  const Vector3 left(-0.021, 0.0, 0.003), right(0.017, 0.0004, -0.002);
  const RigidTransform X{Matrix3::Identity(), {0.001, 0.0402, 0.002}};
  const auto both = overlap_in_general_pose(
      test::joined(test::shifted(ball, left), test::shifted(ball, right)), block, X);
  const auto one = overlap_in_general_pose(test::shifted(ball, left), block, X);
  const auto other = overlap_in_general_pose(test::shifted(ball, right), block, X);
  REQUIRE(other.volume > 0.0);
  CHECK(both.volume == doctest::Approx(one.volume + other.volume).epsilon(kRounding * 10));
  const Vector3 mean =
      (one.volume * one.centroid + other.volume * other.centroid) / (one.volume + other.volume);
  CHECK((both.centroid - mean).norm() < 1e-14);
}

TEST_CASE("a solid that passes through itself is counted, and said where it matters") {
  // Two boxes that run into each other, as one solid.
  const Vector3 a(0.01, 0.008, 0.009), shift(0.014, 0.0031, 0.0023);
  const auto crossed = test::joined(test::box(a), test::shifted(test::box(a), shift));
  const OverlapSolid solid(crossed), probe(test::box({0.002, 0.002, 0.002}));
  CHECK(solid.self_intersections() > 0);
  // Far from the crossing: as if it were not there.
  const auto away = overlap_volume(probe, solid, {Matrix3::Identity(), {-0.011, 0.0, 0.0}});
  CHECK(away.volume == doctest::Approx(0.001 * 0.004 * 0.004).epsilon(kRounding * 10));
  CHECK(away.status == OverlapStatus::kOk);
  CHECK(away.self_intersections == solid.self_intersections());
  // At it: a number perhaps, a clean status never.
  const auto at = overlap_volume(probe, solid, {rotation(0.4, {1, 2, 3}), {0.004, 0.008, 0.001}});
  CHECK(at.status != OverlapStatus::kOk);
  CHECK(std::isnan(at.volume) == (at.status == OverlapStatus::kFailed));
  CHECK(name(OverlapStatus::kSelfIntersectionAtCut) == "self_intersection_at_cut");
}

TEST_CASE("an overlap whose parts share just an edge is no solid: a status, not a number") {
  const double s = 0.0078125;  // a power of two: coordinates, and the shared edge, are exact
  const auto one = prism({{0, 0}, {2 * s, 0}, {2 * s, s}, {s, s}, {s, 2 * s}, {0, 2 * s}},
                         {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}, s);
  const auto other = prism({{s, 0}, {2 * s, 0}, {2 * s, 2 * s}, {0, 2 * s}, {0, s}, {s, s}},
                           {{0, 1, 5}, {1, 2, 5}, {5, 2, 3}, {5, 3, 4}}, 2 * s);
  const auto overlap = overlap_volume(OverlapSolid(one), OverlapSolid(other), {});
  CHECK(overlap.status == OverlapStatus::kFailed);
  CHECK(name(overlap.status) == "failed");
  CHECK(std::isnan(overlap.volume));
  CHECK(overlap.centroid.hasNaN());
  // A micrometre along the diagonal joins or parts the two squares, as the message advises.
  const double e = 1e-6;
  const auto moved =
      overlap_volume(OverlapSolid(one), OverlapSolid(other), {Matrix3::Identity(), {e, e, 0.0}});
  const double area = 2.0 * s * s - e * e;
  CHECK(moved.volume == doctest::Approx(area * 2.0 * s).epsilon(1e-10));
}

TEST_CASE("what is no closed, outward solid is refused, with the remedy") {
  const auto box = test::box({0.013, 0.021, 0.008});
  CHECK(refusal(box).empty());
  const auto patch = test::patch(0.0, 0.0, 0.01, 4, [](double x, double z) { return x * z; });
  CHECK(refusal(patch) ==
        "femur: the surface is open (16 edges of one face in 1 loops): an overlap volume needs a "
        "closed solid; give the solid's own file, or weld the vertices of this one");
  CHECK(refusal(test::reversed(box)) ==
        "femur: normals point inwards (the closed surface has a volume of -17.47 cm^3): reverse "
        "its faces");
  auto flipped = box;
  std::swap(flipped.faces(4, 1), flipped.faces(4, 2));
  CHECK(refusal(flipped).find("disagree on which side is out at 3 edges") != std::string::npos);
  const auto inside_out =
      test::joined(box, test::reversed(test::shifted(test::box({1e-3, 1e-3, 1e-3}), {0.05, 0, 0})));
  CHECK(refusal(inside_out).find("femur: a part of the closed surface is inside out") == 0);
  // Two boxes that share one vertex.
  auto touching = test::joined(box, test::shifted(box, {0.026, 0.042, 0.016}));
  touching.faces = (touching.faces.array() == 8).select(7, touching.faces);
  CHECK(refusal(touching).find("meets others in just a vertex") != std::string::npos);
}

TEST_CASE("a placement that is none is refused") {
  const OverlapSolid box(test::box({0.013, 0.021, 0.008}));
  RigidTransform X = general_placement(4);
  X.p.z() = std::nan("");
  CHECK_THROWS_WITH_AS(overlap_volume(box, box, X), doctest::Contains("not finite"),
                       std::invalid_argument);
  X = general_placement(4);
  X.R *= 1.01;
  CHECK_THROWS_WITH_AS(overlap_volume(box, box, X), doctest::Contains("not a rotation"),
                       std::invalid_argument);
}

TEST_CASE("many poses at once: each as by itself, the same bytes for any number of threads") {
  const OverlapSolid ball(test::sphere(0.021, 2)), box(test::box({0.013, 0.021, 0.008}));
  test::Draw draw(11);
  std::vector<Pose> poses;
  for (int i = 0; i < 12; ++i) poses.push_back(0.5 * test::general_pose(draw));
  const auto one = overlap_volumes(ball, box, poses, 1), two = overlap_volumes(ball, box, poses, 2);
  int overlapping = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CHECK(one[i].volume == two[i].volume);
    CHECK(one[i].volume == overlap_volume(ball, box, transform_TF(poses[i])).volume);
    CHECK(one[i].centroid == two[i].centroid);
    overlapping += one[i].volume > 0.0;
  }
  CHECK(overlapping >= 6);
  poses[7][4] = std::nan("");
  CHECK_THROWS_WITH_AS(overlap_volumes(ball, box, poses, 1), doctest::Contains("pose 7"),
                       std::invalid_argument);
}

TEST_CASE("real implants: the volumes and centroids of an independent Boolean [oracle]") {
  CONDYLE_REQUIRE_DATA(data);
  // Every sixth row of each implant (the Python tests take all 50), and those two at which a place
  // where DM's insert passes through itself is at the cut.
  const auto taken = [](const std::string& implant, int pose) {
    return pose % 6 == 3 || (implant == "dm" && (pose == 20 || pose == 22));
  };
  for (const std::string implant : {"dm", "jw"}) {
    const auto solid = [&](const std::string& file) {
      const auto mesh = read_mesh(data / "implants" / implant / file, LengthUnit::kMetre);
      return OverlapSolid(repair_mesh(mesh).mesh, file);
    };
    const OverlapSolid femur = solid("femur_solid.stl");
    const OverlapSolid inserts[] = {solid("insert_solid_medial.stl"),
                                    solid("insert_solid_lateral.stl")};
    CHECK(femur.self_intersections() == 0);
    CHECK(inserts[0].self_intersections() + inserts[1].self_intersections() ==
          (implant == "dm" ? 45 : 0));
    std::ifstream table(data / "checks" / "overlap_volume.csv");
    std::string line, field;
    int rows = 0, at_cut = 0;
    for (std::getline(table, line); std::getline(table, line);) {
      std::istringstream fields(line);
      std::vector<double> value;
      std::getline(fields, field, ',');
      if (field != implant) continue;
      while (std::getline(fields, field, ','))
        value.push_back(field.empty() ? 0.0 : std::stod(field));
      if (!taken(implant, static_cast<int>(value[0]))) continue;
      ++rows;
      RigidTransform X;
      X.p = Vector3(value[5], value[6], value[7]);
      X.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&value[8]);
      for (std::size_t side = 0; side < 2; ++side) {
        CAPTURE(line);
        CAPTURE(side);
        const auto overlap = overlap_volume(femur, inserts[side], X);
        // Relative to the volume itself, however small; nothing is exactly nothing in both.
        CHECK(std::abs(overlap.volume - value[17 + side]) <= 1e-5 * value[17 + side]);
        if (overlap.volume > 0.0) {
          CHECK((overlap.centroid - Vector3(&value[19 + 3 * side])).norm() < 1e-7);
        }
        CHECK(overlap.status != OverlapStatus::kFailed);
        CHECK(overlap.self_intersections == inserts[side].self_intersections());
        at_cut += overlap.status == OverlapStatus::kSelfIntersectionAtCut;
      }
    }
    CHECK(rows == (implant == "dm" ? 6 : 4));
    CHECK(at_cut == (implant == "dm" ? 2 : 0));
  }
}
