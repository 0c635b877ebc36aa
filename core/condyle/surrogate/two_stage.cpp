// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/two_stage.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace condyle::surrogate {
namespace {

constexpr int kPose = 6;
constexpr int kLoads = 6;
constexpr int kFirst = 2;                    // loads of a side that net I gives, and net II takes
constexpr int kSecond = 4;                   // the others
constexpr int kFirstLoads[kFirst] = {1, 3};  // Fy, Mx
constexpr int kSecondLoads[kSecond] = {0, 2, 4, 5};  // Fx, Fz, My, Mz

/// A pose and, where there is more than one column, the unit vectors that its derivatives begin
/// with.
void write_inputs(const Pose& pose, int per_pose, int stride, double* column) {
  std::copy_n(pose.data(), kPose, column);
  for (int k = 1; k < per_pose; ++k) {
    column += stride;
    std::fill_n(column, kPose, 0.0);
    column[k - 1] = 1.0;
  }
}

/// What net I said of one side, for each column.
using FirstLoads = std::array<double, kFirst * kMaxDenseColumns>;

/// Poses of a piece that press on a side, by number: at its gate the others lose whatever its net
/// would say. What is not a number presses too, and comes out as such.
struct Loaded {
  std::array<std::size_t, kMaxDenseColumns> pose;
  std::size_t count = 0;
};

Loaded find_loaded(const double* loads, int per_pose, std::size_t poses) {
  Loaded loaded;
  for (std::size_t i = 0; i < poses; ++i, loads += kFirst * per_pose) {
    if (!(loads[0] <= 0.0)) loaded.pose[loaded.count++] = i;
  }
  return loaded;
}

/// One side's loads and derivatives from the columns of a pose: first (Fy, Mx), second the rest.
void write_side(const double* first, const double* second, int stride, double* wrench,
                double* stiffness) {
  for (int i = 0; i < kFirst; ++i) wrench[kFirstLoads[i]] = first[i];
  for (int i = 0; i < kSecond; ++i) wrench[kSecondLoads[i]] = second[i];
  if (stiffness == nullptr) return;
  for (int k = 0; k < kPose; ++k) {
    const double* d_first = first + kFirst * (k + 1);
    const double* d_second = second + stride * (k + 1);
    for (int i = 0; i < kFirst; ++i) stiffness[kPose * kFirstLoads[i] + k] = d_first[i];
    for (int i = 0; i < kSecond; ++i) stiffness[kPose * kSecondLoads[i] + k] = d_second[i];
  }
}

}  // namespace

TwoStage::TwoStage(DenseNetwork first, std::array<DenseNetwork, kSides> second,
                   const DenseKernels& kernels)
    : first_(std::move(first)), second_(std::move(second)), kernels_(kernels) {
  const auto fits = [](const DenseNetwork& net, int inputs, int outputs) {
    return net.inputs() == inputs && net.outputs() == outputs;
  };
  if (!fits(first_, kPose, kSides * kFirst) || !fits(second_[kMedial], kPose + kFirst, kSecond) ||
      !fits(second_[kLateral], kPose + kFirst, kSecond)) {
    throw std::invalid_argument("two-stage surrogate: the networks must be 6 to 4, 8 to 4, 8 to 4");
  }
}

std::size_t TwoStage::max_poses(bool stiffness) const {
  return stiffness ? kMaxDenseColumns / kPoseColumns : kMaxDenseColumns;
}

void TwoStage::evaluate(std::span<const Pose> poses, DenseWorkspace& workspace, double* wrench,
                        double* stiffness) const {
  const bool derivatives = stiffness != nullptr;
  const int per_pose = derivatives ? kPoseColumns : 1;
  const int columns = static_cast<int>(poses.size()) * per_pose;

  double* column = workspace.a.data();
  for (const Pose& pose : poses) {
    write_inputs(pose, per_pose, first_.stride(), column);
    column += per_pose * first_.stride();
  }
  const double* out = first_.evaluate(kernels_, workspace, columns, derivatives);
  std::array<FirstLoads, kSides> first;  // written as far as it is read
  for (int c = 0; c < columns; ++c, out += first_.stride()) {
    for (int side = 0; side < kSides; ++side) {
      std::copy_n(out + kFirst * side, kFirst, &first[side][static_cast<std::size_t>(kFirst * c)]);
    }
  }
  std::fill_n(wrench, poses.size() * kSides * kLoads, 0.0);
  if (derivatives) std::fill_n(stiffness, poses.size() * kSides * kLoads * kPose, 0.0);
  for (const Side side : {kMedial, kLateral}) {
    evaluate_side(side, poses, first[side].data(), workspace, wrench, stiffness);
  }
}

void TwoStage::evaluate_side(Side side, std::span<const Pose> poses, const double* first,
                             DenseWorkspace& workspace, double* wrench, double* stiffness) const {
  const int per_pose = stiffness != nullptr ? kPoseColumns : 1;
  const DenseNetwork& net = second_[side];
  const Loaded loaded = find_loaded(first, per_pose, poses.size());
  if (loaded.count == 0) return;

  const auto first_of = [&](std::size_t pose) {
    return first + std::size_t{kFirst} * static_cast<std::size_t>(per_pose) * pose;
  };
  double* column = workspace.a.data();
  for (std::size_t i = 0; i < loaded.count; ++i) {
    write_inputs(poses[loaded.pose[i]], per_pose, net.stride(), column);
    const double* loads = first_of(loaded.pose[i]);
    for (int c = 0; c < per_pose; ++c, column += net.stride(), loads += kFirst) {
      std::copy_n(loads, kFirst, column + kPose);
    }
  }
  const int columns = static_cast<int>(loaded.count) * per_pose;
  const double* out = net.evaluate(kernels_, workspace, columns, stiffness != nullptr);
  for (std::size_t i = 0; i < loaded.count; ++i, out += per_pose * net.stride()) {
    const std::size_t at = kSides * loaded.pose[i] + static_cast<std::size_t>(side);
    write_side(first_of(loaded.pose[i]), out, net.stride(), wrench + kLoads * at,
               stiffness == nullptr ? nullptr : stiffness + std::size_t{kLoads * kPose} * at);
  }
}

}  // namespace condyle::surrogate
