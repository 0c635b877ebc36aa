// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_accuracy.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"

namespace condyle::bindings {

void bind_fast_accuracy(nb::module_& m) {
  using namespace nb::literals;
  using namespace contact;
  nb::class_<Deviations>(m, "Deviations",
                         "Errors of forces or of moments; relative ones from 20 N up.")
      .def_ro("median", &Deviations::median)
      .def_ro("p99", &Deviations::p99)
      .def_ro("worst", &Deviations::worst)
      .def_ro("tolerance_p99", &Deviations::tolerance_p99, "of error/tolerance")
      .def_ro("tolerance_worst", &Deviations::tolerance_worst, "of error/tolerance");
  nb::class_<WrenchDeviations>(m, "WrenchDeviations", "Errors of all sides, or of all totals.")
      .def_ro("count", &WrenchDeviations::count)
      .def_ro("force", &WrenchDeviations::force)
      .def_ro("moment", &WrenchDeviations::moment)
      .def_prop_ro(
          "worst_pose", [](const WrenchDeviations& d) { return to_numpy(d.worst_pose); },
          nb::rv_policy::move, "(6,) [m, rad]");
  nb::class_<LoadRange>(m, "LoadRange", "Poses whose total force lies between two values.")
      .def_ro("from_force", &LoadRange::from, "[N]")
      .def_ro("to_force", &LoadRange::to, "[N]")
      .def_ro("sides", &LoadRange::sides)
      .def_ro("total", &LoadRange::total);
  nb::class_<AccuracyReport>(m, "AccuracyReport", "How far one contact model is from another.")
      .def_ro("sides", &AccuracyReport::sides)
      .def_ro("total", &AccuracyReport::total)
      .def_ro("by_load", &AccuracyReport::by_load);
  nb::class_<PlausiblePoses>(m, "PlausiblePoses", "A box of poses about a settled one.")
      .def(nb::init<>())
      .def_prop_rw(
          "settled", [](const PlausiblePoses& p) { return to_numpy(p.settled); },
          [](PlausiblePoses& p, const PoseIn& pose) { p.settled = as_pose(pose); },
          nb::for_getter(nb::rv_policy::move))
      .def_rw("count", &PlausiblePoses::count)
      .def_rw("seed", &PlausiblePoses::seed);
  m.def(
      "plausible_poses",
      [](const ContactModel& model, const PlausiblePoses& settings, int threads) {
        std::vector<double> values;
        std::size_t count = 0;
        {
          nb::gil_scoped_release release;
          for (const Pose& pose : plausible_poses(model, settings, threads)) {
            values.insert(values.end(), pose.begin(), pose.end());
            ++count;
          }
        }
        return to_numpy(std::move(values), {count, 6});
      },
      "model"_a, "settings"_a, "threads"_a,
      "(n, 6) drawn in the box and pressed down until they carry the load drawn.");
  m.def(
      "measure_accuracy",
      [](const ContactModel& fast, const ContactModel& exact, const PosesIn& poses, int threads) {
        const auto span = as_poses(poses);
        nb::gil_scoped_release release;
        return measure_accuracy(fast, exact, {span.begin(), span.end()}, threads);
      },
      "fast"_a, "exact"_a, "poses"_a, "threads"_a, "Compares two contact models at poses (n, 6).");
}

}  // namespace condyle::bindings
