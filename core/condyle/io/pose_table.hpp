// SPDX-License-Identifier: Apache-2.0
// Poses in CSV files: columns x, y, z [m], theta_x, theta_y, theta_z [rad] (conventions of
// common/pose.hpp), in any order; further columns of numbers are passed over.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/io/table.hpp"

namespace condyle::io {

/// Names of the six columns, in the order of a Pose.
std::span<const char* const> pose_columns();

/// Reads poses, one a row.
/// @throws std::invalid_argument naming the file, line, column and value of what is missing, not
/// finite, or no knee's:
///   beyond 1 m (millimetres, surely) or beyond 2π rad (degrees).
std::vector<Pose> read_poses(const std::filesystem::path& file);

/// Appends the six columns to a table.
void add_poses(Table& table, std::span<const Pose> poses);

}  // namespace condyle::io
