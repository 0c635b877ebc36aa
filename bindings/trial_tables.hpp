// SPDX-License-Identifier: Apache-2.0
// Arrays of a trial: what the bindings of its analysis and its simulation share.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "condyle/fdk/trial_analysis.hpp"

namespace condyle::bindings {

using TableIn = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
/// (T, loads, 9): force, point and moment in ground.
using LoadsIn = nb::ndarray<const double, nb::shape<-1, -1, 9>, nb::c_contig, nb::device::cpu>;

inline fdk::TimeFrames table(const TableIn& in) {
  return Eigen::Map<const fdk::TimeFrames>(in.data(), static_cast<Eigen::Index>(in.shape(0)),
                                           static_cast<Eigen::Index>(in.shape(1)));
}

inline std::vector<std::vector<model::ExternalLoad>> external_loads(
    const LoadsIn& loads, const std::vector<int>& bodies) {
  if (loads.shape(1) != bodies.size()) {
    throw std::invalid_argument("external loads: " + std::to_string(bodies.size()) +
                                " bodies for " + std::to_string(loads.shape(1)) +
                                " loads a time frame");
  }
  std::vector<std::vector<model::ExternalLoad>> frames;
  if (bodies.empty()) return frames;
  frames.resize(loads.shape(0));
  const double* v = loads.data();
  for (auto& frame : frames) {
    for (const int body : bodies) {
      frame.push_back({body, Vector3(v), Vector3(v + 3), Vector3(v + 6)});
      v += 9;
    }
  }
  return frames;
}

inline nb::ndarray<nb::numpy, double> to_array(const fdk::TimeFrames& table) {
  std::vector<double> values(table.data(), table.data() + table.size());
  return to_numpy(std::move(values),
                  {static_cast<std::size_t>(table.rows()), static_cast<std::size_t>(table.cols())});
}

}  // namespace condyle::bindings
