// SPDX-License-Identifier: Apache-2.0
// A load case: what a knee simulator applies over time. A plain struct of arrays; reading files is io's business.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace condyle::fdk {

/// All arrays have one entry per time frame.
struct LoadCase {
  std::vector<double> time;         ///< [s], strictly increasing
  std::vector<double> flexion;      ///< [rad], positive in flexion; drives θz = −flexion
  std::vector<double> axial_force;  ///< [N] ≥ 0, pressing the femur onto the tibia along −y_T
  std::vector<double> ap_force;     ///< [N] on the TIBIA, positive anterior (+x_T)
  std::vector<double> ie_torque;    ///< [Nm] on the TIBIA about y_T, positive turning it inward (internal rotation)

  std::size_t size() const { return time.size(); }
};

/// Throws std::invalid_argument naming the load case, the field, the row, the value and the limit, unless: there is a row; all
/// arrays are as long as `time`; every value is finite; time increases; flexion lies in [−0.6, 3] rad (degrees given as
/// radians fail here); axial force in [0, 20 000] N; AP force within ±5000 N; torque within ±200 Nm.
void require_valid(const LoadCase& load_case, std::string_view name);

}  // namespace condyle::fdk
