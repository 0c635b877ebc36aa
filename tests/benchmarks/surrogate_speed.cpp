// SPDX-License-Identifier: Apache-2.0
// How long one pose takes by a surrogate, fused and through onnxruntime, beside the mesh contact it
// stands for, in one run and on one thread: see README.md.
//
//   benchmark_surrogate_speed [SURROGATE.onnx ...]
//
// Any surrogate files, of any architecture, full or wrench-only; without arguments, the files of
// runs/dm, else of runs/demo. A surrogate takes as long everywhere but where a side is free, most
// of whose work is left out: so rows of both kinds are printed.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "condyle/contact/fast_integral.hpp"
#include "condyle/geometry/distance_field_cache.hpp"
#include "condyle/surrogate/onnx_contact_model.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"
#include "dm_pair.hpp"
#include "naive_contact.hpp"

namespace condyle {
namespace {

using contact::ContactModel;
using contact::Derivatives;
using surrogate::OnnxContactModel;
using surrogate::Runtime;

constexpr std::size_t kPoses = 1024;

/// Microseconds of one call: the least of several rounds, since what else runs on the machine only
/// adds.
double microseconds(const std::function<void()>& call, double seconds_a_round) {
  using Clock = std::chrono::steady_clock;
  const auto time = [&](int calls) {
    const auto start = Clock::now();
    for (int i = 0; i < calls; ++i) call();
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  time(1);
  const int calls = std::max(1, static_cast<int>(seconds_a_round / std::max(time(1), 1e-7)));
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 9; ++round) least = std::min(least, time(calls) / calls);
  return 1e6 * least;
}

/// A number of the file's domain bounds, JSON of one object a bound.
double bound(const std::string& bounds, const std::string& which, const char* coordinate) {
  const auto begin = bounds.find('"' + which + '"');
  const std::string key = std::string("\"") + coordinate + "\": ";
  const auto at = begin == std::string::npos ? begin : bounds.find(key, begin);
  if (at == std::string::npos) throw std::runtime_error("domain_bounds has no " + which);
  return std::strtod(bounds.c_str() + at + key.size(), nullptr);
}

/// Poses of the box that the surrogate was trained in, at which it says that both sides press, or
/// that none or one does.
std::vector<Pose> draw_poses(const OnnxContactModel& model, bool both_loaded) {
  const std::string& bounds = model.metadata().at("condyle.domain_bounds");
  Pose low, high;
  constexpr std::array kCoordinates{"x", "y", "z", "theta_x", "theta_y", "theta_z"};
  for (int i = 0; i < 6; ++i) {
    const char* name = kCoordinates[static_cast<std::size_t>(i)];
    low[i] = bound(bounds, "pose_min", name);
    high[i] = bound(bounds, "pose_max", name);
  }
  // Domains reach far above contact.
  high[kY] = std::min(high[kY], low[kY] + 0.006);
  std::mt19937_64 generator(20260711);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Pose> poses;
  for (int draws = 0; poses.size() < kPoses && draws < 2'000'000; ++draws) {
    Pose pose;
    for (int i = 0; i < 6; ++i) pose[i] = low[i] + uniform(generator) * (high[i] - low[i]);
    const auto loads = model.evaluate(pose, Derivatives::kNone);
    const bool both = loads.wrench[kMedial][1] > 0.0 && loads.wrench[kLateral][1] > 0.0;
    if (both == both_loaded) poses.push_back(pose);
  }
  return poses;
}

struct Table {
  std::optional<double> naive;
  void row(const std::string& what, double us) const {
    std::printf("  %-46s %12.3f", what.c_str(), us);
    if (naive) std::printf(" %12.0f", *naive / us);
    std::printf("\n");
  }
};

void surrogate_rows(const Table& table, const OnnxContactModel& model,
                    const std::vector<Pose>& poses, const std::string& label) {
  std::size_t next = 0;
  const auto one = [&](Derivatives derivatives) {
    return microseconds(
        [&] { model.evaluate(poses[next = (next + 1) % poses.size()], derivatives); }, 0.02);
  };
  const std::size_t n = poses.size();
  std::vector<double> wrench(n * 12), stiffness(n * 72), error(n * 12), trust(n);
  const auto batch = [&](contact::LoadSpans to) {
    return microseconds([&] { model.evaluate_into(poses, 1, to); }, 0.02) / static_cast<double>(n);
  };
  const contact::LoadSpans wrench_alone{wrench, {}, {}, {}, {}};
  if (model.has_stiffness()) {
    table.row(label + ", one pose, all outputs", one(Derivatives::kStiffness));
    table.row(label + ", one pose, no stiffness", one(Derivatives::kNone));
    table.row(label + ", 1024 poses, all outputs", batch({wrench, stiffness, error, trust, {}}));
    table.row(label + ", 1024 poses, wrench + stiffness", batch({wrench, stiffness, {}, {}, {}}));
  } else {
    table.row(label + ", one pose, wrench", one(Derivatives::kNone));
  }
  table.row(label + ", 1024 poses, wrench", batch(wrench_alone));
}

double total_force(const contact::ContactPair& pair, const Pose& pose) {
  return pair.evaluate(pose, kMedial, Derivatives::kStiffness).wrench[1] +
         pair.evaluate(pose, kLateral, Derivatives::kStiffness).wrench[1];
}

/// The mesh contact of DM, 0.7 mm below first touch; nothing where the implant is not at hand.
void mesh_rows(Table& table) {
  try {
    const benchmark::DmPair dm = benchmark::read_dm_pair();
    const std::array<contact::SurfaceFaces, kSides> faces{
        contact::surface_faces(dm.compartments[0]), contact::surface_faces(dm.compartments[1])};
    const geometry::SignedDistance distance(dm.femur);
    const auto exact = contact::make_contact_pair(dm.femur, dm.compartments);
    const auto field = geometry::load_or_build_distance_field(dm.femur, {}, {}).field;
    std::vector<contact::ContactPair::Compartment> parts;
    for (const auto& part : faces) {
      parts.push_back({contact::make_fast_integral(field, part, contact::ContactLaw{},
                                                   contact::best_instruction_set()),
                       nullptr});
    }
    const contact::ContactPair fast(std::move(parts));
    Pose pose = dm.settled;
    pose[kY] -= 0.7e-3;
    int loaded = 0;
    volatile double sink = 0.0;  // so that nothing is optimised away
    table.naive =
        microseconds([&] { sink = benchmark::naive_force(distance, faces, pose, loaded); }, 0.05);
    table.row("mesh, naive, force alone", *table.naive);
    table.row("mesh, exact, wrench + stiffness",
              microseconds([&] { sink = total_force(exact, pose); }, 0.05));
    table.row("mesh, fast, wrench + stiffness",
              microseconds([&] { sink = total_force(fast, pose); }, 0.02));
  } catch (const std::runtime_error& error) {
    std::printf("  (no mesh contact: %s)\n", error.what());
  }
}

/// The file to measure where none is named: empty if there is none.
std::string file_of_a_run(const char* name) {
  for (const char* run : {"dm", "demo"}) {
    const auto file = std::filesystem::path(CONDYLE_RUNS) / run / name;
    if (std::filesystem::exists(file)) return file.string();
  }
  return {};
}

void run(const std::vector<std::string>& files) {
  if (std::strlen(CONDYLE_ONNXRUNTIME_LIBRARY) > 0) {
    surrogate::set_library_path(CONDYLE_ONNXRUNTIME_LIBRARY);
  }
  Table table;
  std::printf("%-46s %14s %12s\n", "mesh contact, 0.7 mm", "us a pose", "x naive");
  mesh_rows(table);
  for (const std::string& file : files) {
    const OnnxContactModel model(file);
    const bool is_fused = model.fused_refusal().empty();
    std::printf("%s (%s; %s)\n", std::filesystem::path(file).filename().c_str(),
                model.metadata().at("condyle.architecture").c_str(),
                is_fused ? ("fused kernels: " + model.instruction_set()).c_str()
                         : ("not fused: " + model.fused_refusal()).c_str());
    for (const bool both : {true, false}) {
      const auto poses = draw_poses(model, both);
      if (poses.size() < kPoses) continue;
      std::printf(" %s\n", both ? "both sides loaded" : "one side or both free");
      for (const Runtime runtime : {Runtime::kOnnxruntime, Runtime::kFused}) {
        if (runtime == Runtime::kFused && !is_fused) continue;
        surrogate_rows(table, OnnxContactModel(file, runtime), poses, name(runtime));
      }
    }
  }
}

}  // namespace
}  // namespace condyle

int main(int argc, char** argv) {
  try {
    std::vector<std::string> files(argv + 1, argv + argc);
    if (files.empty()) {
      for (const char* name : {"surrogate.onnx", "surrogate_wrench.onnx"}) {
        const std::string file = condyle::file_of_a_run(name);
        if (!file.empty()) files.push_back(file);
      }
    }
    if (files.empty()) {
      std::printf("no surrogate: name one, or make one by `condyle demo`\n");
      return 0;
    }
    condyle::run(files);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_surrogate_speed: %s\n", error.what());
    return 1;
  }
}
