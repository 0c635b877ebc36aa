// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include "condyle/surrogate/onnx_contact_model.hpp"
#include "condyle/surrogate/onnx_session.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"

namespace condyle::bindings {

namespace nb = nanobind;

void bind_surrogate(nb::module_& m) {
  using namespace nb::literals;
  using surrogate::OnnxContactModel;
  m.def(
      "set_library_path", &surrogate::set_library_path, "file"_a,
      "The onnxruntime library to open, after CONDYLE_ONNXRUNTIME and a copy beside this module.");
  m.def("onnxruntime_library", &surrogate::onnxruntime_library,
        "The onnxruntime library in use, or the one that would be opened.");
  m.def("onnxruntime_version", &surrogate::onnxruntime_version,
        "Version of the onnxruntime library; opens it.");
  nb::class_<OnnxContactModel, contact::ContactModel>(
      m, "OnnxContactModel",
      "A surrogate in an ONNX file (contract version 1), evaluated by onnxruntime.")
      .def(nb::init<const std::filesystem::path&>(), "file"_a,
           nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("has_stiffness", &OnnxContactModel::has_stiffness,
                   "False for a wrench-only file: no stiffness, and error and trust are NaN.")
      .def_prop_ro("metadata", &OnnxContactModel::metadata, "The file's metadata, texts by key.")
      .def_prop_ro("file", &OnnxContactModel::file, "The file that was read.");
}

}  // namespace condyle::bindings
