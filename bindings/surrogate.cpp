// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <utility>
#include <vector>

#include "arrays.hpp"
#include "condyle/surrogate/hybrid_contact_model.hpp"
#include "condyle/surrogate/onnx_contact_model.hpp"
#include "condyle/surrogate/onnx_session.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"

namespace condyle::bindings {

namespace nb = nanobind;

namespace {

auto logged_calls(const surrogate::HybridContactModel& model) {
  const auto calls = model.log();
  std::vector<double> poses, trust;
  for (const auto& call : calls) {
    poses.insert(poses.end(), call.pose.begin(), call.pose.end());
    trust.push_back(call.trust);
  }
  return std::pair(to_numpy(std::move(poses), {calls.size(), 6}),
                   to_numpy(std::move(trust), {calls.size()}));
}

}  // namespace

void bind_surrogate(nb::module_& m) {
  using namespace nb::literals;
  using surrogate::HybridContactModel;
  using surrogate::OnnxContactModel;
  using surrogate::Runtime;
  m.def(
      "set_library_path", &surrogate::set_library_path, "file"_a,
      "The onnxruntime library to open, after CONDYLE_ONNXRUNTIME and a copy beside this module.");
  m.def("onnxruntime_library", &surrogate::onnxruntime_library,
        "The onnxruntime library in use, or the one that would be opened.");
  m.def("onnxruntime_version", &surrogate::onnxruntime_version,
        "Version of the onnxruntime library; opens it.");
  nb::enum_<Runtime>(m, "Runtime", "What evaluates a surrogate file.")
      .value("auto", Runtime::kAuto, "fused where the file's graph is known to it")
      .value("fused", Runtime::kFused, "Condyle's own kernels; needs no other library")
      .value("onnxruntime", Runtime::kOnnxruntime, "any graph");
  m.def("runtime_from_name", &surrogate::runtime_from_name, "word"_a,
        "Runtime from 'auto', 'fused' or 'onnxruntime'.");
  nb::class_<OnnxContactModel, contact::ContactModel>(
      m, "OnnxContactModel", "A surrogate in an ONNX file (contract version 1).")
      .def(nb::init<const std::filesystem::path&, Runtime>(), "file"_a, "runtime"_a,
           nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("runtime", &OnnxContactModel::runtime,
                   "What evaluates it: fused or onnxruntime.")
      .def_prop_ro("fused_refusal", &OnnxContactModel::fused_refusal,
                   "Why the fused path did not take the file; empty where it did.")
      .def_prop_ro("instruction_set", &OnnxContactModel::instruction_set,
                   "Of the fused kernels; empty with onnxruntime.")
      .def_prop_ro("has_stiffness", &OnnxContactModel::has_stiffness,
                   "False for a wrench-only file: no stiffness, and error and trust are NaN.")
      .def_prop_ro("metadata", &OnnxContactModel::metadata, "The file's metadata, texts by key.")
      .def_prop_ro("file", &OnnxContactModel::file, "The file that was read.");
  nb::class_<HybridContactModel, contact::ContactModel>(
      m, "HybridContactModel",
      "The surrogate from trust 0.75 on, the reference below 0.5, a continuous blend in between.")
      .def(nb::init<std::shared_ptr<const contact::ContactModel>,
                    std::shared_ptr<const contact::ContactModel>>(),
           "surrogate"_a, "reference"_a)
      .def_prop_ro("evaluations", &HybridContactModel::evaluations,
                   "Poses that it was asked about, from the beginning.")
      .def_prop_ro("reference_calls", &HybridContactModel::reference_calls,
                   "Poses that the reference was called for, alone or blended, from the beginning.")
      .def_prop_ro("log", &logged_calls, nb::rv_policy::move,
                   "(poses (n, 6), the surrogate's trust (n,)) of the first of them, in order.");
}

}  // namespace condyle::bindings
