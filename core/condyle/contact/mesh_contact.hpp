// SPDX-License-Identifier: Apache-2.0
// The reference contact: a femoral component and the two compartments of an insert, as triangle
// surfaces pressed into each other (contact_pair.hpp), with a knee's checks, names and flags.
//
// Source: Marra et al. 2015, J Biomech Eng 137(2):020904, doi:10.1115/1.4029258; Marra et al. 2017.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "condyle/contact/compartments.hpp"
#include "condyle/contact/contact_law.hpp"
#include "condyle/contact/contact_model.hpp"
#include "condyle/contact/contact_pair.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

struct MeshContactSettings {
  PairSettings pair;
  /// Depth beyond which an overlap is flagged as implausible [m]; 2 mm is the filter of Marra et
  /// al. 2017.
  double plausible_depth = 2e-3;
};

/// Elastic layers by face, for laws that have one. Empty: the law's own.
struct ImplantLayers {
  std::vector<Layer> femur;
  std::array<std::vector<Layer>, kSides> insert;
};

/// One side's contact at one pose, in full.
struct SideDetail {
  Wrench wrench = Wrench::Zero();                ///< on the femur, at Fo, in T [N, Nm]
  double energy = 0.0;                           ///< [J]
  double volume = 0.0;                           ///< Σ A d [m³]
  double area = 0.0;                             ///< of loaded faces [m²]
  double border_area = 0.0;                      ///< of overlapping faces that did not count [m²]
  double max_depth = 0.0;                        ///< [m]
  double peak_pressure = 0.0;                    ///< [Pa]
  double mean_pressure = 0.0;                    ///< Σ A p / area; 0 out of contact [Pa]
  Vector3 centre_of_pressure = Vector3::Zero();  ///< in T; zero out of contact [m]
  bool implausible_depth = false;                ///< deeper than plausible
  bool back_face = false;                        ///< a loaded face overlaps a back face
};

/// Both sides at one pose, and what to think of it.
struct ContactDetail {
  std::array<SideDetail, kSides> sides;
  /// "ok", or what is wrong on which side and what to do about it; no commas, so that it fits a CSV
  /// field.
  std::string status;
};

/// Contact between a femoral component and the two compartments of an insert.
class MeshContact final : public ContactModel {
 public:
  /// @param femur surface of the femoral component in F [m], normals out of the component. Open or
  /// closed.
  /// @param insert surfaces of the two compartments in T [m], normals out of the insert (up).
  /// @throws std::invalid_argument naming the mesh and the remedy if one is not well formed, its
  /// windings disagree, its
  ///   normals point inwards, the femur and the insert look swapped, a compartment lies on the
  ///   wrong side of z = 0, layers do not match (make_contact_pair), or a setting is out of range.
  MeshContact(const geometry::TriangleMesh& femur, const InsertMeshes& insert,
              SideOfBody side_of_body, const ContactLaw& law = {},
              const MeshContactSettings& settings = {}, const ImplantLayers& layers = {});

  SideOfBody side_of_body() const override { return side_of_body_; }
  const ContactLaw& law() const { return law_; }
  const MeshContactSettings& settings() const { return settings_; }
  const geometry::TriangleMesh& femur() const { return femur_; }
  const InsertMeshes& insert() const { return insert_; }

  /// Extent of both compartments together along z [m].
  double insert_width() const;

  ContactLoads evaluate(const Pose& pose, Derivatives derivatives) const override;

  /// Everything that evaluate() leaves out. @throws std::invalid_argument for a pose that is not
  /// finite.
  ContactDetail evaluate_detail(const Pose& pose) const;

  /// evaluate_detail() of many poses on `threads` threads (0: all); the same bytes for any number.
  /// @throws std::invalid_argument for a pose that is not finite, naming its row.
  std::vector<ContactDetail> evaluate_details(std::span<const Pose> poses, int threads) const;

  /// Depth and pressure of each face of one compartment; of the femur where only its faces are
  /// integrated. @throws std::invalid_argument for a pose that is not finite.
  FacePressure face_pressure(const Pose& pose, Side side) const;

 private:
  bool implausible(const CompartmentLoads& loads) const;

  geometry::TriangleMesh femur_;
  InsertMeshes insert_;
  SideOfBody side_of_body_;
  ContactLaw law_;
  MeshContactSettings settings_;
  ContactPair pair_;
};

}  // namespace condyle::contact
