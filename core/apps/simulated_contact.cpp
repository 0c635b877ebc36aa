// SPDX-License-Identifier: Apache-2.0
#include "simulated_contact.hpp"

#include <stdexcept>

namespace condyle::apps {
namespace {

std::shared_ptr<const surrogate::OnnxContactModel> read_surrogate(const ImplantOptions& options) {
  auto model = std::make_shared<const surrogate::OnnxContactModel>(
      options.surrogate, surrogate::runtime_from_name(options.runtime));
  if (!model->has_stiffness()) {
    throw std::invalid_argument(options.surrogate +
                                ": has the output wrench alone; a simulation needs stiffness");
  }
  return model;
}

}  // namespace

SimulatedContact read_simulated_contact(const ImplantOptions& options, bool hybrid) {
  if (hybrid && options.surrogate.empty()) {
    throw std::invalid_argument("--hybrid needs --surrogate FILE.onnx beside the meshes");
  }
  if (hybrid && options.femur.empty()) {
    throw std::invalid_argument("--hybrid needs meshes beside --surrogate: --femur is missing");
  }
  SimulatedContact made;
  if (!options.surrogate.empty()) made.surrogate = read_surrogate(options);
  if (!options.surrogate.empty() && !hybrid) {
    require_no_meshes(options);
    made.contact = made.surrogate;
    return made;
  }
  made.meshes = read_mesh_contact(options);
  made.contact = made.meshes;
  if (hybrid) {
    made.contact = made.hybrid =
        std::make_shared<const surrogate::HybridContactModel>(made.surrogate, made.meshes);
  }
  return made;
}

}  // namespace condyle::apps
