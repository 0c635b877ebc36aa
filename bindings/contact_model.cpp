// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_model.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <optional>

#include "arrays.hpp"

namespace condyle::bindings {
namespace {

using contact::ContactLoads;
using contact::ContactModel;
using contact::Derivatives;

/// Many ContactLoads, taken apart into arrays.
struct LoadArrays {
  nb::ndarray<nb::numpy, double> wrench;     // (n, 2, 6)
  nb::object stiffness;                      // (n, 2, 6, 6) or None
  nb::ndarray<nb::numpy, double> error;      // (n, 2, 6)
  nb::ndarray<nb::numpy, double> trust;      // (n,)
  nb::ndarray<nb::numpy, bool> implausible;  // (n,)
};

template <typename Matrix>
void append(std::vector<double>& values, const std::array<Matrix, kSides>& sides) {
  for (const Matrix& side : sides) values.insert(values.end(), side.data(), side.data() + side.size());
}

LoadArrays evaluate_batch(const ContactModel& model, const PosesIn& poses, Derivatives derivatives,
                          int threads) {
  const std::size_t n = poses.shape(0);
  const bool with_stiffness = derivatives == Derivatives::kStiffness;
  std::vector<double> wrench, stiffness, error, trust;
  // bool has no contiguous vector; one byte each is what NumPy wants.
  auto* implausible = new std::vector<unsigned char>();
  {
    nb::gil_scoped_release release;
    std::vector<ContactLoads> loads(n);
    model.evaluate_batch(as_poses(poses), derivatives, threads, loads);
    for (const ContactLoads& load : loads) {
      append(wrench, load.wrench);
      if (with_stiffness) append(stiffness, load.stiffness);
      append(error, load.error);
      trust.push_back(load.trust);
      implausible->push_back(load.implausible_depth);
    }
  }
  nb::capsule owner(implausible, [](void* p) noexcept { delete static_cast<std::vector<unsigned char>*>(p); });
  return {to_numpy(std::move(wrench), {n, 2, 6}),
          with_stiffness ? nb::cast(to_numpy(std::move(stiffness), {n, 2, 6, 6})) : nb::none(),
          to_numpy(std::move(error), {n, 2, 6}), to_numpy(std::move(trust), {n}),
          nb::ndarray<nb::numpy, bool>(implausible->data(), {n}, owner)};
}

}  // namespace

void bind_contact_model(nb::module_& m) {
  using namespace nb::literals;
  nb::enum_<Derivatives>(m, "Derivatives")
      .value("none", Derivatives::kNone)
      .value("stiffness", Derivatives::kStiffness);
  // The arrays own their memory already: hand out the same one at each access, and keep nothing else alive.
  constexpr auto kShared = nb::rv_policy::reference;
  nb::class_<LoadArrays>(m, "LoadArrays", "Loads of a contact model at n poses; axis 1 is (medial, lateral).")
      .def_ro("wrench", &LoadArrays::wrench, kShared,
              "(n, 2, 6) on the femur, at Fo, expressed in T [N, Nm].")
      .def_ro("stiffness", &LoadArrays::stiffness, "(n, 2, 6, 6) d wrench_i / d pose_j, or None.")
      .def_ro("error", &LoadArrays::error, kShared,
              "(n, 2, 6) calibrated 95 % bound on each load.")
      .def_ro("trust", &LoadArrays::trust, kShared,
              "(n,) 1 well inside what the model knows, 0 outside.")
      .def_ro("implausible_depth", &LoadArrays::implausible, kShared,
              "(n,) bool.");
  nb::class_<ContactModel>(m, "ContactModel",
                           "Maps poses (n, 6) [m, rad] of the femur in the tibial frame to contact wrenches per side.")
      .def_prop_ro("side_of_body", &ContactModel::side_of_body)
      .def("evaluate", &evaluate_batch, "poses"_a, "derivatives"_a, "threads"_a,
           "Loads at poses (n, 6); threads 0 means all cores. The result does not depend on threads.");
}

}  // namespace condyle::bindings
