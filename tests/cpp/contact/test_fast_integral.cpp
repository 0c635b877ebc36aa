// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "condyle/contact/fast_integral.hpp"
#include "contact/fast_fixture.hpp"

namespace condyle::contact {
namespace {

using test::TorusPair;

const TorusPair& pair() {
  static const TorusPair p;
  return p;
}

Pose nearby(test::Draw& draw) {
  Pose pose = pair().pose;
  for (int i = 0; i < 3; ++i) pose[i] += draw(-0.4e-3, 0.4e-3);
  for (int i = 3; i < 6; ++i) pose[i] += draw(-0.01, 0.01);
  return pose;
}

// The same integral, face by face through DistanceField and ContactSums: slow and plain.
CompartmentLoads plain(const TorusPair& p, const Pose& pose, Side side, const ContactLaw& law) {
  ContactSums sums;
  const RigidTransform X_FT = transform_TF(pose).inverse();
  const SurfaceFaces& faces = p.compartments[side];
  for (Eigen::Index f = 0; f < faces.count(); ++f) {
    const Vector3 q = X_FT * Vector3(faces.centroids.row(f));
    const geometry::FieldValue at = p.field->evaluate(q);
    if (!(at.value < 0.0)) continue;
    const LawValue value = law.at(-at.value);
    const LoadedPoint point{q,
                            at.gradient,
                            faces.areas[f],
                            -at.value,
                            value.energy,
                            value.pressure,
                            value.pressure_rate};
    sums.add(point);
    sums.add_stiffness(point, at.hessian);
  }
  return loads_of_moving_distance(sums, pose, true);
}

void check_close(const CompartmentLoads& a, const CompartmentLoads& b, double tolerance) {
  CHECK((a.wrench - b.wrench).norm() <= tolerance * b.wrench.norm());
  CHECK((a.stiffness - b.stiffness).norm() <= tolerance * b.stiffness.norm());
  CHECK(std::abs(a.energy - b.energy) <= tolerance * b.energy);
  CHECK(std::abs(a.volume - b.volume) <= tolerance * b.volume);
  CHECK(std::abs(a.area - b.area) <= tolerance * b.area);
  CHECK(std::abs(a.max_depth - b.max_depth) <= tolerance * b.max_depth);
  CHECK(std::abs(a.peak_pressure - b.peak_pressure) <= tolerance * b.peak_pressure);
  CHECK(std::abs(a.pressure_sum - b.pressure_sum) <= tolerance * b.pressure_sum);
  CHECK((a.pressure_moment - b.pressure_moment).norm() <= tolerance * b.pressure_moment.norm());
}

double energy(const ContactPair& contact, const Pose& pose) {
  return contact.evaluate(pose, kMedial, Derivatives::kNone).energy +
         contact.evaluate(pose, kLateral, Derivatives::kNone).energy;
}

Vector6 force(const ContactPair& contact, const Pose& pose) {
  return generalised_force(pose, contact.evaluate(pose, kMedial, Derivatives::kNone).wrench +
                                     contact.evaluate(pose, kLateral, Derivatives::kNone).wrench);
}

TEST_CASE("[oracle] culling, sorting and vectors change nothing: the plain sum over faces") {
  const ContactLaw law(LinearVolumeLaw{7.7e9});
  const auto fast = test::fast_pair(pair().field, pair().compartments, law);
  test::Draw draw(42);
  for (int n = 0; n < 20; ++n) {
    const Pose pose = nearby(draw);
    for (const Side side : {kMedial, kLateral}) {
      const CompartmentLoads expected = plain(pair(), pose, side, law);
      REQUIRE(expected.area > 1e-5);
      // The kernel contracts the field in single precision: 6e-8 of the coefficients' 2 mm at a
      // depth of 1 mm, over 1e-1 mm for the curvature's share of the stiffness.
      check_close(fast.evaluate(pose, side, Derivatives::kStiffness), expected, 2e-6);
    }
  }
}

TEST_CASE("[oracle] every instruction set gives the same to 1e-12") {
  const auto baseline = test::fast_pair(pair().field, pair().compartments, ContactLaw{},
                                             InstructionSet::kBaseline);
  for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (set > best_instruction_set()) continue;
    CAPTURE(name(set));
    const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{}, set);
    test::Draw draw(42);
    for (int n = 0; n < 20; ++n) {
      const Pose pose = nearby(draw);
      for (const Side side : {kMedial, kLateral}) {
        check_close(fast.evaluate(pose, side, Derivatives::kStiffness),
                    baseline.evaluate(pose, side, Derivatives::kStiffness), 1e-12);
      }
    }
  }
}

TEST_CASE("[property] without stiffness the rest is the same and the stiffness zero") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  test::Draw draw(43);
  const Pose pose = nearby(draw);
  CompartmentLoads with = fast.evaluate(pose, kMedial, Derivatives::kStiffness);
  const CompartmentLoads without = fast.evaluate(pose, kMedial, Derivatives::kNone);
  CHECK(without.stiffness.isZero(0.0));
  with.stiffness.setZero();
  CHECK((without.wrench - with.wrench).norm() <= 1e-13 * with.wrench.norm());
  CHECK(without.energy == doctest::Approx(with.energy).epsilon(1e-13));
}

TEST_CASE("[derivative] the generalised force is minus the energy's slope") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  test::Draw draw(44);
  for (int n = 0; n < 20; ++n) {
    const Pose pose = nearby(draw);
    const Vector6 Q = force(fast, pose);
    for (int j = 0; j < 6; ++j) {
      const double step = j < 3 ? 1e-6 : 1e-4;
      Pose up = pose, down = pose;
      up[j] += step, down[j] -= step;
      const double slope = (energy(fast, up) - energy(fast, down)) / (2.0 * step);
      // A face whose d changes sign within the step errs by at most A K step ≈ 3e-3 N, several may;
      // single precision 2e-7 a face, over 1 000 of them, of 0.5 J / step. Against forces of 1e3 N,
      // moments of 10 Nm.
      CHECK(std::abs(slope + Q[j]) < (j < 3 ? 2e-2 : 5e-4));
      CHECK(std::abs(Q[j]) > 1e-2);
    }
  }
}

TEST_CASE("[derivative] the stiffness is the wrench's slope where no face enters or leaves") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  test::Draw draw(45);
  int compared = 0;
  for (int n = 0; n < 200 && compared < 60; ++n) {
    const Pose pose = nearby(draw);
    for (const Side side : {kMedial, kLateral}) {
      const CompartmentLoads at = fast.evaluate(pose, side, Derivatives::kStiffness);
      for (int j = 0; j < 6; ++j) {
        const double step = j < 3 ? 4e-7 : 2e-5;
        Pose up = pose, down = pose;
        up[j] += step, down[j] -= step;
        const CompartmentLoads above = fast.evaluate(up, side, Derivatives::kNone);
        const CompartmentLoads below = fast.evaluate(down, side, Derivatives::kNone);
        if (above.area != at.area || below.area != at.area) continue;
        ++compared;
        const Wrench slope = (above.wrench - below.wrench) / (2.0 * step);
        // Single precision: 2e-7 a face, over 1 000 of them, of 2e3 N in a step of 4e-7 m is 3e1 N/m
        // of 1e6; that the stiffness itself is right to 2e-6 is checked above.
        CHECK((slope - at.stiffness.col(j)).norm() < 1e-3 * at.stiffness.col(j).norm());
        CHECK(slope.norm() > 0.0);
      }
    }
  }
  CHECK(compared >= 60);
}

TEST_CASE("[property] the generalised stiffness is symmetric") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  test::Draw draw(46);
  for (int n = 0; n < 50; ++n) {
    const Pose pose = nearby(draw);
    const CompartmentLoads at =
        fast.evaluate(pose, n % 2 == 0 ? kMedial : kLateral, Derivatives::kStiffness);
    const Matrix6 K = generalised_stiffness(pose, at.wrench, at.stiffness);
    CHECK((K - K.transpose()).norm() < 1e-12 * K.norm());  // rounding; the project's claim is 1e-8
    CHECK(K.norm() > 1e5);
  }
}

TEST_CASE(
    "[property] a closed loop of poses takes no work, an open path takes the energy's change") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  constexpr int kSteps = 4000;
  const auto path = [](double t) {
    Pose pose = pair().pose;
    const double a = 2.0 * 3.14159265358979323846 * t;
    pose += (Pose() << 6e-4 * std::cos(a), 5e-4 * std::sin(a), 8e-4 * std::sin(2 * a + 1.0),
             0.015 * std::cos(a + 0.5), 0.02 * std::sin(a), 0.02 * std::cos(2 * a))
                .finished();
    return pose;
  };
  double work = 0.0, amount = 0.0, half = 0.0;
  for (int i = 0; i < kSteps; ++i) {  // Simpson's rule over each step
    const double t = static_cast<double>(i) / kSteps, h = 1.0 / kSteps;
    const Pose p0 = path(t), p1 = path(t + 0.5 * h), p2 = path(t + h);
    // dq/dt by the same rule's differences: exact for the quadratic through the three poses.
    const Pose d0 = -3 * p0 + 4 * p1 - p2, d1 = p2 - p0, d2 = p0 - 4 * p1 + 3 * p2;
    const double power =
        (force(fast, p0).dot(d0) + 4.0 * force(fast, p1).dot(d1) + force(fast, p2).dot(d2)) /
        6.0;
    work += power;
    amount += 0.5 * std::abs(power);
    if (i < kSteps / 2) half += power;
  }
  CHECK(amount > 0.1);  // joules really went in and out
  CHECK(std::abs(work) < 1e-6 * amount);
  const double change = energy(fast, path(0.5)) - energy(fast, path(0.0));
  CHECK(std::abs(half + change) < 1e-6 * amount);
}

TEST_CASE("[property] out of contact and far away everything is exactly zero") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  const RigidTransform X_TF = transform_TF(pair().pose);
  for (const double lift : {4e-3, 0.1, 5.0}) {
    Pose pose = pair().pose;
    // Away from both patches, which lie on the same side of the torus.
    const Vector3 out = X_TF.R * pair().tilt.transpose() * Vector3(-1.0, 0.1, 0.1);
    pose.head<3>() += lift * out;
    for (const Side side : {kMedial, kLateral}) {
      const CompartmentLoads at = fast.evaluate(pose, side, Derivatives::kStiffness);
      CHECK(at.wrench.isZero(0.0));
      CHECK(at.stiffness.isZero(0.0));
      CHECK(at.energy == 0.0);
      CHECK(at.area == 0.0);
      CHECK(at.max_depth == 0.0);
      CHECK(at.pressure_moment.isZero(0.0));
      CHECK_FALSE(at.back_face);
    }
  }
}

TEST_CASE("[property] the same pose gives the same bytes") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  const auto again = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  const CompartmentLoads a = fast.evaluate(pair().pose, kMedial, Derivatives::kStiffness);
  fast.evaluate(pair().pose, kLateral, Derivatives::kStiffness);
  const CompartmentLoads b = again.evaluate(pair().pose, kMedial, Derivatives::kStiffness);
  CHECK(a.wrench == b.wrench);
  CHECK(a.stiffness == b.stiffness);
  CHECK(a.energy == b.energy);
}

TEST_CASE("[property] pressures face by face add up to the side, in the compartment's order") {
  const auto fast = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  for (const Side side : {kMedial, kLateral}) {
    const CompartmentLoads at = fast.evaluate(pair().pose, side, Derivatives::kNone);
    const FacePressure faces = fast.face_pressure(pair().pose, side);
    const SurfaceFaces& compartment = pair().compartments[side];
    REQUIRE(faces.depth.size() == compartment.count());
    CHECK(faces.depth.dot(compartment.areas) == doctest::Approx(at.volume).epsilon(1e-6));  // single precision in the kernel
    CHECK(faces.pressure.dot(compartment.areas) == doctest::Approx(at.pressure_sum).epsilon(1e-6));
    const Vector3 moment = compartment.centroids.transpose() *
                           (faces.pressure.array() * compartment.areas.array()).matrix();
    CHECK((moment - at.pressure_moment).norm() < 1e-6 * moment.norm());
    CHECK(faces.depth.maxCoeff() == doctest::Approx(at.max_depth).epsilon(1e-6));
  }
}

TEST_CASE("[property] an overlap seen from behind is flagged, one from the front is not") {
  TorusPair behind;
  for (SurfaceFaces& faces : behind.compartments) faces.normals *= -1.0;
  const auto front = test::fast_pair(pair().field, pair().compartments, ContactLaw{});
  const auto back = test::fast_pair(behind.field, behind.compartments, ContactLaw{});
  for (const Side side : {kMedial, kLateral}) {
    CHECK_FALSE(front.evaluate(pair().pose, side, Derivatives::kNone).back_face);
    CHECK(back.evaluate(behind.pose, side, Derivatives::kNone).back_face);
  }
}

TEST_CASE("[property] overlap beyond an open border goes to border_area and nowhere else") {
  // The torus again, of which the surface is said to end on a plane that cuts the medial patch.
  TorusPair open(41, 0.9e-3, 40);
  const RigidTransform X_FT = transform_TF(open.pose).inverse();
  const Vector3 middle = X_FT * Vector3(open.compartments[kMedial].centroids.colwise().mean());
  const Vector3 cut = Vector3(0.2, 0.3, 1.0).normalized();
  const auto beyond = [&](const Vector3& p) { return cut.dot(p - middle) > 0.0; };
  const Vector3 half = Vector3::Constant(TorusPair::kMajor + TorusPair::kMinor);
  geometry::DistanceFieldSettings settings;
  settings.spacing = 0.9e-3;
  const auto field = std::make_shared<const geometry::DistanceField>(geometry::DistanceField::build(
      -half, half, settings,
      [&](const Vector3& p) {
        return geometry::DistanceSample{open.distance(p), beyond(p)};
      },
      1));
  const auto closed = test::fast_pair(open.field, open.compartments, ContactLaw{});
  const auto fast = test::fast_pair(field, open.compartments, ContactLaw{});
  const CompartmentLoads whole = closed.evaluate(open.pose, kMedial, Derivatives::kNone);
  const CompartmentLoads part = fast.evaluate(open.pose, kMedial, Derivatives::kNone);
  CHECK(whole.border_area == 0.0);
  CHECK(part.border_area > 0.2 * whole.area);
  CHECK(part.area > 0.2 * whole.area);
  CHECK(part.area + part.border_area == doctest::Approx(whole.area).epsilon(1e-12));
  const FacePressure faces = fast.face_pressure(open.pose, kMedial);
  double pressed = 0.0;
  for (Eigen::Index f = 0; f < faces.depth.size(); ++f) {
    if (faces.depth[f] <= 0.0) continue;
    pressed += open.compartments[kMedial].areas[f] * faces.pressure[f];
    const Vector3 q = X_FT * Vector3(open.compartments[kMedial].centroids.row(f));
    CHECK(cut.dot(q - middle) < 0.9 * settings.spacing);  // a cell's half diagonal
  }
  CHECK(pressed == doctest::Approx(part.pressure_sum).epsilon(1e-6));
}

}  // namespace
}  // namespace condyle::contact
