// SPDX-License-Identifier: Apache-2.0
#include "trial_contacts.hpp"

#include <stdlib.h>

#include <stdexcept>
#include <system_error>

#include "condyle/contact/pair_contact_model.hpp"
#include "condyle/geometry/mesh_hash.hpp"
#include "condyle/io/surface_file.hpp"
#include "law_options.hpp"

namespace condyle::apps {
namespace {

using io::SurfaceFile;

/// A folder of its own that goes away again. No folder: whoever would use it does without.
class FolderForNow {
 public:
  FolderForNow() {
    std::error_code none;
    std::string name = (std::filesystem::temp_directory_path(none) / "condyle-XXXXXX").string();
    if (!none && mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~FolderForNow() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  FolderForNow(const FolderForNow&) = delete;
  FolderForNow& operator=(const FolderForNow&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

class Maker {
 public:
  Maker(const model::Model& model, const TrialOptions& options, const ImplantOptions& implant,
        bool hybrid)
      : options_(options), implant_(implant), hybrid_(hybrid) {
    implant_.plausible_depth = 1e-3 * options.plausible_depth_mm;
    side_ = side_of_body_from_name(implant.side_of_body);
    surfaces_ = io::read_surface_file(options.surfaces, model);
    femur_ = &find("--femur-surface", options.femur_surface);
    insert_ = &find("--insert-surface", options.insert_surface);
    if (!options.patella_surface.empty()) {
      patella_ = &find("--patella-surface", options.patella_surface);
    }
  }

  TrialContacts make() {
    TrialContacts made;
    made.files.emplace_back("surfaces", options_.surfaces);
    if (!implant_.law.law_table.empty()) {
      made.files.emplace_back("law_table", implant_.law.law_table);
    }
    if (!implant_.surrogate.empty()) made.files.emplace_back("surrogate", implant_.surrogate);
    const bool all_meshes = implant_.surrogate.empty() || hybrid_;
    add_file(made, "femur_mesh", *femur_, all_meshes || patella_ != nullptr);
    add_file(made, "insert_mesh", *insert_, all_meshes);
    if (patella_ != nullptr) add_file(made, "patella_mesh", *patella_, true);

    // Both contacts take the femur's field: kept for as long as that takes, unless a user says
    // where, and for how long.
    const FolderForNow for_now;
    if (implant_.cache.empty() && patella_ != nullptr) implant_.cache = for_now.path();
    made.contacts.push_back(tibiofemoral(all_meshes));
    if (patella_ != nullptr) made.contacts.push_back(patellofemoral());
    return made;
  }

 private:
  const SurfaceFile& find(const char* option, const std::string& name) const {
    try {
      return io::find_surface(surfaces_, name);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(options_.surfaces + ": " + option + ": " + error.what());
    }
  }

  void add_file(TrialContacts& made, const char* what, const SurfaceFile& surface,
                bool needed) const {
    if (!needed) return;
    if (surface.mesh.empty()) {
      throw std::invalid_argument(options_.surfaces + ": surface '" + surface.name +
                                  "' has no mesh: contact on meshes needs one");
    }
    made.files.emplace_back(what, surface.mesh);
  }

  TrialContact place(const char* name, const SurfaceFile& moving, const SurfaceFile& fixed) const {
    TrialContact contact;
    contact.description.name = name;
    contact.description.moving_body = moving.body;
    contact.description.fixed_body = fixed.body;
    contact.description.X_BF = moving.X_BS;
    contact.description.X_BT = fixed.X_BS;
    contact.description.side_of_body = side_;
    contact.moving = moving.name;
    contact.fixed = fixed.name;
    contact.kind = contact.evaluation = implant_.evaluation;
    contact.plausible_depth = implant_.plausible_depth;
    return contact;
  }

  TrialContact tibiofemoral(bool on_meshes) const {
    ImplantOptions knee = implant_;
    knee.femur = on_meshes ? femur_->mesh.string() : "";
    knee.insert = on_meshes ? insert_->mesh.string() : "";
    knee.units = on_meshes ? "m" : "";
    if (!on_meshes) {
      knee.side_of_body.clear();
      // It is the patella's then.
      if (patella_ != nullptr) knee.law = {};
    }
    TrialContact contact = place("tibiofemoral", *femur_, *insert_);
    contact.made = read_simulated_contact(knee, hybrid_);
    contact.contact = contact.made.contact;
    contact.description.model = contact.contact.get();
    if (hybrid_) contact.kind = "hybrid";
    if (!on_meshes) contact.kind = "surrogate";
    if (const auto& meshes = contact.made.meshes) {
      contact.law = meshes->law().describe();
      contact.mesh_hashes = {
          {"femur", geometry::content_hash(meshes->femur())},
          {"insert_medial", geometry::content_hash(meshes->insert()[kMedial])},
          {"insert_lateral", geometry::content_hash(meshes->insert()[kLateral])}};
    }
    return contact;
  }

  TrialContact patellofemoral() const {
    const auto unit = geometry::LengthUnit::kMetre;
    const auto femur = read_component(femur_->mesh.string(), unit);
    const auto button = read_component(patella_->mesh.string(), unit);
    const contact::ContactLaw law = read_law(implant_.law);
    TrialContact contact = place("patellofemoral", *femur_, *patella_);
    contact.contact = std::make_shared<const contact::PairContactModel>(
        contact::make_contact_pair(femur, {button}, law, pair_settings(implant_)), side_, kMedial,
        implant_.plausible_depth);
    contact.description.model = contact.contact.get();
    contact.one_sided = true;
    contact.law = law.describe();
    contact.mesh_hashes = {{"femur", geometry::content_hash(femur)},
                           {"patella", geometry::content_hash(button)}};
    return contact;
  }

  const TrialOptions& options_;
  ImplantOptions implant_;
  bool hybrid_ = false;
  SideOfBody side_ = SideOfBody::kRight;
  std::vector<SurfaceFile> surfaces_;
  const SurfaceFile* femur_ = nullptr;
  const SurfaceFile* insert_ = nullptr;
  const SurfaceFile* patella_ = nullptr;
};

}  // namespace

TrialContacts make_trial_contacts(const model::Model& model, const TrialOptions& options,
                                  const ImplantOptions& implant, bool hybrid) {
  return Maker(model, options, implant, hybrid).make();
}

}  // namespace condyle::apps
