// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <set>

#include "condyle/geometry/mesh_hash.hpp"
#include "geometry/shapes.hpp"

using namespace condyle;
using namespace condyle::geometry;

namespace {
const TriangleMesh& tetrahedron() {
  static const auto mesh = test::mesh_of({{0, 0, 0}, {0.03, 0, 0}, {0, 0.02, 0}, {0, 0, 0.01}},
                                         {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
  return mesh;
}
}  // namespace

TEST_CASE("the content hash is the SHA-256 that any other program computes") {
  // Python: hashlib.sha256(struct.pack("<qq", 4, 4) + vertices.tobytes() + faces.tobytes())
  CHECK(content_hash(tetrahedron()) ==
        "19f0ce7e213fcac1ac0ea7e81e390926cf21f4d084920892b8474fd11cb1f589");
}

TEST_CASE("any change of vertices, faces or their order changes the hash") {
  std::set<std::string> hashes{content_hash(tetrahedron())};
  auto nudged = tetrahedron();
  nudged.vertices(1, 0) = std::nextafter(nudged.vertices(1, 0), 1.0);
  hashes.insert(content_hash(nudged));
  hashes.insert(content_hash(test::reversed(tetrahedron())));
  auto reordered = tetrahedron();
  reordered.faces.row(0).swap(reordered.faces.row(3));
  hashes.insert(content_hash(reordered));
  CHECK(hashes.size() == 4);
}
