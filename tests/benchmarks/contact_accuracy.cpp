// SPDX-License-Identifier: Apache-2.0
// How far `fast` is from `exact` over plausible poses, by load and by the field's spacing: see
// README.md.
//
//   benchmark_contact_accuracy [poses] [spacing_mm ...]     2000 poses, the default spacing
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "condyle/contact/fast_accuracy.hpp"
#include "condyle/contact/mesh_contact.hpp"
#include "dm_pair.hpp"

namespace {

using namespace condyle;
using namespace condyle::contact;

void print_row(const char* name, const WrenchDeviations& d) {
  std::printf("%14s | %5d | %8.3f %7.3f | %8.3f %7.3f | %6.2f %6.2f | %6.2f %6.2f\n", name, d.count,
              100 * d.force.median, 100 * d.force.p99, 100 * d.moment.median, 100 * d.moment.p99,
              d.force.tolerance_p99, d.moment.tolerance_p99, d.force.tolerance_worst,
              d.moment.tolerance_worst);
}

void print_pose(const char* name, const Pose& p) {
  constexpr double kDegrees = 57.29577951308232;
  std::printf("worst %-5s  x %.3f  y %.4f  z %.3f mm  θx %.3f  θy %.3f  θz %.3f°\n", name,
              1e3 * p[0], 1e3 * p[1], 1e3 * p[2], kDegrees * p[3], kDegrees * p[4],
              kDegrees * p[5]);
}

void print_table(const AccuracyReport& report, WrenchDeviations LoadRange::*part,
                 const WrenchDeviations& all, const char* name) {
  std::printf(
      "%14s |     n | F median     99th %% | M median     99th %% | F, M 99th | F, M worst\n",
      name);
  for (const LoadRange& range : report.by_load) {
    char label[32];
    std::snprintf(label, sizeof label, "%.0f-%.0f N", range.from, range.to);
    print_row(label, range.*part);
  }
  print_row("all", all);
}

MeshContact contact_of(const benchmark::DmPair& dm, const MeshContactSettings& settings) {
  return MeshContact(dm.femur, {dm.compartments[kMedial], dm.compartments[kLateral]},
                     SideOfBody::kRight, ContactLaw{}, settings);
}

void run(int count, const std::vector<double>& spacings) {
  const benchmark::DmPair dm = benchmark::read_dm_pair();
  const MeshContact exact = contact_of(dm, {});
  PlausiblePoses box;
  box.settled = dm.settled;
  box.count = count;
  std::vector<Pose> poses;
  for (const double spacing : spacings) {
    MeshContactSettings settings;
    settings.pair.evaluation = Evaluation::kFast;
    settings.pair.field.spacing = spacing;
    const auto start = std::chrono::steady_clock::now();
    const MeshContact fast = contact_of(dm, settings);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (poses.empty()) poses = plausible_poses(fast, box);
    const AccuracyReport report = measure_accuracy(fast, exact, poses);
    std::printf(
        "spacing %.2f mm (built in %.1f s): %zu poses of %d; last columns: error/tolerance\n",
        1e3 * spacing, took.count(), poses.size(), count);
    print_table(report, &LoadRange::total, report.total, "total");
    print_table(report, &LoadRange::sides, report.sides, "sides");
    print_pose("total", report.total.worst_pose);
    print_pose("side", report.sides.worst_pose);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::vector<double> spacings;
    for (int i = 2; i < argc; ++i) spacings.push_back(1e-3 * std::atof(argv[i]));
    if (spacings.empty()) spacings.push_back(geometry::DistanceFieldSettings{}.spacing);
    run(argc > 1 ? std::atoi(argv[1]) : 2000, spacings);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_contact_accuracy: %s\n", error.what());
    return 1;
  }
}
