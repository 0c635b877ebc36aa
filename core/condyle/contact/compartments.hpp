// SPDX-License-Identifier: Apache-2.0
// Which part of the insert is the medial and which the lateral compartment.
#pragma once

#include <array>

#include "condyle/common/side.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

/// The insert's surface of each side, indexed by condyle::Side, expressed in T.
using InsertMeshes = std::array<geometry::TriangleMesh, kSides>;

/// Splits one insert into its compartments by the sign of each face's centroid z_T; faces are not
/// cut, and one with its centroid at exactly z_T = 0 goes to the subject's right. Order of faces
/// and vertices is kept; vertices no longer used are dropped.
/// @throws std::invalid_argument if a side gets no face, saying which.
InsertMeshes split_insert(const geometry::TriangleMesh& insert, SideOfBody side_of_body);

}  // namespace condyle::contact
