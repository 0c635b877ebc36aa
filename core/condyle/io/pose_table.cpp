// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/pose_table.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace condyle::io {
namespace {

constexpr std::array<const char*, 6> kColumns{"x", "y", "z", "theta_x", "theta_y", "theta_z"};

// A knee is some centimetres across and bends less than half a turn; numbers far beyond are in
// other units.
constexpr double kLargestLength = 1.0;                    // [m]
constexpr double kLargestAngle = 2.0 * std::numbers::pi;  // [rad]

std::string shortest(double value) {
  char digits[32];
  return {digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr};
}

[[noreturn]] void refuse(const Table& table, std::size_t row, int coordinate, double value,
                         const char* why) {
  throw std::invalid_argument(table.source + ", line " + std::to_string(table.lines[row]) +
                              ", column '" + kColumns[static_cast<std::size_t>(coordinate)] +
                              "': " + shortest(value) + ' ' + why);
}

void require_plausible(const Table& table, std::size_t row, int coordinate, double value) {
  if (!std::isfinite(value)) refuse(table, row, coordinate, value, "is not finite");
  if (coordinate < kThetaX && std::abs(value) > kLargestLength) {
    refuse(table, row, coordinate, value, "m is no knee's position: poses are in m, at most 1 m");
  }
  if (coordinate >= kThetaX && std::abs(value) > kLargestAngle) {
    refuse(table, row, coordinate, value, "rad is no knee's angle: poses are in rad, at most 2π");
  }
}

}  // namespace

std::span<const char* const> pose_columns() { return kColumns; }

std::vector<Pose> read_poses(const std::filesystem::path& file) {
  const Table table = read_table(file);
  std::array<const std::vector<double>*, 6> columns{};
  for (std::size_t i = 0; i < 6; ++i) columns[i] = &table.column(kColumns[i]);
  std::vector<Pose> poses(table.row_count());
  for (std::size_t row = 0; row < poses.size(); ++row) {
    for (int i = 0; i < 6; ++i) {
      const double value = (*columns[static_cast<std::size_t>(i)])[row];
      require_plausible(table, row, i, value);
      poses[row][i] = value;
    }
  }
  return poses;
}

void add_poses(Table& table, std::span<const Pose> poses) {
  for (int i = 0; i < 6; ++i) {
    std::vector<double> values;
    values.reserve(poses.size());
    for (const Pose& pose : poses) values.push_back(pose[i]);
    table.add_column(kColumns[static_cast<std::size_t>(i)], std::move(values));
  }
}

}  // namespace condyle::io
