// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "condyle/common/parallel.hpp"

namespace condyle::contact {

void require_finite(const Pose& pose) {
  static constexpr const char* kNames[] = {"x", "y", "z", "theta_x", "theta_y", "theta_z"};
  for (int i = 0; i < 6; ++i) {
    if (!std::isfinite(pose[i])) {
      throw std::invalid_argument("pose: " + std::string(kNames[i]) + " is " +
                                  std::to_string(pose[i]) + ": must be finite");
    }
  }
}

void require_finite(std::span<const Pose> poses) {
  for (std::size_t row = 0; row < poses.size(); ++row) {
    if (poses[row].allFinite()) continue;
    try {
      require_finite(poses[row]);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("row " + std::to_string(row) + ": " + error.what());
    }
  }
}

namespace {

constexpr std::size_t kLoads = 6;

template <typename Matrix>
void write_sides(std::span<double> values, std::size_t row,
                 const std::array<Matrix, kSides>& sides) {
  if (values.empty()) return;
  constexpr auto kSize = static_cast<std::size_t>(Matrix::SizeAtCompileTime);
  double* to = values.data() + row * kSides * kSize;
  for (const Matrix& side : sides) to = std::copy_n(side.data(), kSize, to);
}

void require_size(std::size_t size, const char* name, std::size_t rows, std::size_t width) {
  if (size == 0 || size == rows * width) return;
  throw std::invalid_argument("evaluate_into: " + std::string(name) + " has " +
                              std::to_string(size) + " values: " + std::to_string(rows) +
                              " poses need " + std::to_string(rows * width));
}

}  // namespace

void LoadSpans::write(std::size_t row, const ContactLoads& loads) const {
  write_sides(wrench, row, loads.wrench);
  write_sides(stiffness, row, loads.stiffness);
  write_sides(error, row, loads.error);
  if (!trust.empty()) trust[row] = loads.trust;
  if (!implausible_depth.empty()) implausible_depth[row] = loads.implausible_depth;
}

void LoadSpans::require_rows(std::size_t rows) const {
  require_size(wrench.size(), "wrench", rows, kSides * kLoads);
  require_size(stiffness.size(), "stiffness", rows, kSides * kLoads * kLoads);
  require_size(error.size(), "error", rows, kSides * kLoads);
  require_size(trust.size(), "trust", rows, 1);
  require_size(implausible_depth.size(), "implausible_depth", rows, 1);
}

void ContactModel::evaluate_batch(std::span<const Pose> poses, Derivatives derivatives, int threads,
                                  std::span<ContactLoads> loads) const {
  if (loads.size() != poses.size()) {
    throw std::invalid_argument("evaluate_batch: " + std::to_string(loads.size()) +
                                " results for " + std::to_string(poses.size()) + " poses");
  }
  require_finite(poses);
  const auto body = [&](std::size_t i) { loads[i] = evaluate(poses[i], derivatives); };
  // By reference: a std::function would else copy the captures to the heap.
  parallel_for(poses.size(), threads, std::cref(body));
}

void ContactModel::evaluate_into(std::span<const Pose> poses, int threads,
                                 const LoadSpans& loads) const {
  loads.require_rows(poses.size());
  require_finite(poses);
  const Derivatives derivatives = loads.derivatives();
  const auto body = [&](std::size_t i) { loads.write(i, evaluate(poses[i], derivatives)); };
  parallel_for(poses.size(), threads, std::cref(body));
}

}  // namespace condyle::contact
