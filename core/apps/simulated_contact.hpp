// SPDX-License-Identifier: Apache-2.0
// The knee's contact model of a simulation: meshes, a surrogate, or a surrogate with the meshes
// where it does not trust itself.
#pragma once

#include <memory>

#include "condyle/contact/mesh_contact.hpp"
#include "condyle/surrogate/hybrid_contact_model.hpp"
#include "condyle/surrogate/onnx_contact_model.hpp"
#include "implant_options.hpp"

namespace condyle::apps {

/// `contact` is what is simulated with; the others are what it is, or is made of, if it is.
struct SimulatedContact {
  std::shared_ptr<const contact::ContactModel> contact;
  std::shared_ptr<const contact::MeshContact> meshes;
  std::shared_ptr<const surrogate::OnnxContactModel> surrogate;
  std::shared_ptr<const surrogate::HybridContactModel> hybrid;
};

/// Reads what the options name.
/// @throws std::invalid_argument as read_mesh_contact, for options that do not go together, and for
/// a surrogate without stiffness.
SimulatedContact read_simulated_contact(const ImplantOptions& options, bool hybrid);

}  // namespace condyle::apps
