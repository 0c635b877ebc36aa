// SPDX-License-Identifier: Apache-2.0
// Load cases of a knee simulator in CSV files: columns time_s, flexion_deg, axial_force_N,
// ap_force_N, ie_torque_Nm, in any order; further columns of numbers are passed over. What each
// means, and its sign: fdk/load_case.hpp.
#pragma once

#include <filesystem>

#include "condyle/fdk/load_case.hpp"

namespace condyle::io {

/// Reads a load case; flexion becomes radians.
/// @throws std::invalid_argument naming the file, and the line and column of a value that is not
/// finite, a column that is missing,
///   or the field that fdk::require_valid refuses.
fdk::LoadCase read_load_case(const std::filesystem::path& file);

}  // namespace condyle::io
