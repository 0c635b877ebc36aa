// SPDX-License-Identifier: Apache-2.0
// The laws of an elastic contact on the meshes of a real implant (the right knee DM), in general
// poses over its range of motion, for both evaluations and either body's faces.
//
// A femoral component is convex: inside it the distance to its facets has creases, so under `exact`
// the wrench jumps a little wherever a face's closest feature changes. Differences there are taken
// over steps in which none does, and loops over many poses.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "condyle/geometry/mesh_file.hpp"
#include "contact/field_folder.hpp"
#include "contact/pair_fixtures.hpp"
#include "support/shared_data.hpp"

using namespace condyle;
using namespace condyle::contact;
using condyle::test::along;
using condyle::test::scaled;
using condyle::test::whole;
using condyle::test::Whole;
using geometry::TriangleMesh;
using std::numbers::pi;

namespace {

constexpr double kDegree = pi / 180.0;
constexpr Integration kAll[] = {Integration::kFixed, Integration::kMoving, Integration::kBoth};
constexpr Evaluation kEvaluations[] = {Evaluation::kExact, Evaluation::kFast};

// The implant and the pairs made of it, each once.
class Implant {
 public:
  explicit Implant(const std::filesystem::path& data)
      : fields_("real-implant"), folder_(data / "implants" / "dm") {
    femur_ = read("femur_contact.stl");
    insert_ = {read("insert_contact_medial.stl"), read("insert_contact_lateral.stl")};
  }

  const TriangleMesh& femur() const { return femur_; }
  const std::vector<TriangleMesh>& insert() const { return insert_; }

  PairSettings settings(Evaluation evaluation, Integration integration) const {
    PairSettings settings;
    settings.evaluation = evaluation;
    settings.integration = integration;
    settings.cache_directory = fields_.path();
    settings.threads = 1;
    return settings;
  }

  const ContactPair& pair(Evaluation evaluation, Integration integration) {
    const auto key = std::pair(evaluation, integration);
    const auto found = pairs_.find(key);
    if (found != pairs_.end()) return found->second;
    return pairs_
        .emplace(key, make_contact_pair(femur_, insert_, {}, settings(evaluation, integration)))
        .first->second;
  }

  // The pose let down until the total Fy is `force`, from where nothing touches.
  Pose lowered(Pose pose, double force) {
    const ContactPair& contact = pair(Evaluation::kFast, Integration::kFixed);
    const auto held = [&](double y) {
      pose[kY] = y;
      return whole(contact, pose).wrench[kY];
    };
    double high = 0.055;
    while (held(high - 2e-4) < force) high -= 2e-4;
    double low = high - 2e-4;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (held(middle) < force ? high : low) = middle;
    }
    pose[kY] = 0.5 * (low + high);
    return pose;
  }

 private:
  TriangleMesh read(const char* file) const {
    return geometry::read_mesh(folder_ / file, geometry::LengthUnit::kMetre);
  }

  test::FieldFolder fields_;
  std::filesystem::path folder_;
  TriangleMesh femur_;
  std::vector<TriangleMesh> insert_;
  std::map<std::pair<Evaluation, Integration>, ContactPair> pairs_;
};

Implant& implant(const std::filesystem::path& data) {
  static Implant it(data);
  return it;
}

// A pose of the implant's range, loaded with 100 to 3 000 N in total.
Pose general_pose(Implant& it, test::Draw& draw) {
  Pose pose;
  pose << 6.404e-3 + draw(-4e-3, 4e-3), 0.0, -0.218e-3 + draw(-1.5e-3, 1.5e-3),
      draw(-1.0, 1.0) * kDegree, draw(-7.0, 7.0) * kDegree, draw(-65.0, 0.0) * kDegree;
  return it.lowered(pose, 100.0 * std::pow(30.0, draw(0.0, 1.0)));
}

}  // namespace

TEST_CASE("[derivative] the generalised force is minus the energy's slope, the stiffness its own") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  struct Kind {
    Evaluation evaluation;
    Integration integration;
    double step, force_tolerance;
  };
  // Steps in metres, or metres over kArm. exact: 1e-8 m; rounding of 1e-16 of U ~ 0.5 J leaves 1e-8
  // N, a crease crossed in the step 1e-7 of the force. fast: 1e-7 m; single precision, 1e-7 of the
  // 2 mm that coefficients reach, at random over 3 000 faces: 4e-12 m of the step.
  const Kind kinds[] = {{Evaluation::kExact, Integration::kFixed, 1e-8, 1e-6},
                        {Evaluation::kExact, Integration::kMoving, 1e-8, 1e-6},
                        {Evaluation::kFast, Integration::kFixed, 1e-7, 4e-5},
                        {Evaluation::kFast, Integration::kMoving, 1e-7, 4e-5},
                        {Evaluation::kFast, Integration::kBoth, 1e-7, 4e-5}};
  // The wrench has a kink where a face is within the step of d = 0, and under exact a jump where
  // one's closest feature changes: the slopes ahead and behind then differ. Where they agree to
  // this, a kink left over is half of it at most, and the rest is rounding as above.
  const double smooth = 1e-4;
  for (const Kind& kind : kinds) {
    CAPTURE(name(kind.evaluation));
    CAPTURE(name(kind.integration));
    const ContactPair& pair = it.pair(kind.evaluation, kind.integration);
    test::Draw draw(61);
    int compared = 0;
    for (int n = 0; n < 4; ++n) {
      const Pose pose = general_pose(it, draw);
      const Whole at = whole(pair, pose, Derivatives::kStiffness);
      REQUIRE(at.wrench[kY] > 95.0);
      const Vector6 Q = generalised_force(pose, at.wrench);
      const double force = scaled(Q).norm(), stiffness = scaled(at.stiffness).norm();
      for (int j = 0; j < 6; ++j) {
        const Pose up = along(pose, j, kind.step), down = along(pose, j, -kind.step);
        const Whole ahead = whole(pair, up), behind = whole(pair, down);
        const double to_metres = j < 3 ? 1.0 : 1.0 / test::kArm;
        const double slope = (ahead.energy - behind.energy) / (up[j] - down[j]);
        CHECK(std::abs(slope + Q[j]) * to_metres < kind.force_tolerance * force);
        const Vector6 forward = (ahead.wrench - at.wrench) / (up[j] - pose[j]);
        const Vector6 backward = (at.wrench - behind.wrench) / (pose[j] - down[j]);
        if (scaled(Vector6(forward - backward)).norm() * to_metres > smooth * stiffness) continue;
        ++compared;
        const Vector6 off = 0.5 * (forward + backward) - at.stiffness.col(j);
        CHECK(scaled(off).norm() * to_metres < smooth * stiffness);
      }
    }
    CHECK(compared >= 14);  // of 24
  }
}

TEST_CASE("[property] the generalised stiffness is symmetric") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  for (const Evaluation evaluation : kEvaluations) {
    for (const Integration integration : kAll) {
      CAPTURE(name(evaluation));
      CAPTURE(name(integration));
      test::Draw draw(67);
      for (int n = 0; n < 6; ++n) {
        const Pose pose = general_pose(it, draw);
        const Whole at = whole(it.pair(evaluation, integration), pose, Derivatives::kStiffness);
        const Matrix6 q = scaled(generalised_stiffness(pose, at.wrench, at.stiffness));
        CHECK((q - q.transpose()).norm() < 1e-8 * q.norm());  // rounding is 1e-15
        CHECK(q.norm() > 1e5);
      }
    }
  }
}

namespace {

// A smooth closed curve of poses about 24 degrees of flexion, where the overlap reaches neither
// surface's border, all six coordinates at once: y a
// trigonometric polynomial fitted to the heights at which the load is 400 … 2 400 N.
class Loop {
 public:
  explicit Loop(Implant& it) {
    constexpr int kNodes = 64;
    for (int n = 0; n < kNodes; ++n) {
      const double a = 2.0 * pi * n / kNodes;
      const double y = it.lowered(without_y(a), 1400.0 + 1000.0 * std::cos(2.0 * a + 0.7))[kY];
      for (int k = 0; k <= kHarmonics; ++k) {
        const double weight = (k == 0 ? 1.0 : 2.0) / kNodes;
        cosine_[k] += weight * y * std::cos(k * a);
        sine_[k] += weight * y * std::sin(k * a);
      }
    }
  }

  // t in turns.
  Pose pose(double t) const {
    const double a = 2.0 * pi * t;
    Pose p = without_y(a);
    for (int k = 0; k <= kHarmonics; ++k) {
      p[kY] += cosine_[k] * std::cos(k * a) + sine_[k] * std::sin(k * a);
    }
    return p;
  }

  // dpose/dt.
  Vector6 rate(double t) const {
    const double a = 2.0 * pi * t;
    Vector6 r;
    r << -1.2e-3 * std::sin(a + 1.1), 0.0, 0.6e-3 * std::cos(a + 2.0),
        0.2 * kDegree * 2.0 * std::cos(2.0 * a + 0.3), 2.0 * kDegree * std::cos(a + 0.4),
        -7.0 * kDegree * std::sin(a);
    for (int k = 1; k <= kHarmonics; ++k) {
      r[kY] += k * (sine_[k] * std::cos(k * a) - cosine_[k] * std::sin(k * a));
    }
    return 2.0 * pi * r;
  }

 private:
  static constexpr int kHarmonics = 7;

  static Pose without_y(double a) {
    Pose p;
    p << 4.2e-3 + 1.2e-3 * std::cos(a + 1.1), 0.0, -0.2e-3 + 0.6e-3 * std::sin(a + 2.0),
        0.2 * kDegree * std::sin(2.0 * a + 0.3), 2.0 * kDegree * std::sin(a + 0.4),
        (-24.0 + 7.0 * std::cos(a)) * kDegree;
    return p;
  }

  std::array<double, kHarmonics + 1> cosine_{}, sine_{};
};

}  // namespace

TEST_CASE("[property] a closed loop of poses takes no work") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  const Loop loop(it);
  struct Kind {
    Evaluation evaluation;
    Integration integration;
    int poses;
    double tolerance;
  };
  const Kind kinds[] = {{Evaluation::kFast, Integration::kFixed, 1000, 1e-6},
                        {Evaluation::kFast, Integration::kMoving, 1000, 1e-6},
                        {Evaluation::kFast, Integration::kBoth, 1000, 1e-6},
                        {Evaluation::kExact, Integration::kFixed, 400, 1e-4}};
  for (const auto& [evaluation, integration, poses, tolerance] : kinds) {
    CAPTURE(name(evaluation));
    CAPTURE(name(integration));
    const ContactPair& pair = it.pair(evaluation, integration);
    // The trapezoidal rule, which on a smooth periodic integrand errs by rounding only. What is
    // left are kinks of Q where faces enter and leave (fast), jumps at creases (exact).
    double work = 0.0, amount = 0.0, border = 0.0, least = 1e9;
    for (int n = 0; n < poses; ++n) {
      const double t = static_cast<double>(n) / poses;
      const Pose pose = loop.pose(t);
      Wrench total = Wrench::Zero();
      for (std::size_t c = 0; c < 2; ++c) {
        const CompartmentLoads loads = pair.evaluate(pose, c, Derivatives::kNone);
        total += loads.wrench;
        border = std::max(border, loads.border_area);
        least = std::min(least, loads.wrench[kY]);
      }
      const double power = generalised_force(pose, total).dot(loop.rate(t));
      work += power / poses;
      amount += 0.5 * std::abs(power) / poses;
    }
    CHECK(border == 0.0);
    CHECK(least > 10.0);  // both sides stay in contact
    CHECK(amount > 0.3);
    CHECK(std::abs(work) < tolerance * amount);
  }
}

TEST_CASE("[property] an open path takes the energy's change") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  const Loop loop(it);
  for (const auto& [evaluation, steps, tolerance] :
       {std::tuple(Evaluation::kFast, 200, 1e-5), std::tuple(Evaluation::kExact, 80, 1e-4)}) {
    CAPTURE(name(evaluation));
    const ContactPair& pair = it.pair(evaluation, Integration::kFixed);
    const auto power = [&](double t) {
      const Pose pose = loop.pose(t);
      return generalised_force(pose, whole(pair, pose).wrench).dot(loop.rate(t));
    };
    for (const double start : {0.21, 0.48}) {
      const double length = 0.19, h = length / steps;
      double work = 0.0, amount = 0.0;  // Simpson's rule
      for (int n = 0; n <= 2 * steps; ++n) {
        const double weight = n == 0 || n == 2 * steps ? 1.0 : (n % 2 == 1 ? 4.0 : 2.0);
        const double share = weight * power(start + 0.5 * h * n) * h / 6.0;
        work += share;
        amount += std::abs(share);
      }
      const double change =
          whole(pair, loop.pose(start + length)).energy - whole(pair, loop.pose(start)).energy;
      CHECK(std::abs(work + change) < tolerance * amount);
      CHECK(std::abs(change) > 0.05);
    }
  }
}

TEST_CASE("[property] a rigid motion of both bodies changes nothing") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  const RigidTransform Y = test::general_placement(71), Z = test::general_placement(72);
  // Depths of 1e-3 m out of coordinates of 0.1 m, 1e-14; ties between neighbouring features fall
  // either way. fast: its field stands in the femur's frame, which stays; single precision.
  for (const auto& [evaluation, integration, in_F, tolerance] :
       {std::tuple(Evaluation::kExact, Integration::kBoth, Z, 1e-9),
        std::tuple(Evaluation::kFast, Integration::kFixed, RigidTransform{}, 1e-6)}) {
    CAPTURE(name(evaluation));
    const ContactPair elsewhere =
        make_contact_pair(test::moved(it.femur(), in_F.inverse()),
                          {test::moved(it.insert()[0], Y), test::moved(it.insert()[1], Y)}, {},
                          it.settings(evaluation, integration));
    test::Draw draw(73);
    for (int n = 0; n < 3; ++n) {
      const Pose pose = general_pose(it, draw);
      const RigidTransform X = transform_TF(pose), X_there = Y * X * in_F;
      const Whole a = whole(it.pair(evaluation, integration), pose);
      const Whole b = whole(elsewhere, pose_from_transform(X_there));
      const Vector3 force = a.wrench.head<3>(), to_Fo = X.p - X * in_F.p;
      Wrench expected;
      expected << Y.R * force, Y.R * (a.wrench.tail<3>() + to_Fo.cross(force));
      CHECK((scaled(b.wrench) - scaled(expected)).norm() < tolerance * scaled(expected).norm());
      CHECK(b.energy == doctest::Approx(a.energy).epsilon(tolerance));
      CHECK(b.volume == doctest::Approx(a.volume).epsilon(tolerance));
    }
  }
}

TEST_CASE(
    "[property] action equals reaction, and both do not change when the bodies change roles") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  struct Kind {
    Evaluation evaluation;
    Integration ours, theirs;
    double tolerance;
  };
  const Kind kinds[] = {
      {Evaluation::kExact, Integration::kFixed, Integration::kMoving, 1e-10},
      {Evaluation::kExact, Integration::kMoving, Integration::kFixed, 1e-10},
      {Evaluation::kExact, Integration::kBoth, Integration::kBoth, 1e-10},
      {Evaluation::kFast, Integration::kBoth, Integration::kBoth, 1e-6}};  // single precision
  for (const Kind& kind : kinds) {
    CAPTURE(name(kind.evaluation));
    CAPTURE(name(kind.ours));
    const ContactPair& pair = it.pair(kind.evaluation, kind.ours);
    const ContactPair other = make_contact_pair(it.insert()[0], {it.femur()}, {},
                                                it.settings(kind.evaluation, kind.theirs));
    test::Draw draw(79);
    for (int n = 0; n < 3; ++n) {
      const Pose pose = general_pose(it, draw);
      const RigidTransform X = transform_TF(pose);
      const CompartmentLoads a = pair.evaluate(pose, 0, Derivatives::kNone);
      const CompartmentLoads b =
          other.evaluate(pose_from_transform(X.inverse()), 0, Derivatives::kNone);
      const Wrench expected = test::reaction(X, a.wrench);
      CHECK((scaled(b.wrench) - scaled(expected)).norm() <=
            kind.tolerance * scaled(expected).norm());
      CHECK(b.energy == doctest::Approx(a.energy).epsilon(kind.tolerance));
      CHECK(b.area == doctest::Approx(a.area).epsilon(kind.tolerance));
    }
  }
}

TEST_CASE("[property] out of contact everything is exactly zero") {
  CONDYLE_REQUIRE_DATA(data);
  Implant& it = implant(data);
  test::Draw draw(83);
  for (int n = 0; n < 4; ++n) {
    Pose pose = general_pose(it, draw);
    for (const double lift : {3e-3, 0.02, 0.5}) {
      pose[kY] += lift;
      for (const Evaluation evaluation : kEvaluations) {
        const Whole at =
            whole(it.pair(evaluation, Integration::kBoth), pose, Derivatives::kStiffness);
        CHECK(at.wrench == Wrench::Zero());
        CHECK(at.stiffness == Matrix6::Zero());
        CHECK(at.energy + at.volume + at.area == 0.0);
      }
    }
  }
}
