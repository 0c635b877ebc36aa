// SPDX-License-Identifier: Apache-2.0
// Files of a trial of a musculoskeletal model, matched to the model.
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "condyle/io/surface_file.hpp"
#include "condyle/io/trial_file.hpp"
#include "condyle/io/trial_snapshots.hpp"

namespace condyle::bindings {
namespace {

using namespace nb::literals;

nb::ndarray<nb::numpy, double> rows(const io::Trial::Rows& table) {
  return to_numpy(std::vector<double>(table.data(), table.data() + table.size()),
                  {static_cast<std::size_t>(table.rows()), static_cast<std::size_t>(table.cols())});
}

/// Bodies of the loads, the same in every time frame.
std::vector<int> load_bodies(const io::Trial& trial) {
  std::vector<int> bodies;
  if (trial.loads.empty()) return bodies;
  for (const model::ExternalLoad& load : trial.loads.front()) bodies.push_back(load.body);
  return bodies;
}

nb::ndarray<nb::numpy, double> loads(const io::Trial& trial) {
  std::vector<double> values;
  for (const auto& frame : trial.loads) {
    for (const model::ExternalLoad& load : frame) {
      for (const Vector3* v : {&load.force_G, &load.point_G, &load.moment_G}) {
        values.insert(values.end(), v->data(), v->data() + 3);
      }
    }
  }
  return to_numpy(std::move(values), {trial.times.size(), load_bodies(trial).size(), 9});
}

nb::ndarray<nb::numpy, double> matrix(const RigidTransform& X) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
  out.topLeftCorner<3, 3>() = X.R;
  out.topRightCorner<3, 1>() = X.p;
  return to_numpy(out);
}

void bind_trials(nb::module_& m) {
  using R = io::TrialReading;
  nb::class_<R>(m, "TrialReading", "Which time frames are taken, and what is refused.")
      .def(nb::init<>())
      .def_rw("start", &R::start)
      .def_rw("end", &R::end)
      .def_rw("negligible_force", &R::negligible_force)
      .def_rw("range_factor", &R::range_factor);
  using T = io::Trial;
  nb::class_<T>(m, "Trial", "Motion and loads, one row a time frame.")
      .def_prop_ro(
          "times",
          [](const T& self) {
            return to_numpy(std::vector<double>(self.times), {self.times.size()});
          },
          nb::rv_policy::move)
      .def_prop_ro(
          "q", [](const T& self) { return rows(self.q); }, nb::rv_policy::move)
      .def_prop_ro(
          "qd", [](const T& self) { return rows(self.qd); }, nb::rv_policy::move)
      .def_prop_ro(
          "qdd", [](const T& self) { return rows(self.qdd); }, nb::rv_policy::move)
      .def_prop_ro("load_bodies", &load_bodies, "Indices of the bodies with external loads.")
      .def_prop_ro("loads", &loads, nb::rv_policy::move,
                   "(T, bodies, 9): force, point and moment in ground.")
      .def_ro("at_default", &T::at_default);
  m.def("read_trial", &io::read_trial, "model"_a, "motion"_a, "external_loads"_a, "reading"_a,
        nb::call_guard<nb::gil_scoped_release>(), "external_loads: an empty path for none.");
}

}  // namespace

void bind_trial_files(nb::module_& m) {
  bind_trials(m);
  using S = io::TrialSnapshots;
  nb::class_<S>(m, "TrialSnapshots", "Path snapshots of a trial.")
      .def_ro("snapshots", &S::snapshots)
      .def_ro("rows", &S::rows, "Which of the snapshots' times each time frame takes.");
  m.def(
      "read_trial_snapshots",
      [](const std::filesystem::path& file, const model::Model& model, const VectorIn& times,
         const VectorIn& q) {
        const Eigen::Map<const Eigen::VectorXd> first(q.data(),
                                                      static_cast<Eigen::Index>(q.shape(0)));
        return io::read_trial_snapshots(file, model, as_span(times), first);
      },
      "file"_a, "model"_a, "times"_a, "q"_a, "q: of the first time frame.");
  using F = io::SurfaceFile;
  nb::class_<F>(m, "SurfaceFile", "The mesh of a contact surface, and where it is on its body.")
      .def_ro("name", &F::name)
      .def_ro("mesh", &F::mesh)
      .def_ro("body", &F::body)
      .def_prop_ro(
          "X_BS", [](const F& self) { return matrix(self.X_BS); }, nb::rv_policy::move,
          "(4, 4) the mesh's coordinates in the body's.");
  m.def("read_surface_file", &io::read_surface_file, "file"_a, "model"_a);
}

}  // namespace condyle::bindings
