// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/distance_octree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace condyle::geometry {
namespace {

// The root reaches this many times the surface's half extent from its middle: a far cell costs next
// to nothing, and a contact far out of touch should not search.
constexpr double kReach = 16.0;
// Cells on the inner side are divided only this deep: most overlaps stay below, a deeper point may
// take a search.
constexpr double kListedDepth = 1.5e-3;  // [m]
// Few enough candidates to try them all; fewer would cost more cells than they save.
constexpr int kShortList = 12;
// Smallest half side of a cell. A fraction of a usual face (0.5–1.5 mm): below it lists do not get
// shorter.
constexpr double kFinestHalfSide = 1.5e-4;  // [m]
// A cell farther than this that cannot be told outside is given up when it is so much smaller than
// its distance.
constexpr double kNear = 4e-3;  // [m]
constexpr double kFarRatio = 1.0 / 12.0;
// Beyond this distance, where no insert is while it can be in touch, cells stay coarser.
constexpr double kFar = 0.04;  // [m]
constexpr double kVeryFarRatio = 1.0 / 3.0;
// So many triangles at most are tested one by one.
constexpr std::size_t kFewForExact = 256;
// Plane and distance tests must beat rounding: coordinates of up to 1 m and a handful of operations
// each.
constexpr double kRounding = 1e-14;  // [m]

}  // namespace

struct DistanceOctree::Builder {
  explicit Builder(const SurfaceFeatures& surface_in, DistanceOctree& octree_in)
      : surface(surface_in), octree(octree_in) {}

  // Candidates of a cell out of its parent's: first with the triangles as balls about their
  // centroids, then, where few are left, with the triangles themselves. Returns a lower bound of
  // the distance from the centre to the surface.
  double select(const Vector3& centre, double h, std::span<const std::int32_t> parent,
                std::vector<std::int32_t>& own) {
    away.resize(parent.size());
    near.resize(parent.size());
    double lower = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < parent.size(); ++i) {
      const Ball& ball = surface.ball(parent[i]);
      away[i] = centre - ball.centre;
      near[i] = away[i].norm();
      lower = std::min(lower, near[i] - ball.radius);
    }
    own.assign(parent.begin(), parent.end());
    keep_possible(h, own, [this](std::int32_t f) { return surface.ball(f).radius; });
    if (own.size() > kFewForExact) return lower;

    for (std::size_t i = 0; i < own.size(); ++i) {
      away[i] = centre - closest_point(centre, surface.triangle(own[i])).point;
      near[i] = away[i].norm();
    }
    lower = *std::min_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(own.size()));
    keep_possible(h, own, [](std::int32_t) { return 0.0; });
    return lower - kRounding;
  }

  // Drops from `own` what cannot be closest to any point centre + δ, |δ| <= h, of the cell. With
  // away[i] = centre − x of some point x such that the triangle lies, up to radius(i), behind the
  // plane through x across away[i]: the triangle is at least near[i] + u·δ − radius(i) away from
  // centre + δ, u the direction of away[i]. The nearest x, a point of the surface, is at most near
  // + u·δ + h²/(2 near) away, and also near + |δ|.
  template <typename Radius>
  void keep_possible(double h, std::vector<std::int32_t>& own, Radius radius) {
    const auto end = near.begin() + static_cast<std::ptrdiff_t>(own.size());
    const auto closest =
        static_cast<std::size_t>(std::min_element(near.begin(), end) - near.begin());
    const double distance = near[closest];
    const Vector3 direction = away[closest] / distance;
    const double bend =
        0.5 * h * h / distance;  // infinite on the surface: the first test alone decides
    std::size_t kept = 0;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double excess = near[i] - radius(own[i]) - distance - kRounding;
      if (excess > 2.0 * h) continue;
      if (excess > bend && excess > bend + h * (direction - away[i] / near[i]).norm()) continue;
      near[kept] = near[i];
      own[kept++] = own[i];
    }
    own.resize(kept);
  }

  // Which side of all its candidates' planes the ball (centre, h) is on: +1 outer, −1 inner, 0
  // neither.
  int side(const Vector3& centre, double h, const std::vector<std::int32_t>& own) const {
    bool outer = true, inner = true;
    for (const std::int32_t f : own) {
      const double height = surface.face_normal(f).dot(centre - surface.triangle(f).a);
      outer = outer && height > h + kRounding;
      inner = inner && height < -h - kRounding;
      if (!outer && !inner) return 0;
    }
    return outer ? 1 : -1;
  }

  void leaf(std::size_t node, const std::vector<std::int32_t>& own) {
    octree.nodes_[node].kind = CellKind::kCandidates;
    octree.nodes_[node].first = static_cast<std::int32_t>(octree.candidates_.size());
    octree.nodes_[node].count = static_cast<std::int32_t>(own.size());
    // Nearest to the centre first: a search then mostly finds the closest at once, and passes the
    // rest by.
    std::vector<std::pair<double, std::int32_t>> order;
    for (std::size_t i = 0; i < own.size(); ++i) order.emplace_back(near[i], own[i]);
    std::sort(order.begin(), order.end());
    for (const auto& [distance, face] : order) octree.candidates_.push_back(face);
  }

  void build(std::size_t node, const Vector3& centre, double half,
             std::span<const std::int32_t> parent) {
    const double h = half * std::sqrt(3.0);
    std::vector<std::int32_t> own;
    const double distance = select(centre, h, parent, own);
    const int where = side(centre, h, own);
    if (where > 0) {
      octree.nodes_[node].kind = CellKind::kOutside;
      return;
    }
    if (static_cast<int>(own.size()) <= kShortList) return leaf(node, own);
    const bool deep = where < 0 && distance - h > kListedDepth;
    const double ratio = distance > kFar ? kVeryFarRatio : kFarRatio;
    if (deep || (distance > kNear && half < ratio * distance)) return;  // kUnknown
    if (half < 2.0 * kFinestHalfSide) return leaf(node, own);

    const auto first = octree.nodes_.size();
    octree.nodes_[node].first_child = static_cast<std::int32_t>(first);
    octree.nodes_.resize(first + 8);
    for (std::size_t child = 0; child < 8; ++child) {
      const Vector3 towards((child & 1) != 0 ? 1.0 : -1.0, (child & 2) != 0 ? 1.0 : -1.0,
                            (child & 4) != 0 ? 1.0 : -1.0);
      build(first + child, centre + 0.5 * half * towards, 0.5 * half, own);
    }
  }

  const SurfaceFeatures& surface;
  DistanceOctree& octree;
  std::vector<double> near;
  std::vector<Vector3> away;
};

DistanceOctree::DistanceOctree(const SurfaceFeatures& surface) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  std::vector<std::int32_t> all(static_cast<std::size_t>(surface.face_count()));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    all[static_cast<std::size_t>(f)] = f;
    const Triangle& t = surface.triangle(f);
    low = low.cwiseMin(t.a).cwiseMin(t.b).cwiseMin(t.c);
    high = high.cwiseMax(t.a).cwiseMax(t.b).cwiseMax(t.c);
  }
  centre_ = 0.5 * (low + high);
  half_side_ = kReach * 0.5 * (high - low).maxCoeff();
  nodes_.resize(1);
  Builder(surface, *this).build(0, centre_, half_side_, all);
}

DistanceOctree::Cell DistanceOctree::cell(const Vector3& p) const {
  if (!((p - centre_).cwiseAbs().maxCoeff() < half_side_)) return {};
  Vector3 centre = centre_;
  double half = half_side_;
  std::size_t node = 0;
  while (nodes_[node].first_child >= 0) {
    half *= 0.5;
    std::size_t child = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = p[axis] > centre[axis];
      child |= static_cast<std::size_t>(upper) << axis;
      centre[axis] += upper ? half : -half;
    }
    node = static_cast<std::size_t>(nodes_[node].first_child) + child;
  }
  const Node& leaf = nodes_[node];
  return {leaf.kind, {candidates_.data() + leaf.first, static_cast<std::size_t>(leaf.count)}};
}

}  // namespace condyle::geometry
