// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/path_route.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace condyle::model {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// OpenSim's ConditionalPathPoint is present this far beyond its range.
constexpr double kConditionMargin = 1e-5;
// Several cylinders: each pass shrinks the error by (radius/distance)² or so; this many are never
// needed apart from cylinders that touch one another.
constexpr int kMaxPasses = 200;
constexpr double kStill = 1e-12;  // [m]

bool present(const PathPoint& point, const Eigen::VectorXd& q) {
  if (point.condition_coordinate < 0) return true;
  const double value = q[point.condition_coordinate];
  return value >= point.condition_min - kConditionMargin &&
         value <= point.condition_max + kConditionMargin;
}

PathNode node_at(const Vector3& p_G, int slot) {
  PathNode node;
  node.p_G = p_G;
  node.slot = slot;
  return node;
}

void place_points(const Path& path, const Kinematics& kinematics, PathWorkspace& w) {
  for (std::size_t i = 0; i < path.points().size(); ++i) {
    const PathPoint& point = path.points()[i];
    if (!present(point, kinematics.q())) continue;
    Vector3 location = point.location;
    if (point.motion >= 0) {
      for (int k = 0; k < 3; ++k) {
        for (const auto& term : point.moving[at(k)]) {
          location[k] += term.function(kinematics.q()[term.coordinate])[0];
        }
      }
    }
    w.nodes.push_back(
        node_at(kinematics.X_GB(path.bodies()[at(point.slot)]) * location, point.slot));
    w.nodes.back().point = static_cast<int>(i);
  }
}

void place_held(const Path& path, const Kinematics& kinematics, const PathSnapshot& held,
                PathWorkspace& w) {
  for (const HeldPoint& point : held.points) {
    const int slot = held_slot(path, point);
    w.nodes.push_back(node_at(kinematics.X_GB(point.body) * point.location, slot));
  }
}

/// What a cylinder does to a path: which segment goes around it.
struct Choice {
  CylinderContact contact = CylinderContact::kMisses;  // of the last segment looked at
  int segment = -1;
  int turn = 0;
  Vector3 tangent_a, tangent_b;  // in ground
};

Choice choose_segment(const PathCylinder& cylinder, const RigidTransform& X_GC,
                      const RigidTransform& X_CG, const std::vector<PathNode>& nodes) {
  Choice choice;
  // The range is over the points of the description, absent ones included.
  int start = -1, end = -1;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    const int point = nodes[at(i)].point;
    if (point < cylinder.first_point || point > cylinder.last_point) continue;
    if (start < 0) start = i;
    end = i;
  }
  double least = std::numeric_limits<double>::infinity();
  for (int i = start; i >= 0 && i < end; ++i) {
    const PathNode &from = nodes[at(i)], &to = nodes[at(i + 1)];
    if (from.cylinder >= 0 && from.cylinder == to.cylinder) continue;  // lies on another surface
    const Vector3 a = X_CG * from.p_G, b = X_CG * to.p_G;
    const CylinderDecision decision = decide_wrap(cylinder.surface, a, b);
    choice.contact = decision.contact;
    if (!decision.goes_around()) continue;
    const CylinderLine line = line_around(cylinder.surface.radius, a, b, decision.turn);
    const bool pierces = decision.contact == CylinderContact::kPierces;
    const double longer = line.length - (b - a).norm();
    if (!pierces && longer >= least) continue;
    least = longer;
    choice.segment = i;
    choice.turn = decision.turn;
    choice.tangent_a = X_GC * line.tangent_a;
    choice.tangent_b = X_GC * line.tangent_b;
    if (pierces) break;
  }
  return choice;
}

void remove_tangents(int cylinder, std::vector<PathNode>& nodes) {
  std::erase_if(nodes, [cylinder](const PathNode& node) { return node.cylinder == cylinder; });
}

/// One pass over the cylinders in their order. @return the furthest that a tangent point moved [m].
double wrap_once(const Path& path, PathWorkspace& w) {
  double moved = 0.0;
  for (const int c : w.order) {
    const PathCylinder& cylinder = path.cylinders()[at(c)];
    remove_tangents(c, w.nodes);
    const Choice choice = choose_segment(cylinder, w.X_GC[at(c)], w.X_CG[at(c)], w.nodes);
    w.last_contact[at(c)] = static_cast<int>(choice.contact);
    Vector3 &before_a = w.previous[at(2 * c)], &before_b = w.previous[at(2 * c + 1)];
    if (choice.segment < 0) {
      if (before_a.allFinite()) moved = std::numeric_limits<double>::infinity();
      before_a.setConstant(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double step =
        std::max((choice.tangent_a - before_a).norm(), (choice.tangent_b - before_b).norm());
    moved = std::isfinite(step) ? std::max(moved, step) : std::numeric_limits<double>::infinity();
    before_a = choice.tangent_a;
    before_b = choice.tangent_b;
    PathNode tangents[2] = {node_at(choice.tangent_a, cylinder.slot),
                            node_at(choice.tangent_b, cylinder.slot)};
    for (PathNode& tangent : tangents) {
      tangent.cylinder = c;
      tangent.turn = choice.turn;
    }
    w.nodes.insert(w.nodes.begin() + choice.segment + 1, tangents, tangents + 2);
  }
  return moved;
}

void wrap_cylinders(const Path& path, const Kinematics& kinematics, PathWorkspace& w) {
  const int n = static_cast<int>(path.cylinders().size());
  w.order.clear();
  for (int c = 0; c < n; ++c) {
    const PathCylinder& cylinder = path.cylinders()[at(c)];
    w.X_GC[at(c)] = kinematics.X_GB(path.bodies()[at(cylinder.slot)]) * cylinder.X_BC;
    w.X_CG[at(c)] = w.X_GC[at(c)].inverse();
    w.previous[at(2 * c)].setConstant(std::numeric_limits<double>::quiet_NaN());
    w.previous[at(2 * c + 1)] = w.previous[at(2 * c)];
    w.order.push_back(c);
  }
  for (int pass = 0; pass < (n == 1 ? 1 : kMaxPasses); ++pass) {
    if (wrap_once(path, w) <= kStill) break;
    // As OpenSim: where the first cylinder was missed and an end lay in the second, they change
    // places.
    if (pass == 0 && n > 1 && w.last_contact[0] == static_cast<int>(CylinderContact::kMisses) &&
        w.last_contact[1] == static_cast<int>(CylinderContact::kInside)) {
      std::swap(w.order[0], w.order[1]);
      remove_tangents(0, w.nodes);
    }
  }
}

int add_free_node(const Path& path, int cylinder, const Vector3& p, const Vector3& q,
                  PathWorkspace& w) {
  PathNode node = node_at(0.5 * (p + q), path.cylinders()[at(cylinder)].slot);
  node.free = w.n_free++;
  const Vector3 along = (q - p).normalized();
  node.sideways[0] = along.unitOrthogonal();
  node.sideways[1] = along.cross(node.sideways[0]);
  w.nodes.push_back(node);
  return static_cast<int>(w.nodes.size()) - 1;
}

/// Spans over the nodes laid; free nodes are added behind them.
void make_spans(const Path& path, PathWorkspace& w) {
  const int n = static_cast<int>(w.nodes.size());
  int from = 0;
  for (int i = 0; i + 1 < n;) {
    PathSpan span;
    span.a = from;
    const int c = w.nodes[at(i + 1)].cylinder;
    if (c < 0) {
      span.b = i + 1;
      span.length = (w.nodes[at(span.b)].p_G - w.nodes[at(span.a)].p_G).norm();
      i = i + 1;
      from = i;
    } else {
      span.cylinder = c;
      span.turn = w.nodes[at(i + 1)].turn;
      const bool next_is_tangent = w.nodes[at(i + 3)].cylinder >= 0;
      span.b = next_is_tangent
                   ? add_free_node(path, c, w.nodes[at(i + 2)].p_G, w.nodes[at(i + 3)].p_G, w)
                   : i + 3;
      span.a_C = w.X_CG[at(c)] * w.nodes[at(span.a)].p_G;
      span.b_C = w.X_CG[at(c)] * w.nodes[at(span.b)].p_G;
      span.line =
          line_around(path.cylinders()[at(c)].surface.radius, span.a_C, span.b_C, span.turn);
      span.length = span.line.length;
      from = span.b;
      i = next_is_tangent ? i + 2 : i + 3;
    }
    w.length += span.length;
    w.spans.push_back(span);
  }
}

}  // namespace

void PathWorkspace::reserve(const Path& path, std::size_t n_held) {
  const std::size_t n_cylinders = path.cylinders().size();
  const std::size_t n_nodes = std::max(path.points().size(), n_held) + 3 * n_cylinders;
  nodes.reserve(n_nodes);
  spans.reserve(n_nodes);
  order.reserve(n_cylinders);
  terms.reserve(at(path.n_terms()));
  if (last_contact.size() < n_cylinders) {
    last_contact.resize(n_cylinders);
    X_GC.resize(n_cylinders);
    X_CG.resize(n_cylinders);
    previous.resize(2 * n_cylinders);
  }
  const auto n_motions = static_cast<Eigen::Index>(path.n_motions());
  if (motion_gradient.size() < n_motions) {
    motion_gradient.resize(n_motions);
    motion_hessian.resize(n_motions, n_motions);
    wanted.resize(at(path.n_motions()));
    steps_a.reserve(at(path.n_motions()));
    steps_b.reserve(at(path.n_motions()));
  }
  if (column.size() < path.coordinates().size()) column.resize(path.coordinates().size());
}

int held_slot(const Path& path, const HeldPoint& point) {
  const auto found = std::find(path.bodies().begin(), path.bodies().end(), point.body);
  if (found != path.bodies().end()) return static_cast<int>(found - path.bodies().begin());
  throw std::invalid_argument(path.owner() + ": a snapshot holds a point to body " +
                              std::to_string(point.body) +
                              ": neither the path's points nor its wraps are on that body");
}

void lay_path(const Path& path, const Kinematics& kinematics, PathWorkspace& w,
              const PathSnapshot* held) {
  w.reserve(path, held ? held->points.size() : 0);
  w.nodes.clear();
  w.spans.clear();
  w.n_free = 0;
  w.length = held ? held->arc_excess : 0.0;
  if (held) {
    place_held(path, kinematics, *held, w);
  } else {
    place_points(path, kinematics, w);
    if (!path.cylinders().empty()) wrap_cylinders(path, kinematics, w);
  }
  make_spans(path, w);
}

}  // namespace condyle::model
