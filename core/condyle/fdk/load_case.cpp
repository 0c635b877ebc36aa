// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/load_case.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace condyle::fdk {
namespace {

[[noreturn]] void refuse(std::string_view name, const std::string& what) {
  throw std::invalid_argument("load case '" + std::string(name) + "': " + what);
}

void check(const std::vector<double>& values, const char* field, double low, double high,
           const char* unit, std::size_t rows, std::string_view name) {
  if (values.size() != rows) {
    refuse(name, std::string(field) + " has " + std::to_string(values.size()) +
                     " values, time has " + std::to_string(rows));
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(values[i] >= low && values[i] <= high)) {  // NaN fails, too
      refuse(name, std::string(field) + " in row " + std::to_string(i) + " is " +
                       std::to_string(values[i]) + ": must lie within " + std::to_string(low) +
                       " and " + std::to_string(high) + " " + unit);
    }
  }
}

}  // namespace

void require_valid(const LoadCase& load_case, std::string_view name) {
  const std::size_t rows = load_case.size();
  if (rows == 0) refuse(name, "has no rows");
  check(load_case.time, "time", -1e6, 1e6, "s", rows, name);
  for (std::size_t i = 1; i < rows; ++i) {
    if (!(load_case.time[i] > load_case.time[i - 1])) {
      refuse(name, "time in row " + std::to_string(i) + " is " + std::to_string(load_case.time[i]) +
                       ": must be above the row before, " + std::to_string(load_case.time[i - 1]));
    }
  }
  check(load_case.flexion, "flexion", -0.6, 3.0, "rad", rows, name);
  check(load_case.axial_force, "axial_force", 0.0, 2e4, "N", rows, name);
  check(load_case.ap_force, "ap_force", -5e3, 5e3, "N", rows, name);
  check(load_case.ie_torque, "ie_torque", -200.0, 200.0, "Nm", rows, name);
}

}  // namespace condyle::fdk
