// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/seating.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <string>

#include "arrays.hpp"

namespace condyle::bindings {
namespace {

using contact::ContactModel;
constexpr auto kNew = nb::rv_policy::move;

template <typename Found>
void bind_result(nb::module_& m, const char* class_name, const char* doc) {
  nb::class_<Found>(m, class_name, doc)
      .def_prop_ro("pose", [](const Found& f) { return to_numpy(f.pose); }, kNew, "(6,)")
      .def_prop_ro("converged", &Found::converged)
      .def_prop_ro("status", [](const Found& f) { return std::string(fdk::name(f.status)); })
      .def_prop_ro("advice", [](const Found& f) { return std::string(fdk::advice(f.status)); })
      .def_ro("evaluations", &Found::evaluations);
}

}  // namespace

void bind_seating(nb::module_& m) {
  using namespace nb::literals;
  using S = fdk::SeatingSettings;
  nb::class_<S>(m, "SeatingSettings", "How first touch and the seated pose are found.")
      .def(nb::init<>())
      .def_rw("settle", &S::settle)
      .def_rw("farthest", &S::farthest, "[m]")
      .def_rw("tolerance", &S::tolerance, "[m]")
      .def_rw("disc_radius", &S::disc_radius, "[m]")
      .def_rw("last_radius", &S::last_radius, "[m]")
      .def_rw("least_slope", &S::least_slope)
      .def_rw("longest_way", &S::longest_way, "[m]");
  bind_result<fdk::FirstTouch>(m, "FirstTouch", "Where contact begins along y.");
  bind_result<fdk::SeatedPose>(m, "SeatedPose", "The femur as low as possible without contact.");
  m.def("first_touch", [](const ContactModel& model, const PoseIn& pose, const S& settings) {
          const Pose p = as_pose(pose);
          nb::gil_scoped_release release;
          return fdk::first_touch(model, p, settings); },
        "model"_a, "pose"_a, "settings"_a);
  m.def("seated_pose", [](const ContactModel& model, double flexion, const S& settings) {
          nb::gil_scoped_release release;
          return fdk::seated_pose(model, flexion, settings); },
        "model"_a, "flexion"_a, "settings"_a);
}

}  // namespace condyle::bindings
