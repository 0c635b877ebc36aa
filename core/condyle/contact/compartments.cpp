// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/compartments.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace condyle::contact {
namespace {

geometry::TriangleMesh submesh(const geometry::TriangleMesh& mesh,
                               const std::vector<Eigen::Index>& faces) {
  std::vector<std::int32_t> renamed(static_cast<std::size_t>(mesh.vertex_count()), -1);
  for (const auto f : faces) {
    for (int k = 0; k < 3; ++k) renamed[static_cast<std::size_t>(mesh.faces(f, k))] = 0;
  }
  std::int32_t count = 0;
  for (auto& name : renamed) name = name < 0 ? -1 : count++;

  geometry::TriangleMesh part;
  part.vertices.resize(count, 3);
  for (Eigen::Index v = 0; v < mesh.vertex_count(); ++v) {
    const auto name = renamed[static_cast<std::size_t>(v)];
    if (name >= 0) part.vertices.row(name) = mesh.vertices.row(v);
  }
  part.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      part.faces(static_cast<Eigen::Index>(i), k) =
          renamed[static_cast<std::size_t>(mesh.faces(faces[i], k))];
    }
  }
  return part;
}

}  // namespace

InsertMeshes split_insert(const geometry::TriangleMesh& insert, SideOfBody side_of_body) {
  geometry::require_well_formed(insert, "insert");
  const geometry::VertexArray centroids = geometry::face_centroids(insert);
  const Side right = medial_direction(side_of_body) > 0.0 ? kMedial : kLateral;
  const Side left = right == kMedial ? kLateral : kMedial;
  std::array<std::vector<Eigen::Index>, kSides> faces;
  for (Eigen::Index f = 0; f < insert.face_count(); ++f) {
    faces[centroids(f, 2) >= 0.0 ? right : left].push_back(f);
  }
  InsertMeshes sides;
  for (const Side side : {kMedial, kLateral}) {
    if (faces[side].empty()) {
      throw std::invalid_argument(
          "insert: no face on the " + std::string(name(side)) +
          " side of z = 0: is the insert's frame in the middle of it, with z to the right?");
    }
    sides[side] = submesh(insert, faces[side]);
  }
  return sides;
}

}  // namespace condyle::contact
