// SPDX-License-Identifier: Apache-2.0
// How long one pose of the reference contact takes, by each evaluation, on one thread: see
// README.md.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "condyle/contact/fast_integral.hpp"
#include "condyle/geometry/distance_field_cache.hpp"
#include "condyle/geometry/signed_distance.hpp"
#include "dm_pair.hpp"
#include "naive_contact.hpp"

namespace {

using namespace condyle;
using namespace condyle::contact;

double total_force(const ContactPair& contact, const Pose& pose, Derivatives derivatives) {
  return contact.evaluate(pose, kMedial, derivatives).wrench[1] +
         contact.evaluate(pose, kLateral, derivatives).wrench[1];
}

void row(const char* what, double seconds, double naive, double exact, double force) {
  std::printf("  %-34s %10.1f us  %7.1f x naive  %6.1f x exact   Fy %9.3f N\n", what, 1e6 * seconds,
              naive / seconds, exact / seconds, force);
}

void run() {
  const benchmark::DmPair dm = benchmark::read_dm_pair();
  const std::array<SurfaceFaces, kSides> faces{surface_faces(dm.compartments[0]),
                                               surface_faces(dm.compartments[1])};
  const geometry::SignedDistance distance(dm.femur);
  const auto exact = make_contact_pair(dm.femur, dm.compartments);
  const double build =
      benchmark::quickest(1, 1, [&] { geometry::load_or_build_distance_field(dm.femur, {}, {}); });
  const auto cache = std::filesystem::temp_directory_path() / "condyle-benchmark-cache";
  const auto field = geometry::load_or_build_distance_field(dm.femur, {}, cache).field;
  const double load = benchmark::quickest(
      3, 1, [&] { geometry::load_or_build_distance_field(dm.femur, {}, cache); });
  std::filesystem::remove_all(cache);
  const double mebibytes =
      static_cast<double>(field->spline().count()) * (sizeof(float) + 2) / 1048576;
  std::printf(
      "distance field: spacing %.2f mm, %zu nodes, %.0f MiB, built in %.1f s, read in %.2f s\n",
      1e3 * field->spline().spacing, field->spline().count(), mebibytes, build, load);
  for (const double depth : {0.5e-3, 0.7e-3, 0.9e-3, 1.2e-3}) {
    Pose pose = dm.settled;
    pose[kY] -= depth;
    int loaded = 0;
    double force = 0.0;
    const double naive = benchmark::quickest(
        5, 1, [&] { force = benchmark::naive_force(distance, faces, pose, loaded); });
    std::printf("depth %.1f mm, %d loaded faces of %d\n", 1e3 * depth, loaded,
                static_cast<int>(faces[0].count() + faces[1].count()));
    row("naive", naive, naive, naive, force);
    const double reference = benchmark::quickest(
        5, 1, [&] { force = total_force(exact, pose, Derivatives::kStiffness); });
    row("exact, wrench + stiffness", reference, naive, reference, force);
    for (const auto set :
         {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (set > best_instruction_set()) continue;
      std::vector<ContactPair::Compartment> parts;
      for (const SurfaceFaces& part : faces) {
        parts.push_back({make_fast_integral(field, part, ContactLaw{}, set), nullptr});
      }
      const ContactPair fast(std::move(parts));
      for (const auto derivatives : {Derivatives::kNone, Derivatives::kStiffness}) {
        const double took =
            benchmark::quickest(100, 10, [&] { force = total_force(fast, pose, derivatives); });
        char what[64];
        std::snprintf(what, sizeof what, "fast (%s), wrench%s", name(set),
                      derivatives == Derivatives::kStiffness ? " + stiffness" : "");
        row(what, took, naive, reference, force);
      }
    }
  }
}

}  // namespace

int main() {
  try {
    run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_contact_speed: %s\n", error.what());
    return 1;
  }
}
