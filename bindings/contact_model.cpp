// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_model.hpp"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>

#include "arrays.hpp"

namespace condyle::bindings {
namespace {

using contact::ContactModel;
using contact::Derivatives;
using contact::LoadSpans;

/// Loads at many poses as arrays.
struct LoadArrays {
  nb::ndarray<nb::numpy, double> wrench;     // (n, 2, 6)
  nb::object stiffness;                      // (n, 2, 6, 6) or None
  nb::ndarray<nb::numpy, double> error;      // (n, 2, 6)
  nb::ndarray<nb::numpy, double> trust;      // (n,)
  nb::ndarray<nb::numpy, bool> implausible;  // (n,)
};

/// A new array of that shape that owns its memory, and `span` over it.
template <typename Scalar>
nb::ndarray<nb::numpy, Scalar> new_array(std::initializer_list<std::size_t> shape,
                                         std::span<Scalar>& span) {
  std::size_t size = 1;
  for (const std::size_t n : shape) size *= n;
  auto memory = std::make_unique<Scalar[]>(size);
  span = {memory.get(), size};
  nb::capsule owner(memory.get(), [](void* p) noexcept { delete[] static_cast<Scalar*>(p); });
  return nb::ndarray<nb::numpy, Scalar>(memory.release(), shape, owner);
}

LoadArrays evaluate_batch(const ContactModel& model, const PosesIn& poses, Derivatives derivatives,
                          int threads) {
  const std::size_t n = poses.shape(0);
  LoadSpans spans;
  LoadArrays arrays{new_array({n, 2, 6}, spans.wrench), nb::none(),
                    new_array({n, 2, 6}, spans.error), new_array({n}, spans.trust),
                    new_array({n}, spans.implausible_depth)};
  if (derivatives == Derivatives::kStiffness) {
    arrays.stiffness = nb::cast(new_array({n, 2, 6, 6}, spans.stiffness));
  }
  nb::gil_scoped_release release;
  model.evaluate_into(as_poses(poses), threads, spans);
  return arrays;
}

/// The caller's array, of any type and shape: checked here, so that a mistake is named. Never
/// copied.
using AnyOut = nb::ndarray<nb::device::cpu>;
using AnyIn = nb::ndarray<nb::ro, nb::device::cpu>;

template <typename Array>
std::string text_of_shape(const Array& array) {
  std::string text = "(";
  for (std::size_t a = 0; a < array.ndim(); ++a) {
    text += (a == 0 ? "" : ", ") + std::to_string(array.shape(a));
  }
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// The values of a C-contiguous array of shape `shape`. @throws std::invalid_argument naming it
/// otherwise.
template <typename Scalar, typename Array>
std::span<Scalar> values_of(const Array& array, const char* name,
                            std::span<const std::size_t> shape) {
  if (array.dtype() != nb::dtype<std::remove_const_t<Scalar>>()) {
    throw std::invalid_argument(std::string(name) + " has another type: must be " +
                                (sizeof(Scalar) == 1 ? "bool" : "float64"));
  }
  bool fits = array.ndim() == shape.size();
  for (std::size_t a = 0; fits && a < shape.size(); ++a) fits = array.shape(a) == shape[a];
  if (!fits) {
    std::string wanted;
    for (const std::size_t n : shape) wanted += (wanted.empty() ? "" : ", ") + std::to_string(n);
    throw std::invalid_argument(std::string(name) + " has shape " + text_of_shape(array) +
                                ": must be (" + wanted + (shape.size() == 1 ? ",)" : ")"));
  }
  std::int64_t stride = 1;
  for (std::size_t a = shape.size(); a-- > 0;) {
    if (shape[a] > 1 && array.stride(a) != stride) {
      throw std::invalid_argument(std::string(name) + " is not C-contiguous: it would be copied");
    }
    stride *= static_cast<std::int64_t>(shape[a]);
  }
  return {static_cast<Scalar*>(array.data()), static_cast<std::size_t>(stride)};
}

/// Shape of the leading axes that poses (n, 6) or a pose (6,) give its loads: (n,) or ().
template <typename Scalar>
void read_output(const AnyOut& array, const char* name, std::span<const std::size_t> poses,
                 std::initializer_list<std::size_t> of_one, std::span<Scalar>& span) {
  if (!array.is_valid()) return;
  std::array<std::size_t, 4> shape;
  auto end = std::copy(poses.begin(), poses.end(), shape.begin());
  end = std::copy(of_one.begin(), of_one.end(), end);
  span = values_of<Scalar>(array, name, {shape.begin(), end});
}

void evaluate_into(const ContactModel& model, const AnyIn& poses, const AnyOut& wrench,
                   const AnyOut& stiffness, int threads, const AnyOut& error, const AnyOut& trust,
                   const AnyOut& implausible_depth) {
  if (poses.ndim() != 1 && poses.ndim() != 2) {
    throw std::invalid_argument("poses has shape " + text_of_shape(poses) +
                                ": must be (n, 6) or (6,)");
  }
  const std::array<std::size_t, 2> shape{poses.shape(0), 6};
  const bool one = poses.ndim() == 1;
  const std::span<const std::size_t> rows(shape.data(), one ? 0 : 1);
  const std::span<const double> values =
      values_of<const double>(poses, "poses", std::span(shape).subspan(one ? 1 : 0));
  LoadSpans spans;
  read_output(wrench, "wrench", rows, {2, 6}, spans.wrench);
  read_output(stiffness, "stiffness", rows, {2, 6, 6}, spans.stiffness);
  read_output(error, "error", rows, {2, 6}, spans.error);
  read_output(trust, "trust", rows, {}, spans.trust);
  read_output(implausible_depth, "implausible_depth", rows, {}, spans.implausible_depth);
  const auto* first = reinterpret_cast<const Pose*>(values.data());
  nb::gil_scoped_release release;
  model.evaluate_into({first, values.size() / 6}, threads, spans);
}

void bind_load_arrays(nb::module_& m) {
  // The arrays own their memory already: hand out the same one at each access, and keep nothing
  // else alive.
  constexpr auto kShared = nb::rv_policy::reference;
  nb::class_<LoadArrays>(m, "LoadArrays",
                         "Loads of a contact model at n poses; axis 1 is (medial, lateral).")
      .def_ro("wrench", &LoadArrays::wrench, kShared,
              "(n, 2, 6) on the femur, at Fo, expressed in T [N, Nm].")
      .def_ro("stiffness", &LoadArrays::stiffness, "(n, 2, 6, 6) d wrench_i / d pose_j, or None.")
      .def_ro("error", &LoadArrays::error, kShared, "(n, 2, 6) calibrated 95 % bound on each load.")
      .def_ro("trust", &LoadArrays::trust, kShared,
              "(n,) 1 well inside what the model knows, 0 outside.")
      .def_ro("implausible_depth", &LoadArrays::implausible, kShared, "(n,) bool.");
}

}  // namespace

void bind_contact_model(nb::module_& m) {
  using namespace nb::literals;
  nb::enum_<Derivatives>(m, "Derivatives")
      .value("none", Derivatives::kNone)
      .value("stiffness", Derivatives::kStiffness);
  bind_load_arrays(m);
  nb::class_<ContactModel>(
      m, "ContactModel",
      "Maps poses (n, 6) [m, rad] of the femur in the tibial frame to contact wrenches per side.")
      .def_prop_ro("side_of_body", &ContactModel::side_of_body)
      .def("evaluate", &evaluate_batch, "poses"_a, "derivatives"_a, "threads"_a,
           "Loads at poses (n, 6); threads 0 means all cores. The result does not depend on "
           "threads.")
      .def("evaluate_into", &evaluate_into, "poses"_a.noconvert(), "wrench"_a.noconvert(),
           "stiffness"_a.noconvert() = nb::none(), "threads"_a = 1,
           "error"_a.noconvert() = nb::none(), "trust"_a.noconvert() = nb::none(),
           "implausible_depth"_a.noconvert() = nb::none(),
           nb::sig(
               "def evaluate_into(self, poses: NDArray[numpy.float64], "
               "wrench: NDArray[numpy.float64], stiffness: NDArray[numpy.float64] | None = None, "
               "threads: int = 1, error: NDArray[numpy.float64] | None = None, "
               "trust: NDArray[numpy.float64] | None = None, "
               "implausible_depth: NDArray[numpy.bool_] | None = None) -> None"),
           "Loads at poses (n, 6), or at one pose (6,), written into the caller's arrays: those of "
           "LoadArrays, "
           "C-contiguous and of its shapes, without the axis of n for one pose. Nothing is copied; "
           "what does not "
           "fit is refused.");
}

}  // namespace condyle::bindings
