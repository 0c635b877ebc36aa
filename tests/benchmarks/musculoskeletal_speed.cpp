// SPDX-License-Identifier: Apache-2.0
// How long each phase of one time frame of a musculoskeletal model takes, on one core and without contact: see README.md.
//
//     benchmark_musculoskeletal_speed MODEL.json MOTION.sto EXTERNAL_LOADS.xml PATHS.json [FROM TO]
//
// musculoskeletal_speed.py makes the files of the subject DM and sets OpenSim beside it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "condyle/fdk/musculoskeletal_frame.hpp"
#include "condyle/io/external_loads.hpp"
#include "condyle/io/model_file.hpp"
#include "condyle/io/motion_file.hpp"
#include "condyle/io/path_snapshot_file.hpp"

namespace condyle {
namespace {

constexpr int kRounds = 7;

struct Frames {
  std::vector<Eigen::VectorXd> q, qd, qdd;
  std::vector<std::vector<model::ExternalLoad>> loads;
  std::vector<std::size_t> rows;  // of the snapshots
  std::size_t count() const { return q.size(); }
};

Eigen::VectorXd in_model_order(const model::Model& model, const io::Motion& motion, const Eigen::VectorXd& values,
                               bool positions) {
  Eigen::VectorXd ordered(model.n_coordinates());
  for (int c = 0; c < model.n_coordinates(); ++c) {
    const auto& coordinate = model.description().coordinates[static_cast<std::size_t>(c)];
    const auto column = motion.find(coordinate.name);
    ordered[c] = column ? values[static_cast<Eigen::Index>(*column)] : positions ? coordinate.default_value : 0.0;
  }
  return ordered;
}

Frames read_frames(const model::Model& model, const io::Motion& motion, const io::ExternalLoads& loads,
                   const model::PathSnapshots& paths, double from, double to) {
  Frames frames;
  const numerics::NaturalSpline spline = io::motion_spline(motion);
  model::Kinematics kinematics(model);
  for (const double time : motion.times) {
    if (time < from || time > to) continue;
    frames.q.push_back(in_model_order(model, motion, spline(time, 0), true));
    frames.qd.push_back(in_model_order(model, motion, spline(time, 1), false));
    frames.qdd.push_back(in_model_order(model, motion, spline(time, 2), false));
    kinematics.set(frames.q.back());
    frames.loads.push_back(loads.in_ground(time, kinematics));
    const auto nearest = std::min_element(paths.times.begin(), paths.times.end(), [&](double a, double b) {
      return std::abs(a - time) < std::abs(b - time);
    });
    frames.rows.push_back(static_cast<std::size_t>(nearest - paths.times.begin()));
  }
  return frames;
}

double seconds(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int run(const std::vector<std::string>& arguments) {
  const model::Model model(io::read_model_file(arguments[0]));
  const io::Motion motion = io::read_motion(arguments[1]);
  const io::ExternalLoads loads = io::ExternalLoads::read(arguments[2]);
  const model::PathSnapshots paths = io::read_path_snapshots(arguments[3], model.description());
  const bool part = arguments.size() > 5;
  const Frames frames = read_frames(model, motion, loads, paths, part ? std::stod(arguments[4]) : -1e9,
                                    part ? std::stod(arguments[5]) : 1e9);
  fdk::MuscleSettings settings;
  settings.reserve_moment = 10.0;
  settings.reserve_price = 100.0;
  fdk::MusculoskeletalFrame frame(model, settings);
  const std::vector<std::string> phases{"kinematics", "inverse dynamics", "muscle paths and strengths", "ligaments",
                                        "recruitment, p = 3"};
  std::vector<double> best(phases.size(), std::numeric_limits<double>::infinity());
  std::size_t converged = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sum(phases.size(), 0.0);
    converged = 0;
    for (std::size_t i = 0; i < frames.count(); ++i) {
      sum[0] += seconds([&] { frame.set_motion(frames.q[i], frames.qd[i], frames.qdd[i]); });
      sum[1] += seconds([&] { frame.compute_dynamics(frames.loads[i]); });
      frame.hold_paths(&paths, frames.rows[i]);
      sum[2] += seconds([&] { frame.compute_muscles(); });
      sum[3] += seconds([&] { frame.compute_ligaments(); });
      sum[4] += seconds([&] { converged += frame.recruit().converged() ? 1 : 0; });
    }
    for (std::size_t p = 0; p < phases.size(); ++p) {
      best[p] = std::min(best[p], sum[p] / static_cast<double>(frames.count()));
    }
  }
  std::printf("%d bodies, %d coordinates, %zu muscles, %zu ligament strands; %zu time frames, %zu recruited\n",
              model.n_bodies(), model.n_coordinates(), model.description().muscles.size(),
              model.description().ligaments.size(), frames.count(), converged);
  double total = 0.0;
  for (std::size_t p = 0; p < phases.size(); ++p) {
    std::printf("  %-28s %7.1f µs\n", phases[p].c_str(), 1e6 * best[p]);
    total += best[p];
  }
  std::printf("  %-28s %7.1f µs a time frame\n", "all", 1e6 * total);
  return converged == frames.count() ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace condyle

int main(int argc, char** argv) {
  if (argc != 5 && argc != 7) {
    std::fprintf(stderr, "usage: %s MODEL.json MOTION.sto EXTERNAL_LOADS.xml PATHS.json [FROM TO]\n", argv[0]);
    return 2;
  }
  return condyle::run({argv + 1, argv + argc});
}
