// SPDX-License-Identifier: Apache-2.0
// The contacts of a knee in a body model, from the surfaces that a user names.
//
//   tibiofemoral     F the femoral mesh's axes, T the insert's; meshes, a surrogate or a hybrid
//   patellofemoral   F the femoral mesh's axes, T the patellar button's; meshes, over the button's
//                    faces
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "condyle/contact/contact_law.hpp"
#include "condyle/fdk/body_contact.hpp"
#include "implant_options.hpp"
#include "simulated_contact.hpp"
#include "trial_options.hpp"

namespace condyle::apps {

/// A contact of the simulation, and what it was made from.
struct TrialContact {
  fdk::BodyContactDescription description;  ///< its model is owned by `contact`
  std::shared_ptr<const contact::ContactModel> contact;
  SimulatedContact made;      ///< of the tibiofemoral one
  bool one_sided = false;     ///< a pair of bodies: all of the load is on the medial side
  std::string kind;           ///< what evaluates it: exact, fast, surrogate, hybrid
  std::string evaluation;     ///< of the meshes: exact, fast
  std::string moving, fixed;  ///< surfaces, by name
  std::vector<std::pair<std::string, std::string>> mesh_hashes;  ///< by part; empty: no meshes
  contact::LawDescription law;                                   ///< of the meshes
  double plausible_depth = 0.0;
};

/// The contacts, and the files that they are made from by what they are (femur_mesh, surrogate, …).
struct TrialContacts {
  std::vector<TrialContact> contacts;
  std::vector<std::pair<std::string, std::filesystem::path>> files;
};

/// Reads the surfaces, the meshes that are needed, and the surrogate if there is one.
/// @throws std::invalid_argument naming the file, the surface, or the option, and what is wrong.
TrialContacts make_trial_contacts(const model::Model& model, const TrialOptions& options,
                                  const ImplantOptions& implant, bool hybrid);

}  // namespace condyle::apps
