// SPDX-License-Identifier: Apache-2.0
// The reference contact: two triangle surfaces pressed into each other.
//
//   U(pose) = Σ_faces A·W(d),   d = max(0, −φ(c)),   wrench = −∂U/∂(displacement of F)
//
// over the faces of the insert, c a face's centroid, φ the signed distance to the femoral
// component. Frictionless, elastic, path-independent. The force of a face acts along −∇φ of the
// femur, not along the face's own normal (which differs by about 1 % on a real pair): only so is
// the force the derivative of the energy.
//
// Limits: rigid bodies under a surface layer, quasi-static. Faces are points: the wrench is
// continuous, its derivative has a small jump where a face's centroid enters. A face whose closest
// point is on the femur's open border does not count, and energy is conserved only where
// `border_area` is 0.
//
// Source: Marra et al. 2015, J Biomech Eng 137(2):020904, doi:10.1115/1.4029258; Marra et al. 2017.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/contact/compartments.hpp"
#include "condyle/contact/contact_law.hpp"
#include "condyle/contact/contact_model.hpp"
#include "condyle/contact/face_evaluation.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

/// How distances to the femur are evaluated: to its triangles, or through a smooth field of them.
enum class Evaluation { kExact, kFast };

/// Reads "exact" or "fast". @throws std::invalid_argument for anything else, naming the text.
Evaluation evaluation_from_name(std::string_view text);
std::string_view name(Evaluation evaluation);

struct MeshContactSettings {
  Evaluation evaluation = Evaluation::kExact;
  /// Depth beyond which an overlap is flagged as implausible [m]; 2 mm is the filter of Marra et
  /// al. 2017.
  double plausible_depth = 2e-3;
  /// Folder that keeps the distance field of the fast evaluation, by content; empty: none is kept.
  /// Exact needs none.
  std::filesystem::path cache_directory;
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
  ///   wrong side of z = 0, or a setting is out of range.
  MeshContact(const geometry::TriangleMesh& femur, const InsertMeshes& insert,
              SideOfBody side_of_body, const ContactLaw& law = {},
              const MeshContactSettings& settings = {});

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

  /// Depth and pressure of each face of one compartment. @throws std::invalid_argument for a pose
  /// that is not finite.
  FacePressure face_pressure(const Pose& pose, Side side) const;

 private:
  bool implausible(const SideLoads& loads) const;

  geometry::TriangleMesh femur_;
  InsertMeshes insert_;
  SideOfBody side_of_body_;
  ContactLaw law_;
  MeshContactSettings settings_;
  std::unique_ptr<const FaceEvaluation> evaluation_;
};

}  // namespace condyle::contact
