// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "condyle/contact/fast_faces.hpp"
#include "support/random_pose.hpp"

namespace condyle::contact::fast {
namespace {

SurfaceFaces scattered(int count) {
  test::Draw draw(51);
  SurfaceFaces faces;
  faces.centroids.resize(count, 3);
  faces.areas.resize(count);
  faces.normals.resize(count, 3);
  for (int f = 0; f < count; ++f) {
    const double x = draw(-0.02, 0.03), z = draw(-0.04, -0.01);
    faces.centroids.row(f) << x, 5.0 * x * x + 0.1 * z, z;
    faces.areas[f] = f % 7 == 3 ? 0.0 : draw(1e-7, 3e-7);
    faces.normals.row(f) << 0.1 * f, 1.0, 0.3;
  }
  return faces;
}

TEST_CASE(
    "[property] every face with area is there once, padding has no area, and balls hold their "
    "faces") {
  for (const int count : {1, 3, 16, 17, 127, 128, 129, 1000}) {
    CAPTURE(count);
    const SurfaceFaces faces = scattered(count);
    const SortedFaces sorted(faces);
    const FacesView v = sorted.faces();
    const ClustersView c = sorted.clusters();
    CHECK(c.face_count % kLargestGroup == 0);
    CHECK(c.leaf_count == (c.face_count + kLeafFaces - 1) / kLeafFaces);
    CHECK(c.parent_count == (c.leaf_count + kParentLeaves - 1) / kParentLeaves);
    using Face = std::array<double, 4>;
    std::vector<Face> expected, found;
    for (int f = 0; f < count; ++f) {
      if (faces.areas[f] > 0.0) {
        expected.push_back(
            {faces.areas[f], faces.centroids(f, 0), faces.centroids(f, 2), faces.normals(f, 0)});
      }
    }
    for (int f = 0; f < c.face_count; ++f) {
      if (v.area[f] > 0.0) found.push_back({v.area[f], v.x[f], v.z[f], v.nx[f]});
      CHECK(faces.centroids(sorted.order()[static_cast<std::size_t>(f)], 0) == v.x[f]);
      for (const Cluster& ball :
           {c.leaves[f / kLeafFaces], c.parents[f / (kLeafFaces * kParentLeaves)]}) {
        const Vector3 p(v.x[f], v.y[f], v.z[f]),
            centre(ball.centre[0], ball.centre[1], ball.centre[2]);
        CHECK((p - centre).norm() <= ball.radius);
      }
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    CHECK(expected == found);
  }
}

TEST_CASE("[property] leaves are compact") {
  const SortedFaces sorted(scattered(2000));
  const ClustersView c = sorted.clusters();
  double mean = 0.0;
  for (int l = 0; l < c.leaf_count; ++l) mean += c.leaves[l].radius / c.leaf_count;
  // 1 715 faces on 50 × 30 mm: a leaf of 16 covers 14 mm², a square of half diagonal 2.6 mm;
  // unsorted it would be 25 mm.
  CHECK(mean < 3.5e-3);
}

TEST_CASE("[property] no faces, no clusters") {
  SurfaceFaces none = scattered(5);
  none.areas.setZero();
  const SortedFaces sorted(none);
  CHECK(sorted.clusters().parent_count == 0);
  CHECK(sorted.clusters().face_count == 0);
}

}  // namespace
}  // namespace condyle::contact::fast
