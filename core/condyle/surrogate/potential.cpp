// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/potential.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace condyle::surrogate {
namespace {

constexpr int kPose = 6;
constexpr std::size_t kLoads = 6;
constexpr std::size_t kMatrix = 36;
constexpr int kThetaX = 3;
constexpr int kThetaY = 4;
/// Poses of a piece, and of those the ones whose tangents are formed together.
constexpr std::size_t kMostPoses = kMaxDenseColumns;
constexpr std::size_t kTangentPoses = kMaxDenseColumns / kPoseColumns;
/// Doubles for the layers of one evaluation: 128 KB, of which networks of 3 × 30 use half.
constexpr std::size_t kMemory = 16384;

int rounded_up(int width) { return (width + kDenseStep - 1) / kDenseStep * kDenseStep; }

std::size_t memory_for(std::size_t poses, std::size_t layers, std::size_t stride) {
  // h and δ of every pose, S of every layer but the first, and one layer's h'.
  return stride * layers * (2 * poses + kDenseTangents * std::min(poses, kTangentPoses));
}

/// N^exponent: the powers that energies between surfaces have, by quicker means.
double power_of(double depth, double exponent) {
  if (exponent == 1.0) return depth;
  if (exponent == 0.5) return std::sqrt(depth);
  return std::pow(depth, exponent);
}

}  // namespace

/// R at a pose: what makes a generalised force a wrench.
struct Potential::Turn {
  double sin_x, cos_x, sin_y, cos_y;

  Turn() {}  // left as it is
  explicit Turn(const Pose& pose)
      : sin_x(std::sin(pose[kThetaX])),
        cos_x(std::cos(pose[kThetaX])),
        sin_y(std::sin(pose[kThetaY])),
        cos_y(std::cos(pose[kThetaY])) {}

  /// wrench[i·step] from force[i·step].
  void apply(const double* force, int step, double* wrench) const {
    const double about_x = force[3 * step], about_y = force[4 * step];
    const double rest = (force[5 * step] + sin_y * about_x) / cos_y;
    for (int i = 0; i < 3; ++i) wrench[i * step] = force[i * step];
    wrench[3 * step] = -about_x;
    wrench[4 * step] = -cos_x * about_y - sin_x * rest;
    wrench[5 * step] = sin_x * about_y - cos_x * rest;
  }

  /// Adds what the angles themselves change: (∂R/∂θx)·Q and (∂R/∂θy)·Q.
  void add_derivative(const double* force, const double* wrench, double* stiffness) const {
    stiffness[4 * kPose + kThetaX] += wrench[5];
    stiffness[5 * kPose + kThetaX] -= wrench[4];
    const double growth = (force[3] + sin_y * force[5]) / (cos_y * cos_y);
    stiffness[4 * kPose + kThetaY] -= sin_x * growth;
    stiffness[5 * kPose + kThetaY] -= cos_x * growth;
  }
};

/// One side's evaluation. Left as it is when made.
struct Potential::Memory {
  Memory() {}
  alignas(64) std::array<double, kMemory> layers;
  alignas(64) std::array<double, kMostPoses * kDenseStep> inputs;    // poses
  alignas(64) std::array<double, kMostPoses * kDenseStep> gradient;  // G, later ∂N/∂p
  alignas(64) std::array<double, kMostPoses * kDenseStep> scratch;
  std::array<double, kTangentPoses * kDensePairs> pairs;  // ∂²N/∂p², k ≤ m
  std::array<double, kMostPoses> depth;                   // N
  std::array<std::size_t, kMostPoses> pose;               // number of each loaded pose
  std::array<Turn, kMostPoses> turns;                     // of every pose
  double* hidden = nullptr;                               // layer by layer
  double* delta = nullptr;
  double* sums_tangent = nullptr;
  double* tangent = nullptr;

  /// Lays the layers out for so many poses.
  void lay_out(const Energy& side, std::size_t poses) {
    const auto stride = static_cast<std::size_t>(side.stride);
    const std::size_t n = side.hidden.size(), tangents = std::min(poses, kTangentPoses);
    hidden = layers.data();
    delta = hidden + n * poses * stride;
    sums_tangent = delta + n * poses * stride;
    tangent = sums_tangent + (n - 1) * kDenseTangents * tangents * stride;
  }
};

Potential::Energy Potential::prepare(const PotentialSide& given) {
  const DenseNetwork checked(given.layers);
  if (checked.inputs() != kPose || checked.outputs() != 1 || given.layers.size() < 2) {
    throw std::invalid_argument(
        "potential surrogate: a network must be 6 to 1, with a hidden layer");
  }
  if (!(given.exponent > 0.0)) {
    throw std::invalid_argument("potential surrogate: exponent " + std::to_string(given.exponent) +
                                " must be positive");
  }
  Energy side;
  side.stride = checked.stride();
  side.constants = given;
  side.constants.layers.clear();
  for (std::size_t l = 0; l + 1 < given.layers.size(); ++l) {
    const DenseLayer& from = given.layers[l];
    Layer to{from.inputs, rounded_up(from.outputs), rounded_up(from.inputs), {}, from.bias, {},
             from.outputs};
    const auto n_in = static_cast<std::size_t>(from.inputs);
    const auto n_out = static_cast<std::size_t>(from.outputs);
    const auto width = static_cast<std::size_t>(to.width);
    const auto back_width = static_cast<std::size_t>(to.back_width);
    to.bias.resize(width);
    to.weight.resize(n_in * width);
    to.back.resize(n_out * back_width);
    for (std::size_t i = 0; i < n_in; ++i) {
      for (std::size_t j = 0; j < n_out; ++j) {
        to.weight[i * width + j] = to.back[j * back_width + i] = from.weight[i * n_out + j];
      }
    }
    side.hidden.push_back(to);
  }
  const DenseLayer& last = given.layers.back();
  side.last_bias = last.bias.front();
  side.last_row = last.weight;
  side.last_row.resize(static_cast<std::size_t>(side.hidden.back().width));
  side.last_column.resize(last.weight.size() * kDenseStep);
  for (std::size_t i = 0; i < last.weight.size(); ++i) {
    side.last_column[i * kDenseStep] = last.weight[i];
  }
  for (std::size_t i = 0; i < kPose; ++i) {
    std::copy_n(&given.curvature[i * kPose], kPose, &side.curvature[i * kDenseStep]);
  }
  const auto stride = static_cast<std::size_t>(side.stride);
  side.poses = kMostPoses;
  while (side.poses > 0 && memory_for(side.poses, side.hidden.size(), stride) > kMemory) {
    --side.poses;
  }
  if (side.poses == 0) {
    throw std::invalid_argument("potential surrogate: " + std::to_string(side.hidden.size()) +
                                " hidden layers of " + std::to_string(side.stride) +
                                " neurons are more than the fused runtime has memory for");
  }
  return side;
}

Potential::Potential(const std::array<PotentialSide, kSides>& sides, const DenseKernels& kernels)
    : sides_{prepare(sides[kMedial]), prepare(sides[kLateral])}, kernels_(kernels) {}

std::size_t Potential::max_poses(bool) const {
  return std::min(sides_[kMedial].poses, sides_[kLateral].poses);
}

std::size_t Potential::find_loaded(const Energy& side, std::span<const Pose> poses,
                                   Memory& memory) const {
  const int stride = side.stride, columns = static_cast<int>(poses.size());
  const std::ptrdiff_t layer_size = std::ptrdiff_t{stride} * columns;
  const double* in = memory.inputs.data();
  int in_stride = kDenseStep;
  double* out = memory.hidden;
  for (const Layer& layer : side.hidden) {
    kernels_.multiply(layer.weight.data(), layer.inputs, layer.width, in, in_stride, columns, out,
                      stride);
    kernels_.tanh(layer.bias.data(), layer.width, out, stride, columns);
    in = out;
    in_stride = stride;
    out += layer_size;
  }
  double* sums = memory.scratch.data();
  kernels_.multiply(side.last_column.data(), side.hidden.back().outputs, kDenseStep, in, stride,
                    columns, sums, kDenseStep);
  double* gradient = memory.gradient.data();
  kernels_.multiply(side.curvature.data(), kPose, kDenseStep, memory.inputs.data(), kDenseStep,
                    columns, gradient, kDenseStep);
  std::size_t loaded = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double twice = 0.0;
    double* g = gradient + kDenseStep * i;
    for (int k = 0; k < kPose; ++k) {
      const double b = side.constants.steepness[static_cast<std::size_t>(k)];
      g[k] += b;
      twice += poses[i][k] * (g[k] + b);
    }
    const double depth = sums[kDenseStep * i] + side.last_bias + 0.5 * twice;
    // What is not a number presses too, and comes out as such.
    if (depth <= 0.0) continue;
    memory.depth[loaded] = depth;
    memory.pose[loaded] = i;
    if (loaded != i) {
      std::copy_n(g, kPose, gradient + kDenseStep * loaded);
      for (std::size_t l = 0; l < side.hidden.size(); ++l) {
        double* layer = memory.hidden + static_cast<std::ptrdiff_t>(l) * layer_size;
        const auto step = static_cast<std::size_t>(stride);
        std::copy_n(layer + step * i, stride, layer + step * loaded);
      }
    }
    ++loaded;
  }
  return loaded;
}

void Potential::go_back(const Energy& side, std::size_t loaded, Memory& memory) const {
  const int stride = side.stride, columns = static_cast<int>(loaded);
  const std::ptrdiff_t layer_size = memory.delta - memory.hidden;
  const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(side.hidden.size());
  const std::ptrdiff_t size = layer_size / n;
  double* delta = memory.delta + (n - 1) * size;
  for (int c = 0; c < columns; ++c) {
    std::copy(side.last_row.begin(), side.last_row.end(), delta + std::ptrdiff_t{c} * stride);
  }
  for (std::ptrdiff_t l = n - 1;; --l) {
    const Layer& layer = side.hidden[static_cast<std::size_t>(l)];
    kernels_.times_slope(memory.hidden + l * size, layer.width, delta, stride, columns);
    if (l == 0) break;
    kernels_.multiply(layer.back.data(), layer.outputs, layer.back_width, delta, stride, columns,
                      delta - size, stride);
    delta -= size;
  }
  const Layer& first = side.hidden.front();
  double* of_network = memory.scratch.data();
  kernels_.multiply(first.back.data(), first.outputs, first.back_width, delta, stride, columns,
                    of_network, kDenseStep);
  for (std::size_t i = 0; i < kDenseStep * loaded; ++i) memory.gradient[i] += of_network[i];
}

void Potential::find_curvature(const Energy& side, std::size_t first, std::size_t count,
                               Memory& memory) const {
  const int stride = side.stride, columns = kDenseTangents * static_cast<int>(count);
  const std::size_t n = side.hidden.size();
  const std::ptrdiff_t size = (memory.delta - memory.hidden) / static_cast<std::ptrdiff_t>(n);
  const std::ptrdiff_t pose_size = std::ptrdiff_t{kDenseTangents} * stride;
  const auto offset = static_cast<std::ptrdiff_t>(first) * stride;
  for (std::size_t i = 0; i < count; ++i) {
    double* pairs = &memory.pairs[kDensePairs * i];
    for (int k = 0; k < kPose; ++k) {
      for (int m = k; m < kPose; ++m) {
        *pairs++ = side.constants.curvature[static_cast<std::size_t>(k * kPose + m)];
      }
    }
  }
  // The first layer's tangents are its weights, whatever the pose.
  const double* sums = side.hidden.front().weight.data();
  int sums_stride = side.hidden.front().width;
  std::ptrdiff_t sums_step = 0;
  double* next_sums = memory.sums_tangent;
  for (std::size_t l = 0; l < n; ++l) {
    const Layer& layer = side.hidden[l];
    const double* hidden = memory.hidden + static_cast<std::ptrdiff_t>(l) * size + offset;
    const double* delta = memory.delta + static_cast<std::ptrdiff_t>(l) * size + offset;
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = static_cast<std::ptrdiff_t>(i);
      kernels_.add_curvature(hidden + at * stride, delta + at * stride, layer.width,
                             sums + at * sums_step, sums_stride, &memory.pairs[kDensePairs * i]);
      if (l + 1 == n) continue;
      kernels_.slope_tangents(hidden + at * stride, layer.width, sums + at * sums_step, sums_stride,
                              memory.tangent + at * pose_size, stride);
    }
    if (l + 1 == n) break;
    const Layer& next = side.hidden[l + 1];
    kernels_.multiply(next.weight.data(), next.inputs, next.width, memory.tangent, stride, columns,
                      next_sums, stride);
    sums = next_sums;
    sums_stride = stride;
    sums_step = pose_size;
    next_sums += pose_size * static_cast<std::ptrdiff_t>(count);
  }
}

void Potential::evaluate(std::span<const Pose> poses, DenseWorkspace&, double* wrench,
                         double* stiffness) const {
  Memory memory;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::copy_n(poses[i].data(), kPose, &memory.inputs[kDenseStep * i]);
    memory.turns[i] = Turn(poses[i]);
  }
  std::fill_n(wrench, poses.size() * kSides * kLoads, 0.0);
  if (stiffness != nullptr) std::fill_n(stiffness, poses.size() * kSides * kMatrix, 0.0);
  for (const Side which : {kMedial, kLateral}) {
    const Energy& side = sides_[which];
    memory.lay_out(side, poses.size());
    const std::size_t loaded = find_loaded(side, poses, memory);
    if (loaded == 0) continue;
    go_back(side, loaded, memory);
    for (std::size_t i = 0; i < loaded; ++i) {
      if (stiffness != nullptr && i % kTangentPoses == 0) {
        find_curvature(side, i, std::min(kTangentPoses, loaded - i), memory);
      }
      const std::size_t at = kSides * memory.pose[i] + static_cast<std::size_t>(which);
      write_loads(side, i, memory, wrench + kLoads * at,
                  stiffness == nullptr ? nullptr : stiffness + kMatrix * at);
    }
  }
}

void Potential::write_loads(const Energy& side, std::size_t loaded, const Memory& memory,
                            double* wrench, double* stiffness) {
  const Turn& turn = memory.turns[memory.pose[loaded]];
  const double* gradient = &memory.gradient[kDenseStep * loaded];
  const double bend = power_of(memory.depth[loaded], side.constants.exponent);
  const double force = side.constants.force_factor * (bend * memory.depth[loaded]);
  std::array<double, kPose> generalised;
  for (std::size_t k = 0; k < kPose; ++k) generalised[k] = force * gradient[k];
  turn.apply(generalised.data(), 1, wrench);
  if (stiffness == nullptr) return;
  const double curve = side.constants.curve_factor * bend;
  const double* pair = &memory.pairs[kDensePairs * (loaded % kTangentPoses)];
  std::array<double, kMatrix> derivative;
  for (std::size_t k = 0; k < kPose; ++k) {
    for (std::size_t m = k; m < kPose; ++m) {
      const double value = force * *pair++ + curve * gradient[k] * gradient[m];
      derivative[k * kPose + m] = derivative[m * kPose + k] = value;
    }
  }
  for (int k = 0; k < kPose; ++k) turn.apply(derivative.data() + k, kPose, stiffness + k);
  turn.add_derivative(generalised.data(), wrench, stiffness);
}

}  // namespace condyle::surrogate
