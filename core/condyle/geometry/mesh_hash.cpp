// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_hash.hpp"

#include <bit>
#include <cstdint>

#include "condyle/common/sha256.hpp"

namespace condyle::geometry {

static_assert(std::endian::native == std::endian::little,
              "the hash is defined on little-endian bytes");

std::string content_hash(const TriangleMesh& mesh) {
  Sha256 hash;
  const std::int64_t counts[] = {mesh.vertex_count(), mesh.face_count()};
  hash.update(counts, sizeof counts);
  hash.update(mesh.vertices.data(),
              static_cast<std::size_t>(mesh.vertices.size()) * sizeof(double));
  hash.update(mesh.faces.data(),
              static_cast<std::size_t>(mesh.faces.size()) * sizeof(std::int32_t));
  return hash.finish();
}

}  // namespace condyle::geometry
