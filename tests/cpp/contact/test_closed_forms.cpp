// SPDX-License-Identifier: Apache-2.0
// Contacts in closed form, of this law: pressure p = W′(d) along the distance's slope, integrated
// over one body's faces or the other's. Each formula is derived above its test.
//
// A facet lies up to edge²/(8R) below the surface it stands for, and a face counts or not by its
// centroid, where the depth is 0: both errors fall with the square of the edge. Every formula is
// held to at three depths and three finenesses, and the error's order is asserted.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "contact/closed_form_scenes.hpp"
#include "contact/field_folder.hpp"

using namespace condyle;
using namespace condyle::contact;
using condyle::test::Oracle;
using condyle::test::OracleErrors;
using std::numbers::pi;

namespace {

constexpr double kModulus = 9.3e9;
constexpr double kRadius = 0.0213, kOtherRadius = 0.0387;
constexpr double kDepths[] = {0.31e-3, 0.74e-3, 1.63e-3};

PairSettings settings_of(Integration integration, Evaluation evaluation = Evaluation::kExact) {
  static const test::FieldFolder fields("closed-forms");
  PairSettings settings;
  settings.evaluation = evaluation;
  settings.integration = integration;
  settings.cache_directory = fields.path();
  settings.threads = 1;
  return settings;
}

Oracle upward(double energy, double volume, double force) {
  return {energy, volume, {0.0, force, 0.0}, Vector3::Zero()};
}

// Asserts that an error falls with the square of the edge: three finenesses, each twice the last.
// Faces that cross the contact's rim come and go with the grid, so single ratios scatter; over the
// factor of four between the first and the last they may take 0.4 of the order away, or give it. An
// error at rounding has no order.
void check_second_order(const std::array<double, 3>& errors) {
  CAPTURE(errors[0]);
  CAPTURE(errors[1]);
  CAPTURE(errors[2]);
  if (errors[0] < 1e-11) {
    CHECK(errors[2] < 1e-11);
    return;
  }
  const double order = 0.5 * std::log2(errors[0] / errors[2]);
  CHECK(order > 1.6);
  CHECK(order < 2.6);
}

// Holds a scene to its oracle at three finenesses. @param coarsest relative error allowed there.
void check_converges(const std::function<OracleErrors(int)>& errors_at, double coarsest) {
  std::array<double, 3> energy{}, volume{}, force{};
  for (int level = 0; level < 3; ++level) {
    CAPTURE(level);
    const OracleErrors e = errors_at(1 << level);
    const auto l = static_cast<std::size_t>(level);
    energy[l] = e.energy, volume[l] = e.volume, force[l] = e.force;
    CHECK(e.border_area == 0.0);
    CHECK(e.worst() < coarsest * std::pow(3.0, -level));
  }
  check_second_order(energy);
  check_second_order(volume);
  check_second_order(force);
}

// Sphere into plane. R radius, δ depth, h = R − δ the centre's height.
// Over the plane, t = R − ρ the depth at distance ρ from the centre, dA = 2πρ dρ, slope h/ρ:
//   V = 2π∫t(R − t)dt = πδ²(R − 2δ/3),  F = 2πh∫p(t)dt = 2πh W(δ),  U = 2π∫W(t)(R − t)dt.
// Over the sphere, dA = 2πR dt, slope 1:
//   V = πRδ²,  F = 2πR∫p(t)dt = 2πR W(δ),  U = 2πR∫W(t)dt.
// With W = Kt²/2: F = Kπδ²(R − δ) and KπRδ²; U = Kπδ³(R/3 − δ/4) and KπRδ³/3.
Oracle sphere_on_plane(Integration over, double R, double depth) {
  const double d2 = depth * depth, d3 = d2 * depth;
  if (over == Integration::kFixed) {
    return upward(kModulus * pi * d3 * (R / 3.0 - depth / 4.0), pi * d2 * (R - 2.0 * depth / 3.0),
                  kModulus * pi * d2 * (R - depth));
  }
  return upward(kModulus * pi * R * d3 / 3.0, pi * R * d2, kModulus * pi * R * d2);
}

OracleErrors sphere_on_plane_errors(const PairSettings& settings, const ContactLaw& law,
                                    double depth, int cells, const Oracle& oracle) {
  const double half = 1.35 * std::sqrt(2.0 * kRadius * depth);  // the rim is at √(2Rδ)
  // A plane is a plane in a few faces, where its faces are not what is integrated.
  const int across = settings.integration == Integration::kMoving ? 6 : cells;
  return test::errors(test::upside_down(test::cap(kRadius, cells, half)), test::plane(across, half),
                      test::turned({0.0, kRadius - depth, 0.0}, 0.03), law, settings, oracle);
}

}  // namespace

TEST_CASE("[oracle] sphere into plane, over the plane and over the sphere") {
  for (const Integration over : {Integration::kFixed, Integration::kMoving}) {
    for (const double depth : kDepths) {
      CAPTURE(name(over));
      CAPTURE(depth);
      const Oracle oracle = sphere_on_plane(over, kRadius, depth);
      check_converges(
          [&](int finer) {
            return sphere_on_plane_errors(settings_of(over), {}, depth, 24 * finer, oracle);
          },
          0.03);
    }
  }
}

TEST_CASE("[oracle] sphere into plane, the mean of both volumes is the cap") {
  // π δ² (R − δ/3), the part of the ball below the plane.
  for (const double depth : kDepths) {
    CAPTURE(depth);
    const Oracle plane = sphere_on_plane(Integration::kFixed, kRadius, depth);
    const Oracle sphere = sphere_on_plane(Integration::kMoving, kRadius, depth);
    const Oracle oracle =
        upward(0.5 * (plane.energy + sphere.energy), pi * depth * depth * (kRadius - depth / 3.0),
               0.5 * (plane.force.y() + sphere.force.y()));
    const OracleErrors e =
        sphere_on_plane_errors(settings_of(Integration::kBoth), {}, depth, 64, oracle);
    CHECK(e.worst() < 6e-3);
  }
}

TEST_CASE("[oracle] over the sphere, the force is four times as large when the depth doubles") {
  const auto cap = test::upside_down(test::cap(kRadius, 96, 0.011));
  const auto plane = test::plane(4, 0.02);
  const ContactPair pair = make_contact_pair(cap, {plane}, {}, settings_of(Integration::kMoving));
  const auto force = [&](double depth) {
    const RigidTransform X = test::turned({0.0, kRadius - depth, 0.0}, 0.03);
    return pair.evaluate(pose_from_transform(X), 0, Derivatives::kNone).wrench[kY];
  };
  for (const double depth : kDepths) {
    // Both within edge²/R of a depth.
    CHECK(force(depth) / force(0.5 * depth) == doctest::Approx(4.0).epsilon(6e-3));
  }
}

// Sphere into sphere. Radii P of the integrated one and D of the one whose distance is taken,
// centres L apart, δ = P + D − L. On P a ring at distance ρ from D's centre has area 2πPρ dρ/L, and
// with t = D − ρ its depth:
//   V = (2πP/L)∫t(D − t)dt = (πPδ²/L)(D − 2δ/3),
//   U = (πPK/L)(Dδ³/3 − δ⁴/4),
//   F = −dU/dL = πPK[δ²(D − δ)/L + (Dδ³/3 − δ⁴/4)/L²].
TEST_CASE("[oracle] sphere into sphere, over either") {
  for (const Integration over : {Integration::kFixed, Integration::kMoving}) {
    for (const double depth : kDepths) {
      CAPTURE(name(over));
      CAPTURE(depth);
      const bool fixed = over == Integration::kFixed;
      const double P = fixed ? kOtherRadius : kRadius, D = fixed ? kRadius : kOtherRadius;
      const double L = P + D - depth, d2 = depth * depth, d3 = d2 * depth;
      const double u = D * d3 / 3.0 - depth * d3 / 4.0;
      const Oracle oracle =
          upward(pi * P * kModulus * u / L, pi * P * d2 / L * (D - 2.0 * depth / 3.0),
                 pi * P * kModulus * (d2 * (D - depth) / L + u / (L * L)));
      check_converges(
          [&](int finer) {
            const double half = 1.2 * std::sqrt(2.0 * depth / (1.0 / P + 1.0 / D));
            return test::errors(test::upside_down(test::cap(kRadius, 24 * finer, half)),
                                test::cap(kOtherRadius, 24 * finer, half),
                                test::turned({0.0, L, 0.0}, 0.02), {}, settings_of(over), oracle);
          },
          0.04);
    }
  }
}

// Cylinder into plane, over a length ℓ; h = R − δ, a = √(R² − h²).
// Over the plane, ρ² = x² + h²:
//   V = ℓ∫(R − ρ)dx = ℓ(aR − h² asinh(a/h)),   F = Kℓh∫(R/ρ − 1)dx = 2Kℓh(R asinh(a/h) − a),
//   U = Kℓ/2∫(R − ρ)²dx = Kℓ(R²a + a h² + a³/3 − R(aR + h² asinh(a/h)))
// since ∫ρ dx = aR + h² asinh(a/h), ∫ρ²dx = 2(a³/3 + ah²), ∫dx = 2a.
// Over the cylinder, depth R cos θ − h up to θ0 = acos(h/R):
//   V = 2ℓR(a − hθ0),  F = K V,
//   U = (KℓR/2)∫(R cos θ − h)²dθ = (KℓR/2)(R²θ0 − 3ha + 2h²θ0), as ∫cos² = θ0 + ah/R².
TEST_CASE("[oracle] cylinder into plane, over a length") {
  const double length = 0.0137, R = kRadius;
  for (const Integration over : {Integration::kFixed, Integration::kMoving}) {
    for (const double depth : kDepths) {
      CAPTURE(name(over));
      CAPTURE(depth);
      const bool fixed = over == Integration::kFixed;
      const double h = R - depth, a = std::sqrt(R * R - h * h), area = h * h * std::asinh(a / h),
                   angle = std::acos(h / R);
      const double by_K = fixed ? R * R * a + a * h * h + a * a * a / 3.0 - R * (a * R + area)
                                : 0.5 * R * (R * R * angle - 3.0 * h * a + 2.0 * h * h * angle);
      const double volume = fixed ? a * R - area : 2.0 * R * (a - h * angle);
      const double force = fixed ? 2.0 * h * (R * std::asinh(a / h) - a) : volume;
      const Oracle oracle =
          upward(kModulus * length * by_K, length * volume, kModulus * length * force);
      check_converges(
          [&](int finer) {
            // What is integrated is the shorter of the two; its faces' ends are its length's.
            const double width = 1.31 * a, shorter = 0.5 * length, longer = 0.7 * length;
            const auto plane = test::strip(width, fixed ? shorter : longer, 24 * finer, 12 * finer);
            const auto roll = test::upside_down(
                test::arc(R, width, fixed ? longer : shorter, 26 * finer, 12 * finer));
            return test::errors(roll, plane, {Matrix3::Identity(), {0.07 * a, h, 0.0}}, {},
                                settings_of(over), [&] {
                                  Oracle moved = oracle;
                                  moved.moment.z() = 0.07 * a * oracle.force.y();
                                  return moved;
                                }());
          },
          0.05);
    }
  }
}

// A flat rectangle w × b pressed into a half space, tilted by α about its z, its middle δ below the
// plane: depth δ + us along it, s = sin α, |u| <= w/2. The force is along the plane's normal.
//   Loaded all over: V = wbδ,  U = (Kwb/2)(δ² + s²w²/12),  moment about the middle K b s w³/12 cos
//   α. Lifted off at one side, T = δ + sw/2 the deepest: V = bT²/(2s),  U = K b T³/(6s), moment K b
//   cos α ∫u(δ + us)du = (K b cos α/s²)(T³/3 − δT²/2).
TEST_CASE("[oracle] a tilted flat punch: force, and moment by the tilt") {
  const double w = 0.0171, b = 0.0093, K = kModulus;
  struct Punch {
    double depth, tilt;
  };
  for (const auto& [depth, tilt] :
       {Punch{0.9e-3, 0.061}, Punch{0.4e-3, 0.127}, Punch{-0.2e-3, 0.083}}) {
    const double s = std::sin(tilt), T = depth + 0.5 * s * w;
    const bool all = depth - 0.5 * s * w > 0.0;
    const double volume = all ? w * b * depth : b * T * T / (2.0 * s);
    const double energy = all ? 0.5 * K * w * b * (depth * depth + s * s * w * w / 12.0)
                              : K * b * T * T * T / (6.0 * s);
    const double turn =
        K * b * std::cos(tilt) *
        (all ? s * w * w * w / 12.0 : (T * T * T / 3.0 - depth * T * T / 2.0) / (s * s));
    // Over the punch as the moving body, and over it as the fixed one under a tilted half space.
    for (const Integration over : {Integration::kFixed, Integration::kMoving}) {
      CAPTURE(name(over));
      CAPTURE(depth);
      const Matrix3 R_tilt = Eigen::AngleAxisd(tilt, Vector3::UnitZ()).toRotationMatrix();
      std::array<double, 3> volumes{}, energies{}, moments{};
      for (std::size_t level = 0; level < 3; ++level) {
        const int cells = 20 << level;
        const auto punch = test::strip(0.5 * w, 0.5 * b, cells, cells / 2);
        const auto ground = test::plane(7, 0.03);
        OracleErrors e{};
        if (over == Integration::kMoving) {
          // Tilted by −α about z: +u is deeper, and what pushes up there turns it about +z.
          const auto facing_down = test::moved(
              punch, {Eigen::AngleAxisd(pi, Vector3::UnitX()).toRotationMatrix(), Vector3::Zero()});
          const double aside = 0.0013, force = K * volume;
          e = test::errors(facing_down, ground, {R_tilt.transpose(), {aside, -depth, 0.0}}, {},
                           settings_of(over),
                           {energy, volume, {0.0, force, 0.0}, {0.0, 0.0, turn + aside * force}});
        } else {
          // The half space's outward normal n; it reaches δ along n beyond the punch's middle.
          const Vector3 n(-s, -std::cos(tilt), 0.0);
          e = test::errors(test::upside_down(ground), punch, {R_tilt.transpose(), depth * n}, {},
                           settings_of(over), {energy, volume, -K * volume * n, {0.0, 0.0, turn}});
        }
        volumes[level] = e.volume, energies[level] = e.energy, moments[level] = e.moment;
        CHECK(e.border_area == 0.0);
        CHECK(e.worst() < 0.02 * std::pow(3.0, -static_cast<double>(level)));
        CHECK(e.force == doctest::Approx(e.volume).epsilon(1e-6));
        // The depth is linear in u: midpoints are exact until it ends.
        if (all) CHECK(e.volume < 1e-12);
      }
      check_second_order(volumes);
      check_second_order(energies);
      check_second_order(moments);
    }
  }
}

// Laws by their formulas, written down again here.
namespace {

struct LawCase {
  ContactLaw law;
  std::function<double(double)> pressure, energy, energy_integral;  // p, W, ∫W
};

std::array<LawCase, 3> law_cases() {
  const double E = 463e6, nu = 0.46, h = 0.0093,
               M = (1.0 - nu) * E / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double c = 7.1e11, n = 1.7;
  const ElasticLayer layer{E, nu, h};
  return {{{ContactLaw(ThinLayerLinearLaw{layer}), [=](double d) { return M * d / h; },
            [=](double d) { return 0.5 * M * d * d / h; },
            [=](double d) { return M * d * d * d / (6.0 * h); }},
           // p = −M ln(1 − s); W = Mh[(1 − s)ln(1 − s) + s];
           // ∫W = Mh²[s²/2 + ((1 − s)² − 1)/4 − (1 − s)² ln(1 − s)/2].
           {ContactLaw(ThinLayerLogarithmicLaw{layer}),
            [=](double d) { return -M * std::log1p(-d / h); },
            [=](double d) {
              const double r = 1.0 - d / h;
              return M * h * (r * std::log(r) + 1.0 - r);
            },
            [=](double d) {
              const double s = d / h, r = 1.0 - s;
              return M * h * h * (0.5 * s * s + 0.25 * (r * r - 1.0) - 0.5 * r * r * std::log(r));
            }},
           {ContactLaw(PowerLaw{c, n}), [=](double d) { return c * std::pow(d, n); },
            [=](double d) { return c * std::pow(d, n + 1.0) / (n + 1.0); },
            [=](double d) { return c * std::pow(d, n + 2.0) / ((n + 1.0) * (n + 2.0)); }}}};
}

}  // namespace

TEST_CASE("[oracle] any law under a flat punch: F = A p(d), U = A W(d)") {
  const double half_x = 0.0071, half_z = 0.0043, area = 4.0 * half_x * half_z;
  for (const LawCase& any : law_cases()) {
    CAPTURE(any.law.describe().name);
    for (const double depth : kDepths) {
      for (const Integration over : {Integration::kFixed, Integration::kMoving}) {
        const auto small = test::strip(half_x, half_z, 5, 3);
        const auto large = test::plane(4, 0.03);
        const bool fixed = over == Integration::kFixed;
        const Vector3 at(0.0021, -depth, -0.0012);
        Oracle oracle = upward(area * any.energy(depth), area * depth, area * any.pressure(depth));
        // The force goes through the small one's middle.
        const Vector3 middle = fixed ? Vector3::Zero() : at;
        oracle.moment = middle.cross(oracle.force);
        const OracleErrors e =
            test::errors(test::upside_down(fixed ? large : small), fixed ? small : large,
                         test::turned(at), any.law, settings_of(over), oracle);
        // Depths of 3e-4 m out of coordinates of 0.1 m, to 1e-17: 1e-13, times the law's power.
        CHECK(e.worst() < 1e-11);
      }
    }
  }
}

TEST_CASE("[oracle] sphere into plane under any law: F = 2πR W(δ) over the sphere") {
  for (const LawCase& any : law_cases()) {
    CAPTURE(any.law.describe().name);
    for (const double depth : kDepths) {
      CAPTURE(depth);
      const double volume = pi * kRadius * depth * depth;
      const Oracle oracle = upward(2.0 * pi * kRadius * any.energy_integral(depth), volume,
                                   2.0 * pi * kRadius * any.energy(depth));
      check_converges(
          [&](int finer) {
            return sphere_on_plane_errors(settings_of(Integration::kMoving), any.law, depth,
                                          24 * finer, oracle);
          },
          0.04);
    }
    // Over the plane the same with the centre's height in place of the radius, for the force.
    const double depth = kDepths[1], U = [&] {  // 2π∫W(t)(R − t)dt, by Simpson's rule to 1e-10
      const int n = 2000;
      double sum = 0.0;
      for (int i = 0; i <= n; ++i) {
        const double t = depth * i / n, weight = i == 0 || i == n ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
        sum += weight * any.energy(t) * (kRadius - t);
      }
      return 2.0 * pi * sum * depth / (3.0 * n);
    }();
    const Oracle oracle = upward(U, pi * depth * depth * (kRadius - 2.0 * depth / 3.0),
                                 2.0 * pi * (kRadius - depth) * any.energy(depth));
    CHECK(sphere_on_plane_errors(settings_of(Integration::kFixed), any.law, depth, 96, oracle)
              .worst() < 4e-3);
  }
}

TEST_CASE("[oracle] the fast evaluation keeps to the closed forms") {
  for (const Integration over : {Integration::kFixed, Integration::kMoving, Integration::kBoth}) {
    for (const double depth : kDepths) {
      if (depth == kDepths[1]) continue;  // fields take time
      CAPTURE(name(over));
      CAPTURE(depth);
      const Oracle plane = sphere_on_plane(Integration::kFixed, kRadius, depth);
      const Oracle sphere = sphere_on_plane(Integration::kMoving, kRadius, depth);
      Oracle oracle = over == Integration::kFixed ? plane : sphere;
      if (over == Integration::kBoth) {
        oracle = upward(0.5 * (plane.energy + sphere.energy), 0.5 * (plane.volume + sphere.volume),
                        0.5 * (plane.force.y() + sphere.force.y()));
      }
      PairSettings settings = settings_of(over, Evaluation::kFast);
      settings.field.spacing = 0.45e-3;
      std::array<double, 3> force{};
      for (std::size_t level = 0; level < 3; ++level) {
        const OracleErrors e = sphere_on_plane_errors(settings, {}, depth, 24 << level, oracle);
        force[level] = e.force;
        CHECK(e.worst() < 0.03 * std::pow(3.0, -static_cast<double>(level)));
      }
      check_second_order(force);
    }
  }
}
