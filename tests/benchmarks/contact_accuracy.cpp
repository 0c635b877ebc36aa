// SPDX-License-Identifier: Apache-2.0
// How far `fast` is from `exact` over plausible poses, by the field's spacing: see README.md.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <vector>

#include "condyle/contact/fast_accuracy.hpp"
#include "condyle/contact/fast_evaluation.hpp"
#include "dm_pair.hpp"

namespace {

using namespace condyle;
using namespace condyle::contact;

void run(int count) {
  const benchmark::DmPair dm = benchmark::read_dm_pair();
  const auto exact = make_exact_evaluation(dm.femur, dm.compartments, ContactLaw{});
  PlausiblePoses box;
  box.settled = dm.settled;
  box.count = count;
  std::vector<Pose> poses;
  std::printf("%d poses: error of a side's force and moment against exact\n", count);
  std::printf(
      "spacing mm | F median %%  p99 %% | M median %%  p99 %% | p99 of error/tolerance F, M | "
      "worst\n");
  for (const double spacing : {0.35e-3, 0.5e-3, 0.7e-3, 1.0e-3}) {
    FastSettings settings;
    settings.field.spacing = spacing;
    const auto fast = make_fast_evaluation(dm.femur, dm.compartments, ContactLaw{}, settings);
    if (poses.empty()) poses = plausible_poses(*fast, box);
    const AccuracyReport r = measure_accuracy(*fast, *exact, poses);
    std::printf("%10.2f | %10.4f %6.3f | %10.4f %6.3f | %18.2f %8.2f | %.2f\n", 1e3 * spacing,
                100 * r.force_median, 100 * r.force_p99, 100 * r.moment_median, 100 * r.moment_p99,
                r.force_tolerance_p99, r.moment_tolerance_p99, r.worst);
    const Pose& w = r.worst_pose;
    std::printf("           worst pose %.6f %.6f %.6f %.5f %.5f %.5f\n", w[0], w[1], w[2], w[3],
                w[4], w[5]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? std::atoi(argv[1]) : 300);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_contact_accuracy: %s\n", error.what());
    return 1;
  }
}
