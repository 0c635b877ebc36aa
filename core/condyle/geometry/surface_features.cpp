// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/surface_features.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "condyle/geometry/mesh_edges.hpp"

namespace condyle::geometry {
namespace {

// Below this the direction p − c is rounding, not geometry: coordinates of 0.1 m carry about 1e-17
// m each, and a pressure at a depth of 1 pm is 1e-9 of a real one.
constexpr double kOnSurface = 1e-12;  // [m]

double angle_between(const Vector3& u, const Vector3& v) {
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

std::size_t slot(Eigen::Index face, int corner) {
  return static_cast<std::size_t>(3 * face + corner);
}

}  // namespace

Matrix3 SurfaceQuery::hessian() const {
  if (feature == Feature::kFace || std::abs(distance) < kOnSurface) return Matrix3::Zero();
  Matrix3 projector = Matrix3::Identity() - gradient * gradient.transpose();
  if (feature == Feature::kEdge) projector -= edge_direction * edge_direction.transpose();
  return projector / distance;
}

SurfaceFeatures::SurfaceFeatures(const TriangleMesh& mesh) {
  const auto faces = static_cast<std::size_t>(mesh.face_count());
  triangles_.resize(faces);
  balls_.resize(faces);
  face_normal_.resize(faces);
  std::vector<Vector3> vertex_normal(static_cast<std::size_t>(mesh.vertex_count()),
                                     Vector3::Zero());
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    Triangle& t = triangles_[static_cast<std::size_t>(f)];
    t = {mesh.vertices.row(mesh.faces(f, 0)), mesh.vertices.row(mesh.faces(f, 1)),
         mesh.vertices.row(mesh.faces(f, 2))};
    const Vector3 m = (t.a + t.b + t.c) / 3.0;
    balls_[static_cast<std::size_t>(f)] = {
        m, std::sqrt(std::max(
               {(t.a - m).squaredNorm(), (t.b - m).squaredNorm(), (t.c - m).squaredNorm()}))};
    const Vector3 cross = (t.b - t.a).cross(t.c - t.a);
    const double norm = cross.norm();
    const Vector3 normal = norm > 0.0 ? Vector3(cross / norm) : Vector3::Zero();
    face_normal_[static_cast<std::size_t>(f)] = normal;
    const Vector3* corners[] = {&t.a, &t.b, &t.c};
    for (int k = 0; k < 3; ++k) {
      const double angle =
          angle_between(*corners[(k + 1) % 3] - *corners[k], *corners[(k + 2) % 3] - *corners[k]);
      vertex_normal[static_cast<std::size_t>(mesh.faces(f, k))] += angle * normal;
    }
  }

  side_normal_.assign(3 * faces, Vector3::Zero());
  side_border_.assign(3 * faces, 0);
  std::vector<std::uint8_t> vertex_border(vertex_normal.size(), 0);
  const MeshEdges edges(mesh);
  for (std::size_t e = 0; e < edges.count(); ++e) {
    const auto sides = edges.sides(e);
    Vector3 normal = Vector3::Zero();
    for (const auto& side : sides) normal += face_normal_[static_cast<std::size_t>(side.face)];
    for (const auto& side : sides) {
      side_normal_[slot(side.face, side.corner)] = normal;
      side_border_[slot(side.face, side.corner)] = sides.size() == 1;
    }
    if (sides.size() == 1) {
      vertex_border[static_cast<std::size_t>(sides[0].low)] = 1;
      vertex_border[static_cast<std::size_t>(sides[0].high)] = 1;
    }
  }

  corner_normal_.resize(3 * faces);
  corner_border_.resize(3 * faces);
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(mesh.faces(f, k));
      corner_normal_[slot(f, k)] = vertex_normal[vertex];
      corner_border_[slot(f, k)] = vertex_border[vertex];
    }
  }
}

SurfaceQuery SurfaceFeatures::resolve(const Vector3& p, std::int32_t face,
                                      const ClosestPoint& closest) const {
  const Triangle& t = triangle(face);
  SurfaceQuery query;
  query.face = face;
  if (closest.part == TrianglePart::kInside) {
    // n·(p − a) rather than |p − c|: exact to rounding also where p nearly touches the face.
    query.gradient = face_normal(face);
    query.distance = query.gradient.dot(p - t.a);
    query.continuation = query.distance;
    return query;
  }

  Vector3 normal;
  if (closest.part <= TrianglePart::kSide2) {
    const int k = static_cast<int>(closest.part) - static_cast<int>(TrianglePart::kSide0);
    const Vector3* corners[] = {&t.a, &t.b, &t.c};
    query.feature = Feature::kEdge;
    query.edge_direction = (*corners[(k + 1) % 3] - *corners[k]).normalized();
    query.on_border = side_border_[slot(face, k)] != 0;
    normal = side_normal_[slot(face, k)];
  } else {
    const int k = static_cast<int>(closest.part) - static_cast<int>(TrianglePart::kCorner0);
    query.feature = Feature::kVertex;
    query.on_border = corner_border_[slot(face, k)] != 0;
    normal = corner_normal_[slot(face, k)];
  }
  const Vector3 away = p - closest.point;
  const double length = away.norm();
  query.distance = away.dot(normal) < 0.0 ? -length : length;
  query.continuation = away.dot(face_normal(face));
  query.gradient = length < kOnSurface ? normal.normalized() : Vector3(away / query.distance);
  return query;
}

}  // namespace condyle::geometry
