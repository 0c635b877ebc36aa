// SPDX-License-Identifier: Apache-2.0
#include "load_columns.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace condyle::apps {

void add_wrench(io::Table& table, Side side, std::span<const contact::ContactLoads> loads) {
  static constexpr std::array kLoads{"Fx", "Fy", "Fz", "Mx", "My", "Mz"};
  for (std::size_t i = 0; i < kLoads.size(); ++i) {
    std::vector<double> values;
    values.reserve(loads.size());
    for (const auto& load : loads) values.push_back(load.wrench[side][static_cast<int>(i)]);
    table.add_column(std::string(name(side)) + "_" + kLoads[i], std::move(values));
  }
}

void add_trust(io::Table& table, std::span<const contact::ContactLoads> loads) {
  std::vector<double> trust;
  trust.reserve(loads.size());
  for (const auto& load : loads) trust.push_back(load.trust);
  table.add_column("trust", std::move(trust));
}

}  // namespace condyle::apps
