// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/fast_faces.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace condyle::contact::fast {
namespace {

constexpr std::size_t kLeaf = kLeafFaces;
constexpr std::size_t kParent = kLeaf * kParentLeaves;
static_assert(kLeafFaces % kLargestGroup == 0);

using Order = std::span<std::int32_t>;

// Sorts `order` so that every aligned run of a parent's and of a leaf's faces is compact: halves
// along the longest side, again and again, at a multiple of the run's length, so that only the last
// run is partly filled.
void sort_compact(const geometry::VertexArray& points, Order order) {
  if (order.size() <= kLeaf) return;
  Vector3 low = points.row(order[0]), high = low;
  for (const std::int32_t f : order) {
    low = low.cwiseMin(points.row(f).transpose());
    high = high.cwiseMax(points.row(f).transpose());
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t grain = order.size() > kParent ? kParent : kLeaf;
  std::size_t half = std::max(grain, (order.size() / 2 + grain / 2) / grain * grain);
  half = std::min(half, (order.size() - 1) / grain * grain);
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::int32_t a, std::int32_t b) {
                     const double pa = points(a, axis), pb = points(b, axis);
                     return pa < pb || (pa == pb && a < b);
                   });
  sort_compact(points, order.first(half));
  sort_compact(points, order.subspan(half));
}

// The ball about the middle of the bounding box of sorted faces [begin, begin + count).
Cluster ball(const FacesView& faces, std::size_t begin, std::size_t count) {
  Vector3 low(faces.x[begin], faces.y[begin], faces.z[begin]), high = low;
  for (std::size_t f = begin; f < begin + count; ++f) {
    const Vector3 p(faces.x[f], faces.y[f], faces.z[f]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vector3 centre = 0.5 * (low + high);
  double radius = 0.0;
  for (std::size_t f = begin; f < begin + count; ++f) {
    const Vector3 p(faces.x[f], faces.y[f], faces.z[f]);
    radius = std::max(radius, (p - centre).norm());
  }
  return {{centre.x(), centre.y(), centre.z()}, radius};
}

}  // namespace

SortedFaces::SortedFaces(const SurfaceFaces& faces) {
  for (Eigen::Index f = 0; f < faces.count(); ++f) {
    if (faces.areas[f] > 0.0) order_.push_back(static_cast<std::int32_t>(f));
  }
  sort_compact(faces.centroids, order_);
  const auto push = [&](Eigen::Index f, double area) {
    x_.push_back(faces.centroids(f, 0));
    y_.push_back(faces.centroids(f, 1));
    z_.push_back(faces.centroids(f, 2));
    nx_.push_back(faces.normals(f, 0));
    ny_.push_back(faces.normals(f, 1));
    nz_.push_back(faces.normals(f, 2));
    area_.push_back(area);
  };
  for (const std::int32_t f : order_) push(f, faces.areas[f]);
  while (area_.size() % kLargestGroup != 0) {
    push(order_.back(), 0.0);
    order_.push_back(order_.back());
  }

  const FacesView view = this->faces();
  const std::size_t count = area_.size();
  for (std::size_t begin = 0; begin < count; begin += kParent) {
    parents_.push_back(ball(view, begin, std::min(count, begin + kParent) - begin));
  }
  for (std::size_t begin = 0; begin < count; begin += kLeaf) {
    leaves_.push_back(ball(view, begin, std::min(count, begin + kLeaf) - begin));
  }
}

FacesView SortedFaces::faces() const {
  return {x_.data(), y_.data(), z_.data(), nx_.data(), ny_.data(), nz_.data(), area_.data()};
}

ClustersView SortedFaces::clusters() const {
  return {parents_.data(), leaves_.data(), static_cast<std::int32_t>(parents_.size()),
          static_cast<std::int32_t>(leaves_.size()), static_cast<std::int32_t>(area_.size())};
}

FieldView field_view(const geometry::DistanceField& field) {
  const geometry::CubicSplineGrid& spline = field.spline();
  FieldView v{};
  v.coefficients = spline.coefficients.data();
  v.border_nodes = field.border_nodes().data();
  v.border_cells = field.border_cells().data();
  v.row = spline.nodes[0];
  v.plane = static_cast<std::int64_t>(spline.nodes[0]) * spline.nodes[1];
  v.inverse_spacing = 1.0 / spline.spacing;
  // Half a cell's diagonal at a slope of 1.1, and half a spacing for what a coefficient differs from
  // the distance by where that has a crease.
  v.near = static_cast<float>((1.1 * 0.5 * std::sqrt(3.0) + 0.5) * spline.spacing);
  for (int a = 0; a < 3; ++a) {
    v.offset[a] = -spline.origin[a] * v.inverse_spacing;
    v.last[a] = std::nextafter(spline.nodes[static_cast<std::size_t>(a)] - 2.0, 0.0);
  }
  return v;
}

}  // namespace condyle::contact::fast
