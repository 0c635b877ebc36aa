// SPDX-License-Identifier: Apache-2.0
// Small surfaces whose geometry is known in closed form.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "condyle/common/types.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::test {

using geometry::TriangleMesh;

inline TriangleMesh mesh_of(const std::vector<Vector3>& vertices,
                            const std::vector<Eigen::Vector3i>& faces) {
  TriangleMesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  }
  return mesh;
}

/// Closed box with corners at ±half, outward. 8 vertices, 12 faces.
inline TriangleMesh box(const Vector3& half) {
  std::vector<Vector3> v;
  for (int i = 0; i < 8; ++i) {
    v.emplace_back((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                   (i & 4) != 0 ? half.z() : -half.z());
  }
  return mesh_of(v, {{0, 4, 6},
                     {0, 6, 2},
                     {1, 3, 7},
                     {1, 7, 5},
                     {0, 1, 5},
                     {0, 5, 4},
                     {2, 6, 7},
                     {2, 7, 3},
                     {0, 2, 3},
                     {0, 3, 1},
                     {4, 5, 7},
                     {4, 7, 6}});
}

/// Icosahedron, each face cut in four `levels` times, on a sphere of that radius; 20·4^levels
/// faces, outward.
inline TriangleMesh sphere(double radius, int levels) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Vector3> v = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                            {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                            {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Eigen::Vector3i> f = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (auto& p : v) p.normalize();
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto key = std::minmax(a, b);
      const auto [at, fresh] = middles.try_emplace(key, static_cast<int>(v.size()));
      if (fresh)
        v.push_back((v[static_cast<std::size_t>(a)] + v[static_cast<std::size_t>(b)]).normalized());
      return at->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const auto& t : f) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    f = std::move(finer);
  }
  for (auto& p : v) p *= radius;
  return mesh_of(v, f);
}

/// Open patch y = height(x, z) over a rectangle about (x0, z0), cells × cells squares cut in two,
/// normals up (+y).
inline TriangleMesh patch(double x0, double z0, double half, int cells,
                          const std::function<double(double, double)>& height) {
  std::vector<Vector3> v;
  std::vector<Eigen::Vector3i> f;
  const double step = 2.0 * half / cells;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const double x = x0 - half + i * step, z = z0 - half + j * step;
      v.emplace_back(x, height(x, z), z);
    }
  }
  const int row = cells + 1;
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const int a = i * row + j;
      f.insert(f.end(), {{a, a + 1, a + row + 1}, {a, a + row + 1, a + row}});
    }
  }
  return mesh_of(v, f);
}

inline TriangleMesh moved(TriangleMesh mesh, const RigidTransform& X) {
  for (Eigen::Index i = 0; i < mesh.vertex_count(); ++i) {
    mesh.vertices.row(i) = X * Vector3(mesh.vertices.row(i));
  }
  return mesh;
}

inline TriangleMesh shifted(TriangleMesh mesh, const Vector3& by) {
  mesh.vertices.rowwise() += by.transpose();
  return mesh;
}

inline TriangleMesh reversed(TriangleMesh mesh) {
  mesh.faces.col(1).swap(mesh.faces.col(2));
  return mesh;
}

/// Mirror image in z, normals still out.
inline TriangleMesh mirrored(TriangleMesh mesh) {
  mesh.vertices.col(2) *= -1.0;
  return reversed(mesh);
}

inline TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both;
  both.vertices.resize(a.vertex_count() + b.vertex_count(), 3);
  both.vertices << a.vertices, b.vertices;
  both.faces.resize(a.face_count() + b.face_count(), 3);
  both.faces << a.faces, (b.faces.array() + static_cast<std::int32_t>(a.vertex_count())).matrix();
  return both;
}

/// Every face with three vertices of its own, as an STL has them.
inline TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh loose;
  loose.vertices.resize(3 * mesh.face_count(), 3);
  loose.faces.resize(mesh.face_count(), 3);
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      loose.vertices.row(3 * f + k) = mesh.vertices.row(mesh.faces(f, k));
      loose.faces(f, k) = static_cast<std::int32_t>(3 * f + k);
    }
  }
  return loose;
}

}  // namespace condyle::test
