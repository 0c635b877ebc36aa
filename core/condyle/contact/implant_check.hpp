// SPDX-License-Identifier: Apache-2.0
// Is this mesh the part it is said to be? Checks before a contact is built: a surface that faces
// the wrong way, or a swapped pair, computes something that looks like a result.
#pragma once

#include "condyle/contact/compartments.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::contact {

/// Throws std::invalid_argument unless the femoral component is well formed, its faces wind one
/// way, and its normals point out. Out means positive volume of a closed surface; of an open one,
/// normals that point down (to the insert) in its lowest tenth. Nothing is flipped silently: an
/// open surface alone cannot say which side is metal.
void require_femur(const geometry::TriangleMesh& femur);

/// Throws std::invalid_argument unless each compartment is well formed, its normals point out of
/// the insert (positive volume, or up in its highest tenth where open), and it lies on its side of
/// z_T = 0 (within 1 mm of it, on average).
void require_insert(const InsertMeshes& insert, SideOfBody side_of_body);

/// Throws std::invalid_argument if a femoral component is less high (along y) than the insert it is
/// paired with: true of every knee replacement, and false when the two files are swapped. For
/// implants from files; a ball in a deep cup is no error.
void require_unswapped(const geometry::TriangleMesh& femur, const InsertMeshes& insert);

}  // namespace condyle::contact
