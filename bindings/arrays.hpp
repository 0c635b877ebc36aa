// SPDX-License-Identifier: Apache-2.0
// NumPy arrays in and out, in one place: typed views of what Python passes, and results moved into arrays.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/contact/elastic_layer.hpp"

namespace condyle::bindings {

namespace nb = nanobind;

/// (n,) and (n, 6) float64 input, C-contiguous, on the CPU; another dtype or shape is refused before our code runs.
using VectorIn = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using PosesIn = nb::ndarray<const double, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
using PoseIn = nb::ndarray<const double, nb::shape<6>, nb::c_contig, nb::device::cpu>;

/// (m, 2) float64 input: modulus [Pa] and thickness [m] of the elastic layer under each face.
using LayersIn = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

// A Pose is six doubles and nothing else, so an (n, 6) array is an array of poses.
static_assert(sizeof(Pose) == 6 * sizeof(double));

inline std::span<const Pose> as_poses(const PosesIn& array) {
  return {reinterpret_cast<const Pose*>(array.data()), array.shape(0)};
}
inline Pose as_pose(const PoseIn& array) { return Pose(array.data()); }
inline std::span<const double> as_span(const VectorIn& array) {
  return {array.data(), array.shape(0)};
}

static_assert(sizeof(contact::Layer) == 2 * sizeof(double));
inline std::vector<contact::Layer> as_layers(const LayersIn& array) {
  const auto* first = reinterpret_cast<const contact::Layer*>(array.data());
  return {first, first + array.shape(0)};
}

/// Moves a vector into a NumPy array of that shape that owns it.
template <typename Scalar>
nb::ndarray<nb::numpy, Scalar> to_numpy(std::vector<Scalar>&& values,
                                        std::initializer_list<std::size_t> shape) {
  auto* owned = new std::vector<Scalar>(std::move(values));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<Scalar>*>(p); });
  return nb::ndarray<nb::numpy, Scalar>(owned->data(), shape, owner);
}

/// Copies one small fixed-size Eigen object into a NumPy array, row-major.
template <typename Derived>
nb::ndarray<nb::numpy, double> to_numpy(const Eigen::MatrixBase<Derived>& matrix) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
  }
  const auto rows = static_cast<std::size_t>(matrix.rows());
  const auto columns = static_cast<std::size_t>(matrix.cols());
  if (columns == 1) return to_numpy(std::move(values), {rows});
  return to_numpy(std::move(values), {rows, columns});
}

}  // namespace condyle::bindings
