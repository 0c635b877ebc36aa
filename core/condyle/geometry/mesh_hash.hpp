// SPDX-License-Identifier: Apache-2.0
// A mesh's content as a short name: for caches, and for metadata that says which surface a result
// belongs to.
#pragma once

#include <string>

#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// SHA-256 of the mesh's content, 64 lower-case hexadecimal digits.
///
/// Hashed are, little-endian and in this order: vertex count and face count (int64), vertices
/// (float64, row by row), faces (int32, row by row). SHA-256 rather than a quicker hash, because a
/// hash in metadata outlives the program: anyone can recompute it (Python: hashlib), and two
/// surfaces never share one. About 5 ms a megabyte.
/// @pre little-endian machine (checked when compiled).
std::string content_hash(const TriangleMesh& mesh);

}  // namespace condyle::geometry
