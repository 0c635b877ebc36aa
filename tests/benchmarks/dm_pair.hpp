// SPDX-License-Identifier: Apache-2.0
// The real implant that the benchmarks measure on.
#pragma once

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "condyle/contact/contact_pair.hpp"
#include "condyle/geometry/mesh_file.hpp"

namespace condyle::benchmark {

/// The contact surfaces of the right knee DM, and its settled pose.
struct DmPair {
  geometry::TriangleMesh femur;
  std::vector<geometry::TriangleMesh> compartments;  // medial, lateral
  Pose settled = (Pose() << 6.404e-3, 41.107e-3, -0.218e-3, 0, 0, 0).finished();
};

/// From CONDYLE_DATA, or shared/data beside the project. @throws std::runtime_error where there is
/// none.
inline DmPair read_dm_pair() {
  const char* named = std::getenv("CONDYLE_DATA");
  const std::filesystem::path data = named != nullptr ? named : CONDYLE_SHARED_DATA;
  const auto folder = data / "implants" / "dm";
  if (!std::filesystem::exists(folder)) {
    throw std::runtime_error(
        "no implants: set CONDYLE_DATA, or put shared/data beside the project");
  }
  const auto read = [&](const char* file) {
    return geometry::read_mesh(folder / file, geometry::LengthUnit::kMetre);
  };
  return {read("femur_contact.stl"),
          {read("insert_contact_medial.stl"), read("insert_contact_lateral.stl")}};
}

/// Seconds that body() takes: the quickest of `repeats`, each of `calls` calls, because what
/// disturbs only adds.
template <typename Body>
double quickest(int repeats, int calls, Body body) {
  double best = 1e300;
  for (int r = 0; r < repeats; ++r) {
    const auto start = std::chrono::steady_clock::now();
    for (int c = 0; c < calls; ++c) body();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (took.count() / calls < best) best = took.count() / calls;
  }
  return best;
}

}  // namespace condyle::benchmark
