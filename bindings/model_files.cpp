// SPDX-License-Identifier: Apache-2.0
// Files of musculoskeletal models and their trials.
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "condyle/io/external_loads.hpp"
#include "condyle/io/model_file.hpp"
#include "condyle/io/motion_file.hpp"
#include "condyle/io/path_snapshot_file.hpp"

namespace condyle::bindings {
namespace {

using namespace nb::literals;
using model::ModelDescription;

/// (rows, columns) from columns stored whole.
nb::ndarray<nb::numpy, double> motion_data(const io::Motion& motion) {
  const std::size_t rows = motion.row_count(), columns = motion.columns.size();
  std::vector<double> values(rows * columns);
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t row = 0; row < rows; ++row) values[row * columns + c] = motion.columns[c][row];
  }
  return to_numpy(std::move(values), {rows, columns});
}

using DataIn = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

io::Motion make_motion(std::string name, std::vector<std::string> names, const VectorIn& times,
                       const DataIn& data, std::optional<bool> in_degrees) {
  io::Motion motion;
  motion.name = std::move(name);
  motion.names = std::move(names);
  motion.in_degrees = in_degrees;
  motion.times.assign(times.data(), times.data() + times.shape(0));
  motion.columns.resize(data.shape(1));
  for (std::size_t c = 0; c < data.shape(1); ++c) {
    for (std::size_t row = 0; row < data.shape(0); ++row) motion.columns[c].push_back(data(row, c));
  }
  return motion;
}

/// (times, columns): the spline's derivative at each time.
nb::ndarray<nb::numpy, double> spline_values(const numerics::NaturalSpline& spline,
                                             const VectorIn& times, int derivative) {
  const auto columns = static_cast<std::size_t>(spline.columns());
  std::vector<double> values(times.shape(0) * columns);
  for (std::size_t i = 0; i < times.shape(0); ++i) {
    spline.evaluate(times(i), derivative,
                    Eigen::Map<Eigen::VectorXd>(values.data() + i * columns, spline.columns()));
  }
  return to_numpy(std::move(values), {times.shape(0), columns});
}

void bind_motions(nb::module_& m) {
  nb::class_<io::Motion>(m, "Motion")
      .def_ro("name", &io::Motion::name)
      .def_ro("names", &io::Motion::names)
      .def_ro("in_degrees", &io::Motion::in_degrees)
      .def_ro("source", &io::Motion::source)
      .def_prop_ro("times",
                   [](const io::Motion& motion) {
                     return to_numpy(std::vector<double>(motion.times), {motion.row_count()});
                   },
                   nb::rv_policy::move)
      .def_prop_ro("data", &motion_data, nb::rv_policy::move,
                   "(rows, columns), in the file's units until convert_to_radians.")
      .def("convert_to_radians", &io::convert_to_radians, "rotational"_a)
      .def("spline", &io::motion_spline);
  m.def("make_motion", &make_motion, "name"_a, "names"_a, "times"_a, "data"_a, "in_degrees"_a.none());
  m.def(
      "read_motion",
      [](const std::filesystem::path& file, bool allow_nan) {
        return io::read_motion(file, {.allow_nan = allow_nan});
      },
      "file"_a, "allow_nan"_a, "An OpenSim storage table (STO, MOT).");
  m.def("write_motion", &io::write_motion, "motion"_a, "file"_a);
  nb::class_<numerics::NaturalSpline>(m, "NaturalSpline")
      .def_prop_ro("first", &numerics::NaturalSpline::first)
      .def_prop_ro("last", &numerics::NaturalSpline::last)
      .def("__call__", &spline_values, "times"_a, "derivative"_a);
}

void bind_external_loads(nb::module_& m) {
  nb::class_<io::BodyLoad>(m, "BodyLoad")
      .def_ro("body", &io::BodyLoad::body)
      .def_ro("force_frame", &io::BodyLoad::force_frame)
      .def_ro("point_frame", &io::BodyLoad::point_frame)
      .def_prop_ro("force", [](const io::BodyLoad& load) { return to_numpy(load.force); }, nb::rv_policy::move)
      .def_prop_ro("point", [](const io::BodyLoad& load) { return to_numpy(load.point); }, nb::rv_policy::move)
      .def_prop_ro("moment", [](const io::BodyLoad& load) { return to_numpy(load.moment); }, nb::rv_policy::move);
  nb::class_<io::ExternalLoadsSettings>(m, "ExternalLoadsSettings")
      .def(nb::init<>())
      .def_rw("negligible_force", &io::ExternalLoadsSettings::negligible_force);
  nb::class_<io::ExternalLoads>(m, "ExternalLoads")
      .def_prop_ro("first_time", &io::ExternalLoads::first_time)
      .def_prop_ro("last_time", &io::ExternalLoads::last_time)
      .def("require_bodies", &io::ExternalLoads::require_bodies, "model"_a)
      .def("at", &io::ExternalLoads::at, "time"_a, "One load a force, at a time [s].");
  m.def("read_external_loads", &io::ExternalLoads::read, "file"_a, "settings"_a,
        nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace

void bind_model_files(nb::module_& m) {
  nb::class_<ModelDescription>(m, "ModelDescription", "What a model is, as plain data.")
      .def_ro("name", &ModelDescription::name)
      .def_ro("source", &ModelDescription::source)
      .def_ro("provenance", &ModelDescription::provenance)
      .def_ro("not_supported", &ModelDescription::not_supported);
  m.def("read_model_file", &io::read_model_file, "file"_a, nb::call_guard<nb::gil_scoped_release>());
  m.def("parse_model", &io::parse_model, "json"_a, "source"_a);
  m.def("model_text", &io::model_text, "model"_a, "The text of a model file.");
  m.def("write_model_file", &io::write_model_file, "model"_a, "file"_a);

  nb::class_<model::PathSnapshots>(m, "PathSnapshots")
      .def_ro("source", &model::PathSnapshots::source)
      .def_ro("times", &model::PathSnapshots::times)
      .def_prop_ro("paths", [](const model::PathSnapshots& snapshots) {
        std::vector<std::string> names;
        for (const auto& [name, entries] : snapshots.paths) names.push_back(name);
        return names;
      });
  m.def("read_path_snapshots", &io::read_path_snapshots, "file"_a, "model"_a,
        nb::call_guard<nb::gil_scoped_release>());
  m.def("parse_path_snapshots", &io::parse_path_snapshots, "json"_a, "source"_a, "model"_a);
  m.def("path_snapshots_text", &io::path_snapshots_text, "snapshots"_a, "model"_a, "provenance"_a);
  bind_motions(m);
  bind_external_loads(m);
}

}  // namespace condyle::bindings
