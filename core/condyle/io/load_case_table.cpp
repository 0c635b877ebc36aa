// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/load_case_table.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "condyle/io/table.hpp"

namespace condyle::io {
namespace {

std::vector<double> finite_column(const Table& table, const char* name) {
  const std::vector<double>& values = table.column(name);
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isfinite(values[row])) continue;
    throw std::invalid_argument(table.source + ", line " + std::to_string(table.lines[row]) +
                                ", column '" + name + "': " + std::to_string(values[row]) +
                                " is not finite");
  }
  return values;
}

}  // namespace

fdk::LoadCase read_load_case(const std::filesystem::path& file) {
  const Table table = read_table(file);
  fdk::LoadCase load_case;
  load_case.time = finite_column(table, "time_s");
  load_case.flexion = finite_column(table, "flexion_deg");
  load_case.axial_force = finite_column(table, "axial_force_N");
  load_case.ap_force = finite_column(table, "ap_force_N");
  load_case.ie_torque = finite_column(table, "ie_torque_Nm");
  for (double& flexion : load_case.flexion) flexion *= std::numbers::pi / 180.0;
  fdk::require_valid(load_case, file.string());
  return load_case;
}

}  // namespace condyle::io
