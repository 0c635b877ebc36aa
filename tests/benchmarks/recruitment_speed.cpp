// SPDX-License-Identifier: Apache-2.0
// How long recruitment of one time frame takes, from nothing, from the time frame before, and 11 of its derivatives: see
// README.md. recruitment_speed.py sets a general convex solver beside it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "condyle/recruitment/recruitment.hpp"

namespace condyle::recruitment {
namespace {

constexpr int kMuscles = 166, kCoordinates = 12, kFrames = 60, kDirections = 11, kRounds = 7;
constexpr double kMinMax = std::numeric_limits<double>::infinity();

struct Frame {
  RowMatrix arms;
  Vector loads, strengths, none;
  RecruitmentFrame view() const { return {arms, loads, strengths, none}; }
};

// A slow motion: arms and loads change by a few percent from one time frame to the next.
std::vector<Frame> motion() {
  std::mt19937_64 engine(7);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1.0p-53;
  };
  Frame first{RowMatrix::Zero(kCoordinates, kMuscles), Vector(), Vector(kMuscles), Vector()};
  Vector forces(kMuscles), phase(kMuscles);
  for (int i = 0; i < kMuscles; ++i) {
    first.strengths[i] = std::exp(draw(std::log(50.0), std::log(3000.0)));
    phase[i] = draw(0.0, 6.28);
    for (int k = 0; k < 4; ++k) first.arms((i + k) % kCoordinates, i) = draw(-0.06, 0.06);
  }
  std::vector<Frame> frames;
  for (int t = 0; t < kFrames; ++t) {
    Frame frame = first;
    for (int i = 0; i < kMuscles; ++i) {
      frame.arms.col(i) *= 1.0 + 0.1 * std::sin(0.1 * t + phase[i]);
      forces[i] = first.strengths[i] * std::max(0.0, 0.6 * std::sin(0.1 * t + phase[i]) - 0.1);
    }
    frame.loads = frame.arms * forces;
    frames.push_back(frame);
  }
  return frames;
}

/// Microseconds a time frame: the quickest of several rounds.
template <typename Body>
double quickest(const Body& body) {
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    body();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count());
  }
  return 1e6 * best / kFrames;
}

void row(const std::vector<Frame>& frames, double p) {
  RecruitmentSetup setup;
  setup.coordinates = kCoordinates;
  setup.muscles = kMuscles;
  RecruitmentSettings settings;
  settings.criterion.min_max = std::isinf(p);
  if (!std::isinf(p)) settings.criterion.exponent = p;
  RecruitmentSolver solver(setup, settings);
  int steps = 0, warm_steps = 0, failed = 0;
  double worst = 0.0;
  const double cold = quickest([&] {
    steps = failed = 0;
    for (const Frame& frame : frames) {
      const Recruitment& r = solver.solve(frame.view());
      steps += r.iterations;
      failed += r.converged() ? 0 : 1;
      worst = std::max(worst, r.kkt.largest());
    }
  });
  const double warm = quickest([&] {
    warm_steps = 0;
    for (const Frame& frame : frames) warm_steps += solver.solve(frame.view(), solver.warm_start()).iterations;
  });
  const RowMatrix loads = RowMatrix::Ones(kDirections, kCoordinates);
  const RowMatrix arms = RowMatrix::Constant(kDirections * kCoordinates, kMuscles, 1e-3);
  const RowMatrix strengths = RowMatrix::Ones(kDirections, kMuscles);
  RowMatrix df(kDirections, kMuscles), de(kDirections, kCoordinates);
  solver.solve(frames.front().view());
  const double derivatives = solver.result().converged() ? quickest([&] {
    for (int t = 0; t < kFrames; ++t) solver.forces_along(loads, arms, strengths, df, de);
  }) : 0.0;
  std::printf("| %7s | %7.1f | %5.1f | %7.1f | %5.1f | %9.2f | %9.1f | %8.1e | %6d |\n",
              std::isinf(p) ? "min-max" : std::to_string(p).substr(0, 4).c_str(), cold,
              steps / double(kFrames), warm, warm_steps / double(kFrames), cold / warm, derivatives, worst, failed);
}

}  // namespace
}  // namespace condyle::recruitment

int main() {
  const auto frames = condyle::recruitment::motion();
  std::printf("%d muscles, %d coordinates, %d time frames of a slow motion; us a time frame, one thread\n\n",
              condyle::recruitment::kMuscles, condyle::recruitment::kCoordinates, condyle::recruitment::kFrames);
  std::printf("| p | cold | steps | warm | steps | cold/warm | 11 derivatives | KKT | failed |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (double p : {1.0, 1.5, 2.0, 3.0, 5.0, condyle::recruitment::kMinMax}) condyle::recruitment::row(frames, p);
}
