// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "condyle/contact/contact_pair.hpp"
#include "contact/field_folder.hpp"
#include "contact/pair_fixtures.hpp"

using namespace condyle;
using namespace condyle::contact;
using test::along;
using test::PairCase;
using test::scaled;
using test::whole;
using test::Whole;

namespace {

constexpr Integration kAll[] = {Integration::kFixed, Integration::kMoving, Integration::kBoth};

PairSettings settings_of(Evaluation evaluation, Integration integration) {
  static const test::FieldFolder fields("contact-pair");
  PairSettings settings;
  settings.cache_directory = fields.path();
  settings.evaluation = evaluation;
  settings.integration = integration;
  settings.field.spacing = 1e-3;
  settings.threads = 1;
  return settings;
}

ContactPair pair_of(const PairCase& bodies, Evaluation evaluation, Integration integration,
                    const ContactLaw& law = {}, const PairLayers& layers = {}) {
  return make_contact_pair(bodies.moving, bodies.fixed, law, settings_of(evaluation, integration),
                           layers);
}

void check_close(const Whole& a, const Whole& b, double tolerance) {
  CHECK((scaled(a.wrench) - scaled(b.wrench)).norm() <= tolerance * scaled(b.wrench).norm());
  CHECK((scaled(a.stiffness) - scaled(b.stiffness)).norm() <=
        tolerance * scaled(b.stiffness).norm());
  CHECK(std::abs(a.energy - b.energy) <= tolerance * b.energy);
  CHECK(std::abs(a.volume - b.volume) <= tolerance * b.volume);
  CHECK(std::abs(a.area - b.area) <= tolerance * b.area);
}

// The law's own layer and another, thicker and softer.
const ElasticLayer kPlastic{463e6, 0.46, 0.0093};
const Layer kOther{1.3e9, 0.0141};

}  // namespace

TEST_CASE("names are read back, and others refused") {
  for (const Integration i : kAll) CHECK(integration_from_name(name(i)) == i);
  CHECK(integration_from_name("insert") == Integration::kFixed);
  CHECK(integration_from_name("femur") == Integration::kMoving);
  CHECK_THROWS_WITH_AS(integration_from_name("tibia"),
                       "integration is 'tibia': must be 'fixed' (of a knee: 'insert'), 'moving' "
                       "('femur') or 'both'",
                       std::invalid_argument);
}

TEST_CASE("[property] action equals reaction: exchanged bodies, the opposite wrench, same energy") {
  // Faces of one body in the distance of the other, seen from either: the same sums, in other
  // frames. Coordinates of 0.05 m put some 1e-17 m into depths of 1e-3 m, 1e-14; where the closest
  // feature is an edge or a vertex, the stiffness divides by the depth of the shallowest faces. The
  // fast field rounds cell coordinates to single precision, hence 1e-6 and more in the stiffness.
  const std::pair<Evaluation, double> kinds[] = {{Evaluation::kExact, 1e-9},
                                                 {Evaluation::kFast, 1e-5}};
  for (const auto& [evaluation, tolerance] : kinds) {
    CAPTURE(name(evaluation));
    const PairCase bodies = test::ellipsoid_in_dish(4, 40);
    const PairCase swapped = test::exchanged(bodies);
    const std::pair<Integration, Integration> roles[] = {
        {Integration::kMoving, Integration::kFixed},
        {Integration::kFixed, Integration::kMoving},
        {Integration::kBoth, Integration::kBoth}};
    for (const auto& [ours, theirs] : roles) {
      CAPTURE(name(ours));
      const ContactPair pair = pair_of(bodies, evaluation, ours);
      const ContactPair other = pair_of(swapped, evaluation, theirs);
      test::Draw draw(21);
      for (int n = 0; n < 3; ++n) {
        const RigidTransform X = test::nearby(bodies, draw).X_TF;
        const Pose pose = pose_from_transform(X), back = pose_from_transform(X.inverse());
        const Whole a = whole(pair, pose, Derivatives::kStiffness);
        const Whole b = whole(other, back, Derivatives::kStiffness);
        REQUIRE(a.volume > 1e-8);
        REQUIRE(a.border_area + b.border_area == 0.0);
        // The expected stiffness: how the reaction, a smooth map of pose and wrench, changes as the
        // exchanged pose does. By central differences of that map, good to step² and eps/step.
        Whole expected = a;
        expected.wrench = test::reaction(X, a.wrench);
        Matrix6 moved, slope;
        for (int j = 0; j < 6; ++j) {
          const double h = 1e-5;
          const auto at = [&](double s) { return transform_TF(along(pose, j, s)); };
          const auto wrench = [&](double s) -> Wrench {
            return a.wrench + a.stiffness.col(j) * (along(pose, j, s)[j] - pose[j]);
          };
          moved.col(j) =
              (pose_from_transform(at(h).inverse()) - pose_from_transform(at(-h).inverse())) /
              (2.0 * h);
          slope.col(j) =
              (test::reaction(at(h), wrench(h)) - test::reaction(at(-h), wrench(-h))) / (2.0 * h);
        }
        expected.stiffness = slope * moved.inverse();
        check_close(b, expected, std::max(tolerance, 1e-7));
        CHECK((b.wrench - expected.wrench).norm() <= tolerance * b.wrench.norm());
        CHECK(b.energy == doctest::Approx(a.energy).epsilon(tolerance));
      }
    }
  }
}

TEST_CASE("[property] the other body feels the pressures on its faces along the distance's slope") {
  const PairCase bodies = test::ellipsoid_in_dish(4, 40);
  const Pose pose = bodies.pose();
  const ContactPair pair = pair_of(bodies, Evaluation::kExact, Integration::kMoving);
  const FacePressure faces = pair.face_pressure(pose, 0);
  const SurfaceFaces surface = surface_faces(bodies.moving);
  const geometry::SignedDistance distance(bodies.fixed.front());
  REQUIRE(faces.pressure.size() == surface.count());
  Vector3 total = Vector3::Zero(), moment = Vector3::Zero();
  for (Eigen::Index f = 0; f < surface.count(); ++f) {
    const Vector3 q = bodies.X_TF * Vector3(surface.centroids.row(f));
    const auto at = distance.query(q);
    CHECK(faces.depth[f] == doctest::Approx(std::max(0.0, -at.distance)).epsilon(1e-12));
    const Vector3 push = surface.areas[f] * faces.pressure[f] * at.gradient;
    total += push;
    moment += (q - bodies.X_TF.p).cross(push);
  }
  const CompartmentLoads loads = pair.evaluate(pose, 0, Derivatives::kNone);
  CHECK((loads.wrench.head<3>() - total).norm() < 1e-12 * total.norm());
  CHECK((loads.wrench.tail<3>() - moment).norm() < 1e-12 * total.norm() * test::kArm);
  CHECK(faces.depth.maxCoeff() == doctest::Approx(loads.max_depth).epsilon(1e-12));
}

TEST_CASE("[derivative] the wrench is the energy's slope, the stiffness the wrench's") {
  // Where what is integrated against has a C1 distance inside: the dish, as either body.
  struct Kind {
    Evaluation evaluation;
    Integration integration;
    double step, force_tolerance, stiffness_tolerance;
  };
  // exact: the stiffness jumps where a face's closest feature changes or a face enters, some two of
  //   a thousand in a step of 2e-8 m; everything else is step² and eps/step, both below 1e-8.
  // fast: single precision, 1e-7 of a face's depth at random, 1e-9 J and 1e-6 N of 1 J and 1e3 N:
  //   over a step of 1e-6 m 1e-3 N and 1 N/m; up to ten of a thousand faces enter in that step.
  const Kind kinds[] = {{Evaluation::kExact, Integration::kMoving, 1e-8, 1e-6, 2e-3},
                        {Evaluation::kExact, Integration::kFixed, 1e-8, 1e-6, 2e-3},
                        {Evaluation::kFast, Integration::kMoving, 1e-6, 1e-5, 5e-3},
                        {Evaluation::kFast, Integration::kFixed, 1e-6, 1e-5, 5e-3},
                        {Evaluation::kFast, Integration::kBoth, 1e-6, 1e-5, 5e-3}};
  for (const Kind& kind : kinds) {
    CAPTURE(name(kind.evaluation));
    CAPTURE(name(kind.integration));
    PairCase bodies = test::ellipsoid_in_dish(4, 40);
    if (kind.integration == Integration::kFixed) bodies = test::exchanged(bodies);
    const ContactPair pair = pair_of(bodies, kind.evaluation, kind.integration);
    test::Draw draw(31);
    for (int n = 0; n < 3; ++n) {
      const Pose pose = test::nearby(bodies, draw).pose();
      const Whole at = whole(pair, pose, Derivatives::kStiffness);
      REQUIRE(at.border_area == 0.0);
      const Vector6 Q = generalised_force(pose, at.wrench);
      Vector6 slope;
      Matrix6 stiffness;
      for (int j = 0; j < 6; ++j) {
        const Pose up = along(pose, j, kind.step), down = along(pose, j, -kind.step);
        const Whole ahead = whole(pair, up), behind = whole(pair, down);
        slope[j] = (ahead.energy - behind.energy) / (up[j] - down[j]);
        stiffness.col(j) = (ahead.wrench - behind.wrench) / (up[j] - down[j]);
        CHECK(std::abs(Q[j]) > 1e-3);
      }
      CHECK((scaled(Q) + scaled(slope)).norm() < kind.force_tolerance * scaled(Q).norm());
      CHECK((scaled(stiffness) - scaled(at.stiffness)).norm() <
            kind.stiffness_tolerance * scaled(at.stiffness).norm());
    }
  }
}

TEST_CASE("[property] the generalised stiffness is symmetric, whoever is integrated") {
  const PairCase bodies = test::ellipsoid_in_dish(4, 40);
  for (const Evaluation evaluation : {Evaluation::kExact, Evaluation::kFast}) {
    for (const Integration integration : kAll) {
      CAPTURE(name(evaluation));
      CAPTURE(name(integration));
      const ContactPair pair = pair_of(bodies, evaluation, integration);
      test::Draw draw(33);
      for (int n = 0; n < 3; ++n) {
        const Pose pose = test::nearby(bodies, draw).pose();
        const Whole at = whole(pair, pose, Derivatives::kStiffness);
        const Matrix6 q = scaled(generalised_stiffness(pose, at.wrench, at.stiffness));
        CHECK((q - q.transpose()).norm() < 1e-12 * q.norm());  // rounding
        CHECK(q.norm() > 1e5);
      }
    }
  }
}

TEST_CASE("[property] where either body's frame stands changes nothing") {
  const PairCase bodies = test::ellipsoid_in_dish(4, 40);
  const RigidTransform Y = test::general_placement(51), Z = test::general_placement(52);
  const auto check = [&](Evaluation evaluation, Integration integration, const RigidTransform& in_T,
                         const RigidTransform& in_F, double tolerance) {
    CAPTURE(name(evaluation));
    CAPTURE(name(integration));
    const PairCase elsewhere{test::moved(bodies.moving, in_F.inverse()),
                             {test::moved(bodies.fixed.front(), in_T)},
                             in_T * bodies.X_TF * in_F};
    const Whole a = whole(pair_of(bodies, evaluation, integration), bodies.pose());
    const Whole b = whole(pair_of(elsewhere, evaluation, integration), elsewhere.pose());
    const Vector3 force = a.wrench.head<3>();
    const Vector3 to_Fo = bodies.X_TF.p - bodies.X_TF * in_F.p;
    Whole expected = a;
    expected.wrench << in_T.R * force, in_T.R * (a.wrench.tail<3>() + to_Fo.cross(force));
    expected.stiffness = b.stiffness;
    check_close(b, expected, tolerance);
  };
  // Depths of 1e-3 m out of coordinates of 0.1 m: 1e-14, and sums of a thousand. Single precision
  // in the fast field, which stays what it is as long as its own body's mesh does not move.
  for (const Integration integration : kAll) check(Evaluation::kExact, integration, Y, Z, 1e-10);
  check(Evaluation::kFast, Integration::kFixed, Y, {}, 1e-6);
  check(Evaluation::kFast, Integration::kMoving, {}, Z, 1e-6);
}

TEST_CASE("[property] compartments add up to the whole") {
  // A wide dish pressed onto three bodies at once.
  const double R = 0.0052;
  const Vector3 places[] = {{-0.0071, 0.0, 0.0052}, {0.0083, 0.0, 0.0047}, {0.0011, 0.0, -0.0079}};
  std::vector<geometry::TriangleMesh> balls;
  geometry::TriangleMesh all;
  for (const Vector3& place : places) {
    const double top = 3.1 * place.x() * place.x() + 2.3 * place.z() * place.z() + 0.05 * place.x();
    balls.push_back(test::shifted(test::sphere(R, 3), place + Vector3(0.0, top + R - 5e-4, 0.0)));
    all = balls.size() == 1 ? balls.back() : test::joined(all, balls.back());
  }
  const RigidTransform X = RigidTransform{}, P = test::general_placement(3),
                       Q = test::general_placement(8);
  const auto dish = test::dish(40, 0.016);
  const PairCase apart = test::in_general_frames(dish, balls, X, P, Q);
  const PairCase together = test::in_general_frames(dish, {all}, X, P, Q);
  struct Kind {
    Evaluation evaluation;
    Integration integration;
    double tolerance;
  };
  // One field a compartment, one for the whole: with the moving faces, fast differs by its own
  // interpolation, (0.6/8)² of the sagitta at a radius of 8 mm and less.
  const Kind kinds[] = {{Evaluation::kExact, Integration::kFixed, 1e-11},
                        {Evaluation::kExact, Integration::kMoving, 1e-11},
                        {Evaluation::kExact, Integration::kBoth, 1e-11},
                        {Evaluation::kFast, Integration::kFixed, 1e-11},
                        {Evaluation::kFast, Integration::kMoving, 1e-2}};
  for (const Kind& kind : kinds) {
    CAPTURE(name(kind.evaluation));
    CAPTURE(name(kind.integration));
    const ContactPair parts = pair_of(apart, kind.evaluation, kind.integration);
    const ContactPair one = pair_of(together, kind.evaluation, kind.integration);
    REQUIRE(parts.compartments() == 3);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(parts.evaluate(apart.pose(), c, Derivatives::kNone).energy > 1e-3);
    }
    check_close(whole(parts, apart.pose(), Derivatives::kStiffness),
                whole(one, together.pose(), Derivatives::kStiffness), kind.tolerance);
  }
}

TEST_CASE("[property] layers that are the law's own on every face change nothing") {
  const PairCase bodies = test::ellipsoid_in_dish(4, 40, 0.7e-3);
  for (const ContactLaw& law :
       {ContactLaw(ThinLayerLinearLaw{kPlastic}), ContactLaw(ThinLayerLogarithmicLaw{kPlastic})}) {
    PairLayers layers;
    layers.moving.assign(static_cast<std::size_t>(bodies.moving.face_count()), layer_of(kPlastic));
    layers.fixed.emplace_back(static_cast<std::size_t>(bodies.fixed.front().face_count()),
                              layer_of(kPlastic));
    for (const Evaluation evaluation : {Evaluation::kExact, Evaluation::kFast}) {
      CAPTURE(name(evaluation));
      const ContactPair with = pair_of(bodies, evaluation, Integration::kBoth, law, layers);
      const ContactPair without = pair_of(bodies, evaluation, Integration::kBoth, law);
      check_close(whole(with, bodies.pose(), Derivatives::kStiffness),
                  whole(without, bodies.pose(), Derivatives::kStiffness), 1e-13);
      CHECK((with.face_pressure(bodies.pose(), 0).pressure -
             without.face_pressure(bodies.pose(), 0).pressure)
                .norm() == 0.0);
      CHECK(whole(with, bodies.pose()).energy > 0.1);
    }
  }
}

TEST_CASE("[property] each face feels its own layer: two halves, two layers, two pairs") {
  const PairCase bodies = test::ellipsoid_in_dish(4, 40, 0.7e-3);
  // A law of the second layer: its E from M = (1 − ν) E / ((1 + ν)(1 − 2ν)).
  const double nu = kPlastic.poissons_ratio;
  const ElasticLayer second{kOther.modulus * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu), nu,
                            kOther.thickness};
  const ContactLaw laws[] = {ContactLaw(ThinLayerLogarithmicLaw{kPlastic}),
                             ContactLaw(ThinLayerLogarithmicLaw{second})};
  for (const Evaluation evaluation : {Evaluation::kExact, Evaluation::kFast}) {
    for (const Integration integration : {Integration::kFixed, Integration::kMoving}) {
      CAPTURE(name(evaluation));
      CAPTURE(name(integration));
      const bool of_fixed = integration == Integration::kFixed;
      const auto& mesh = of_fixed ? bodies.fixed.front() : bodies.moving;
      // Every third face in one half: both halves are everywhere.
      std::vector<Layer> by_face;
      std::vector<Eigen::Vector3i> halves[2];
      for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
        const bool other = f % 3 == 1;
        by_face.push_back(other ? kOther : layer_of(kPlastic));
        halves[other ? 1 : 0].emplace_back(mesh.faces.row(f));
      }
      PairLayers layers;
      if (of_fixed) {
        layers.fixed = {by_face};
      } else {
        layers.moving = by_face;
      }
      const Whole mixed =
          whole(pair_of(bodies, evaluation, integration, laws[0], layers), bodies.pose());
      Whole sum;
      for (int half = 0; half < 2; ++half) {
        PairCase part = bodies;
        auto& kept = of_fixed ? part.fixed.front() : part.moving;
        kept.faces.resize(static_cast<Eigen::Index>(halves[half].size()), 3);
        for (std::size_t f = 0; f < halves[half].size(); ++f) {
          kept.faces.row(static_cast<Eigen::Index>(f)) = halves[half][f];
        }
        const Whole one = whole(pair_of(part, evaluation, integration, laws[half]), bodies.pose());
        REQUIRE(one.energy > 0.05);
        sum.wrench += one.wrench;
        sum.energy += one.energy;
        sum.volume += one.volume;
        sum.area += one.area;
      }
      check_close(mixed, sum, 1e-12);  // sums in another order
    }
  }
}

TEST_CASE("[property] out of contact everything is exactly zero, also wide apart") {
  const PairCase bodies = test::ellipsoid_in_dish(4, 40);
  for (const Evaluation evaluation : {Evaluation::kExact, Evaluation::kFast}) {
    for (const Integration integration : kAll) {
      const ContactPair pair = pair_of(bodies, evaluation, integration);
      REQUIRE(whole(pair, bodies.pose()).energy > 0.0);
      const Vector3 up = test::general_placement(8).R * Vector3::UnitY();
      for (const double lift : {0.0013, 0.011, 0.4, 1e3}) {
        CAPTURE(lift);
        Pose pose = bodies.pose();
        pose.head<3>() += lift * up;
        const CompartmentLoads loads = pair.evaluate(pose, 0, Derivatives::kStiffness);
        CHECK(loads.wrench == Wrench::Zero());
        CHECK(loads.stiffness == Matrix6::Zero());
        CHECK(loads.energy + loads.volume + loads.area + loads.border_area + loads.max_depth +
                  loads.peak_pressure + loads.pressure_sum ==
              0.0);
        CHECK(loads.pressure_moment == Vector3::Zero());
        CHECK(!loads.back_face);
        CHECK(pair.face_pressure(pose, 0).depth.norm() == 0.0);
      }
    }
  }
}

TEST_CASE("[oracle] fast is exact but for the facets: less between finer meshes") {
  for (const Integration integration : kAll) {
    CAPTURE(name(integration));
    double before = 0.0;
    for (const int finer : {0, 1}) {
      const PairCase bodies = test::ellipsoid_in_dish(3 + 2 * finer, 16 << finer);
      const Whole exact = whole(pair_of(bodies, Evaluation::kExact, integration), bodies.pose());
      const Whole fast = whole(pair_of(bodies, Evaluation::kFast, integration), bodies.pose());
      const double off =
          (scaled(fast.wrench) - scaled(exact.wrench)).norm() / scaled(exact.wrench).norm();
      // Facets of 1.4 mm on a radius of 15 mm leave the surface by 1.4²/(8·15) = 16 um of 1 mm
      // deep; the spline goes through the middle of that. Half the edge: a quarter.
      CHECK(off < (finer == 1 ? 2e-3 : 8e-3));
      CHECK(std::abs(fast.volume / exact.volume - 1.0) < (finer == 1 ? 2e-3 : 8e-3));
      CHECK(off > 0.0);
      if (finer == 1) CHECK(off < 0.5 * before);
      before = off;
    }
  }
}

TEST_CASE("[error] what does not match is refused by name") {
  const auto ball = test::ellipsoid(1);
  const std::vector<geometry::TriangleMesh> two{test::dish(2), test::dish(3)};
  const ContactLaw layered(ThinLayerLogarithmicLaw{kPlastic});
  const auto make = [&](const ContactLaw& law, const PairLayers& layers) {
    return make_contact_pair(ball, two, law, {}, layers);
  };
  const auto refused = [](const std::string& text, const auto& call) {
    CHECK_THROWS_WITH_AS(call(), text.c_str(), std::invalid_argument);
  };
  const std::vector<Layer> eight(8, kOther), eighteen(18, kOther);
  CHECK_NOTHROW(make(layered, {std::vector<Layer>(80, kOther), {eight, eighteen}}));
  CHECK_NOTHROW(make(layered, {{}, {{}, eighteen}}));

  refused("layers: 1 lists for 2 compartments: must be one a compartment", [&] {
    make(layered, {{}, {eight}});
  });
  refused("layers of compartment 1: 8 for 18 faces: must be one a face", [&] {
    make(layered, {{}, {eight, eight}});
  });
  refused("layers of moving surface: 8 for 80 faces: must be one a face", [&] {
    make(layered, {eight, {}});
  });
  refused("layers of compartment 0: the law linear_volume has no elastic layer", [&] {
    make(ContactLaw{}, {{}, {eight, eighteen}});
  });
  refused("layers of moving surface: the law power has no elastic layer", [&] {
    make(ContactLaw(PowerLaw{3e12, 1.5}), {std::vector<Layer>(80, kOther), {}});
  });
  auto bad = eighteen;
  bad[7].modulus = std::numeric_limits<double>::quiet_NaN();
  refused("layers of compartment 1: face 7: modulus is nan Pa: must be finite and above 0", [&] {
    make(layered, {{}, {eight, bad}});
  });
  bad = eighteen;
  bad[2].thickness = -0.001;
  refused("layers of compartment 1: face 2: thickness is -0.001000 m: must be finite and above 0",
          [&] {
            make(layered, {{}, {eight, bad}});
          });

  refused("contact pair: no compartment: must have at least one",
          [&] { make_contact_pair(ball, {}); });
  refused("contact pair: a compartment without an integral",
          [] { ContactPair(std::vector<ContactPair::Compartment>(1)); });
  auto broken = two;
  broken[1].faces.resize(0, 3);
  refused("compartment 1: the mesh has no faces", [&] { make_contact_pair(ball, broken); });
  broken = two;
  broken[0].faces(3, 1) = 99;
  refused("compartment 0: a face uses vertex 99 of 9", [&] { make_contact_pair(ball, broken); });
  auto endless = ball;
  endless.vertices(4, 2) = std::numeric_limits<double>::infinity();
  refused("moving surface: the mesh has a vertex that is not finite",
          [&] { make_contact_pair(endless, two); });
}
