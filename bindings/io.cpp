// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>

#include <cstring>

#include "arrays.hpp"
#include "condyle/io/pose_table.hpp"

namespace condyle::bindings {
namespace {

nb::ndarray<nb::numpy, double> read_poses(const std::filesystem::path& file) {
  const std::vector<Pose> poses = io::read_poses(file);
  std::vector<double> values(6 * poses.size());
  std::memcpy(values.data(), poses.data(), values.size() * sizeof(double));
  return to_numpy(std::move(values), {poses.size(), 6});
}

}  // namespace

void bind_io(nb::module_& m) {
  using namespace nb::literals;
  m.def("read_poses", &read_poses, "file"_a,
        "Poses (n, 6) of a CSV file with columns x, y, z [m], theta_x, theta_y, theta_z [rad].");
}

}  // namespace condyle::bindings
