// SPDX-License-Identifier: Apache-2.0
// The fast contact integral: over a smooth (C2) distance field of the other body.
//
// The energy U = Σ A W(max(0, −s(q))), s the spline field at a centroid seen from the body whose
// field it is, is C1 in the pose; the wrench is its exact derivative, continuous and piecewise
// smooth; the stiffness is the wrench's exact derivative, one-sided where a face enters contact. So
// the contact is conservative to rounding, whatever the field's own error against the mesh; the
// field is summed in single precision (some 1e-7 of a face's depth), all else in double. A pose is
// evaluated on one thread, in a fixed order, without allocating.
//
// Faces closest to the open border are told from the field's flags, to half a spacing
// (geometry/distance_field.hpp).
#pragma once

#include <memory>

#include "condyle/contact/surface_integral.hpp"
#include "condyle/geometry/distance_field.hpp"

namespace condyle::contact {

/// The instruction sets that the kernel has versions for, weakest first. Results agree to 1e-12.
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };

/// The widest one that this machine (and this build) can run.
InstructionSet best_instruction_set();
const char* name(InstructionSet set);

/// @param field of the body whose distance is taken; shared: several surfaces and laws may use it.
/// @param faces of the other body, well formed.
/// @throws std::invalid_argument if this machine or build cannot run `set`, naming it.
std::unique_ptr<SurfaceIntegral> make_fast_integral(
    std::shared_ptr<const geometry::DistanceField> field, SurfaceFaces faces, const ContactLaw& law,
    InstructionSet set = best_instruction_set());

}  // namespace condyle::contact
