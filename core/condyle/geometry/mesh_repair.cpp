// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_repair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "condyle/geometry/mesh_edges.hpp"

namespace condyle::geometry {
namespace {

using Corners = std::array<std::int32_t, 3>;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

// New name of every vertex: that of the first vertex within the distance. Buckets of that size, so
// that a vertex's partners are in its bucket or one of the 26 around it.
std::vector<std::int32_t> weld(const VertexArray& vertices, double distance) {
  using Bucket = std::array<std::int64_t, 3>;
  std::vector<std::int32_t> name(index(static_cast<std::int32_t>(vertices.rows())));
  if (distance == 0.0) {
    std::map<std::array<double, 3>, std::int32_t> first_at;
    for (std::int32_t v = 0; v < vertices.rows(); ++v) {
      const std::array<double, 3> place{vertices(v, 0) + 0.0, vertices(v, 1) + 0.0,
                                        vertices(v, 2) + 0.0};
      name[index(v)] = first_at.try_emplace(place, v).first->second;
    }
    return name;
  }
  // Only looked up, never walked: the hash's order does not reach the result.
  const auto hash = [](const Bucket& b) {
    std::uint64_t h = 0;
    for (const auto i : b)
      h = (h ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15ULL, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  };
  std::unordered_map<Bucket, std::vector<std::int32_t>, decltype(hash)> buckets(
      static_cast<std::size_t>(vertices.rows()), hash);
  for (std::int32_t v = 0; v < vertices.rows(); ++v) {
    const Vector3 p = vertices.row(v);
    Bucket at;
    for (int k = 0; k < 3; ++k)
      at[static_cast<std::size_t>(k)] = std::llround(std::floor(p[k] / distance));
    std::int32_t found = v;
    for (int n = 0; n < 27 && found == v; ++n) {
      const auto near = buckets.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
      if (near == buckets.end()) continue;
      for (const std::int32_t other : near->second) {
        if ((Vector3(vertices.row(other)) - p).norm() <= distance) found = std::min(found, other);
      }
    }
    name[index(v)] = found;
    if (found == v) buckets[at].push_back(v);
  }
  return name;
}

bool has_area(const VertexArray& vertices, const Corners& face) {
  if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) return false;
  const Vector3 a = vertices.row(face[0]), b = vertices.row(face[1]), c = vertices.row(face[2]);
  return (b - a).cross(c - a).norm() > 0.0;
}

// Keeps what can stay of the faces, on welded vertices.
void rebuild(const TriangleMesh& mesh, double weld_distance, RepairResult& result) {
  const std::vector<std::int32_t> welded = weld(mesh.vertices, weld_distance);
  std::vector<Corners> faces;
  std::set<Corners> seen;
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    Corners face;
    for (int k = 0; k < 3; ++k) face[static_cast<std::size_t>(k)] = welded[index(mesh.faces(f, k))];
    Corners sorted = face;
    std::sort(sorted.begin(), sorted.end());
    if (!has_area(mesh.vertices, face)) {
      ++result.degenerate_faces;
    } else if (!seen.insert(sorted).second) {
      ++result.duplicate_faces;
    } else {
      faces.push_back(face);
    }
  }
  if (faces.empty()) throw std::invalid_argument("mesh repair: no face has an area");

  std::vector<std::int32_t> renamed(welded.size(), -1);
  for (const auto& face : faces) {
    for (const auto v : face) renamed[index(v)] = 0;
  }
  std::int32_t count = 0;
  for (std::size_t v = 0; v < welded.size(); ++v) {
    if (index(welded[v]) != v) {
      ++result.welded_vertices;
    } else if (renamed[v] < 0) {
      ++result.unused_vertices;
    } else {
      renamed[v] = count++;
    }
  }
  result.mesh.vertices.resize(count, 3);
  for (std::size_t v = 0; v < welded.size(); ++v) {
    if (renamed[v] >= 0)
      result.mesh.vertices.row(renamed[v]) = mesh.vertices.row(static_cast<Eigen::Index>(v));
  }
  result.mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      result.mesh.faces(static_cast<Eigen::Index>(f), k) =
          renamed[index(faces[f][static_cast<std::size_t>(k)])];
    }
  }
}

// A neighbour over an edge of two faces, and whether the two windings disagree there.
struct Neighbour {
  std::int32_t face;
  bool disagrees;
};

struct Adjacency {
  std::vector<std::vector<Neighbour>> neighbours;
  std::vector<bool> at_border;  // has an edge that is not shared by exactly two faces
};

Adjacency adjacency_of(const TriangleMesh& mesh) {
  const auto faces = static_cast<std::size_t>(mesh.face_count());
  Adjacency adjacency{std::vector<std::vector<Neighbour>>(faces), std::vector<bool>(faces, false)};
  const MeshEdges edges(mesh);
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto sides = edges.sides(e);
    if (sides.size() != 2) {
      for (const auto& side : sides) adjacency.at_border[index(side.face)] = true;
      continue;
    }
    const bool disagrees = sides[0].forward == sides[1].forward;
    adjacency.neighbours[index(sides[0].face)].push_back({sides[1].face, disagrees});
    adjacency.neighbours[index(sides[1].face)].push_back({sides[0].face, disagrees});
  }
  return adjacency;
}

double volume_share(const TriangleMesh& mesh, std::int32_t f, const Vector3& origin) {
  const Vector3 a = mesh.vertices.row(mesh.faces(f, 0)).transpose() - origin;
  const Vector3 b = mesh.vertices.row(mesh.faces(f, 1)).transpose() - origin;
  const Vector3 c = mesh.vertices.row(mesh.faces(f, 2)).transpose() - origin;
  return a.dot(b.cross(c)) / 6.0;
}

void orient(const RepairSettings& settings, RepairResult& result) {
  TriangleMesh& mesh = result.mesh;
  const Adjacency adjacency = adjacency_of(mesh);
  const Eigen::VectorXd areas = face_areas(mesh);
  std::vector<std::int8_t> turn(static_cast<std::size_t>(mesh.face_count()),
                                -1);  // −1 not reached yet
  std::vector<std::int32_t> component;
  for (std::int32_t seed = 0; seed < mesh.face_count(); ++seed) {
    if (turn[index(seed)] >= 0) continue;
    component.assign(1, seed);
    turn[index(seed)] = 0;
    bool closed = true;
    double kept = 0.0, turned = 0.0, volume = 0.0;
    const Vector3 origin = mesh.vertices.row(mesh.faces(seed, 0));
    for (std::size_t next = 0; next < component.size(); ++next) {
      const std::int32_t f = component[next];
      const bool turns = turn[index(f)] != 0;
      (turns ? turned : kept) += areas[f];
      volume += (turns ? -1.0 : 1.0) * volume_share(mesh, f, origin);
      closed = closed && !adjacency.at_border[index(f)];
      for (const Neighbour& neighbour : adjacency.neighbours[index(f)]) {
        if (turn[index(neighbour.face)] >= 0) continue;
        turn[index(neighbour.face)] = turns != neighbour.disagrees;
        component.push_back(neighbour.face);
      }
    }
    bool all = turned > kept;
    if (closed && settings.turn_closed_outward) all = volume < 0.0;
    for (const auto f : component) turn[index(f)] = (turn[index(f)] != 0) != all;
  }
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    if (turn[index(f)] == 0) continue;
    std::swap(mesh.faces(f, 1), mesh.faces(f, 2));
    ++result.turned_faces;
  }
}

}  // namespace

RepairResult repair_mesh(const TriangleMesh& mesh, const RepairSettings& settings) {
  require_well_formed(mesh, "mesh repair");
  if (!std::isfinite(settings.weld_distance) || settings.weld_distance < 0.0) {
    throw std::invalid_argument("weld_distance is " + std::to_string(settings.weld_distance) +
                                " m: must be finite and not negative");
  }
  RepairResult result;
  rebuild(mesh, settings.weld_distance, result);
  orient(settings, result);
  const MeshEdges edges(result.mesh);
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto sides = edges.sides(e);
    result.inconsistent_edges += sides.size() == 2 && sides[0].forward == sides[1].forward;
  }
  return result;
}

}  // namespace condyle::geometry
