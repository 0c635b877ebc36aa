// SPDX-License-Identifier: Apache-2.0
// The fast evaluation of the mesh contact: the contact integral over a smooth (C2) distance field
// of the femur.
//
// The energy U = Σ A W(max(0, −s(q))), s the spline field at a centroid seen from the femur, is C1
// in the pose; the wrench is its exact derivative, continuous and piecewise smooth; the stiffness
// is the wrench's exact derivative, one-sided where a face enters contact. So the contact is
// conservative to rounding, whatever the field's own error against the mesh; the field is summed in
// single precision (some 1e-7 of a face's depth), all else in double. A pose is evaluated on one
// thread, in a fixed order, without allocating.
//
// Faces closest to the femur's open border are told from the field's flags, to half a spacing
// (geometry/distance_field.hpp).
#pragma once

#include <filesystem>
#include <memory>

#include "condyle/contact/face_evaluation.hpp"
#include "condyle/geometry/distance_field.hpp"

namespace condyle::contact {

/// The instruction sets that the kernel has versions for, weakest first. Results agree to 1e-12.
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };

/// The widest one that this machine (and this build) can run.
InstructionSet best_instruction_set();
const char* name(InstructionSet set);

struct FastSettings {
  geometry::DistanceFieldSettings field;
  /// Where fields are kept between runs (geometry/distance_field_cache.hpp); empty: nowhere.
  std::filesystem::path cache_directory;
  int threads = 0;  ///< of the build; 0: all
};

/// The fast evaluation of a femoral surface: its field from the cache or built (a few seconds),
/// then evaluated by the widest kernel that the machine has.
/// @pre femur and compartments are well formed.
/// @throws std::invalid_argument if a setting is out of range.
std::unique_ptr<FaceEvaluation> make_fast_evaluation(const geometry::TriangleMesh& femur,
                                                     const Compartments& compartments,
                                                     const ContactLaw& law,
                                                     const FastSettings& settings = {});

/// The fast evaluation over a field that is there already.
/// @param field shared: several evaluations (laws, inserts) may use one field.
/// @throws std::invalid_argument if this machine or build cannot run `set`, naming it.
std::unique_ptr<FaceEvaluation> make_fast_evaluation(
    std::shared_ptr<const geometry::DistanceField> field, const Compartments& compartments,
    const ContactLaw& law, InstructionSet set = best_instruction_set());

}  // namespace condyle::contact
