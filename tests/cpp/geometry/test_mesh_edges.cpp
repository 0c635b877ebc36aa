// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/geometry/mesh_edges.hpp"
#include "geometry/shapes.hpp"

using namespace condyle;
using namespace condyle::geometry;

TEST_CASE(
    "a closed surface's edges follow Euler, and their two faces run along them opposite ways") {
  const auto mesh = test::sphere(0.02, 2);
  const MeshEdges edges(mesh);
  CHECK(static_cast<Eigen::Index>(edges.count()) == mesh.vertex_count() + mesh.face_count() - 2);
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto sides = edges.sides(e);
    REQUIRE(sides.size() == 2);
    CHECK(sides[0].forward != sides[1].forward);
    CHECK(sides[0].face < sides[1].face);
    for (const auto& side : sides) {
      const int from = mesh.faces(side.face, side.corner),
                to = mesh.faces(side.face, (side.corner + 1) % 3);
      CHECK(std::min(from, to) == side.low);
      CHECK(std::max(from, to) == side.high);
      CHECK((from < to) == side.forward);
    }
  }
}

TEST_CASE("a face side between one vertex and itself is no edge") {
  const auto mesh = test::mesh_of({{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}});
  CHECK(MeshEdges(mesh).count() == 1);
}
