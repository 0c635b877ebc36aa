// SPDX-License-Identifier: Apache-2.0
// Triangles, pseudonormals and border flags of a surface: what a signed-distance query needs once
// it knows the closest face.
#pragma once

#include <vector>

#include "condyle/geometry/closest_point.hpp"
#include "condyle/geometry/signed_distance.hpp"

namespace condyle::geometry {

/// A ball about a face's centroid that holds the face.
struct Ball {
  Vector3 centre;
  double radius;
};

class SurfaceFeatures {
 public:
  explicit SurfaceFeatures(const TriangleMesh& mesh);

  std::int32_t face_count() const { return static_cast<std::int32_t>(triangles_.size()); }
  const Triangle& triangle(std::int32_t face) const {
    return triangles_[static_cast<std::size_t>(face)];
  }
  const Ball& ball(std::int32_t face) const { return balls_[static_cast<std::size_t>(face)]; }
  /// Unit normal of a face; zero for a face without area.
  const Vector3& face_normal(std::int32_t face) const {
    return face_normal_[static_cast<std::size_t>(face)];
  }

  /// Signed distance of p given that `closest` on `face` is the surface's closest point.
  SurfaceQuery resolve(const Vector3& p, std::int32_t face, const ClosestPoint& closest) const;

 private:
  std::vector<Triangle> triangles_;
  std::vector<Ball> balls_;
  std::vector<Vector3> face_normal_;
  std::vector<Vector3> side_normal_;    // 3 a face: sum of the unit normals that meet at the side
  std::vector<Vector3> corner_normal_;  // 3 a face: angle-weighted normal of the corner's vertex
  std::vector<std::uint8_t> side_border_;  // 3 a face
  std::vector<std::uint8_t> corner_border_;
};

}  // namespace condyle::geometry
