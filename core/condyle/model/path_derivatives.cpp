// SPDX-License-Identifier: Apache-2.0
// Length, gradient and Hessian of a path: first in its motions (axes of the model, slides of moving
// points, sideways motions of free nodes), then by the chain rule in coordinates.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "condyle/model/path.hpp"
#include "condyle/model/path_route.hpp"

namespace condyle::model {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void require_size(const Path& path, const char* what, Eigen::Index is, std::size_t must_be) {
  if (is == static_cast<Eigen::Index>(must_be)) return;
  throw std::invalid_argument(path.owner() + ": " + what + " has " + std::to_string(is) +
                              " entries: must have " + std::to_string(must_be));
}

/// The node's own motions in its body, the outermost ones: slides.
void add_slides(const Path& path, const Kinematics& kinematics, const PathNode& node, double sign,
                std::vector<MotionStep>& steps) {
  if (node.free >= 0) {
    const int first = path.first_free_motion() + 2 * node.free;
    for (int k = 0; k < 2; ++k) steps.push_back({first + k, node.sideways[k], Vector3::Zero()});
    return;
  }
  if (node.point < 0) return;
  const PathPoint& point = path.points()[at(node.point)];
  if (point.motion < 0) return;
  const Matrix3& R = kinematics.X_GB(path.bodies()[at(node.slot)]).R;
  for (int k = 0; k < 3; ++k) {
    if (point.moving[at(k)].empty()) continue;
    steps.push_back({point.motion + k, sign * R.col(k), Vector3::Zero()});
  }
}

/// How a node moves as seen from the body in slot `from`, nearest motion first.
void add_chain(const Path& path, const Kinematics& kinematics, int from, const PathNode& node,
               std::vector<MotionStep>& steps) {
  const auto axes = kinematics.axes();
  for (const Path::ChainStep& link : path.chain(from, node.slot)) {
    const AxisNow& axis = axes[at(link.axis)];
    const Vector3 direction = link.sign * axis.direction;
    if (axis.rotational) {
      steps.push_back({link.motion, direction.cross(Vector3(node.p_G - axis.point)), direction});
    } else {
      steps.push_back({link.motion, direction, Vector3::Zero()});
    }
  }
  add_slides(path, kinematics, node, 1.0, steps);
}

/// ∂L += by_end · velocity, for one end of a span.
void add_gradient(const std::vector<MotionStep>& steps, const Vector3& by_end, PathWorkspace& w) {
  for (const MotionStep& step : steps) w.motion_gradient[step.motion] += by_end.dot(step.velocity);
}

void add_entry(int i, int j, double value, PathWorkspace& w) {
  w.motion_hessian(i, j) += value;
  if (i != j) w.motion_hessian(j, i) += value;
}

/// ∂²L of one end: velocityᵀ·curvature·velocity, and the turning of a further motion's velocity by
/// a nearer one.
void add_end(const std::vector<MotionStep>& steps, const Vector3& by_end, const Matrix3& curvature,
             PathWorkspace& w) {
  for (std::size_t j = 0; j < steps.size(); ++j) {
    const MotionStep& further = steps[j];
    const bool wanted = w.wanted[at(further.motion)] != 0;
    const Vector3 bent = curvature * further.velocity;
    const Vector3 swung = further.velocity.cross(by_end);  // by·(ω × v) = ω·(v × by)
    for (std::size_t i = 0; i <= j; ++i) {
      const MotionStep& nearer = steps[i];
      if (!wanted && w.wanted[at(nearer.motion)] == 0) continue;
      add_entry(nearer.motion, further.motion, nearer.velocity.dot(bent) + nearer.turn.dot(swung),
                w);
    }
  }
}

/// ∂²L between the two ends of a span around a cylinder: both orders of a pair of motions.
void add_cross(const Matrix3& ab, PathWorkspace& w) {
  for (const MotionStep& b : w.steps_b) {
    const bool wanted = w.wanted[at(b.motion)] != 0;
    const Vector3 bent = ab * b.velocity;
    for (const MotionStep& a : w.steps_a) {
      if (!wanted && w.wanted[at(a.motion)] == 0) continue;
      const double value = a.velocity.dot(bent);
      w.motion_hessian(a.motion, b.motion) += value;
      w.motion_hessian(b.motion, a.motion) += value;
    }
  }
}

void add_straight(const Path& path, const Kinematics& kinematics, const PathSpan& span, bool second,
                  PathWorkspace& w) {
  const PathNode &a = w.nodes[at(span.a)], &b = w.nodes[at(span.b)];
  w.steps_b.clear();
  // Measured from a's point: its own slides count backwards and come first.
  add_slides(path, kinematics, a, -1.0, w.steps_b);
  add_chain(path, kinematics, a.slot, b, w.steps_b);
  // Two points on one place have no direction between them: a kink that nothing can be said about.
  if (w.steps_b.empty() || span.length <= 0.0) return;
  const Vector3 u = (b.p_G - a.p_G) / span.length;
  add_gradient(w.steps_b, u, w);
  if (!second) return;
  const Matrix3 curvature = (Matrix3::Identity() - u * u.transpose()) / span.length;
  add_end(w.steps_b, u, curvature, w);
}

void add_around(const Path& path, const Kinematics& kinematics, const PathSpan& span, bool second,
                PathWorkspace& w) {
  const PathCylinder& cylinder = path.cylinders()[at(span.cylinder)];
  const Matrix3& R = w.X_GC[at(span.cylinder)].R;
  w.steps_a.clear();
  w.steps_b.clear();
  add_chain(path, kinematics, cylinder.slot, w.nodes[at(span.a)], w.steps_a);
  add_chain(path, kinematics, cylinder.slot, w.nodes[at(span.b)], w.steps_b);
  const Vector3 by_a = R * span.line.by_a, by_b = R * span.line.by_b;
  add_gradient(w.steps_a, by_a, w);
  add_gradient(w.steps_b, by_b, w);
  if (!second) return;
  const CylinderCurvature c =
      line_curvature(cylinder.surface.radius, span.a_C, span.b_C, span.line);
  add_end(w.steps_a, by_a, R * c.aa * R.transpose(), w);
  add_end(w.steps_b, by_b, R * c.bb * R.transpose(), w);
  add_cross(R * c.ab * R.transpose(), w);
}

/// The free nodes follow so that the length stays stationary: H − H_f H_ff⁻¹ H_fᵀ, one motion after
/// the other.
void eliminate_free(const Path& path, PathWorkspace& w) {
  for (int f = path.first_free_motion() + 2 * w.n_free - 1; f >= path.first_free_motion(); --f) {
    const double pivot = w.motion_hessian(f, f);
    if (!(pivot > 0.0)) continue;  // never for a taut line
    for (int i = 0; i < f; ++i) {
      const double factor = w.motion_hessian(i, f) / pivot;
      for (int j = 0; j < f; ++j) w.motion_hessian(i, j) -= factor * w.motion_hessian(f, j);
    }
  }
}

/// Terms of the motions that the path has now.
void collect_terms(const Path& path, const Kinematics& kinematics, PathWorkspace& w) {
  w.terms.clear();
  for (std::size_t i = 0; i < path.axes().size(); ++i) {
    for (const TermNow& term : kinematics.terms(path.axes()[i])) {
      w.terms.push_back({static_cast<int>(i), path.coordinate_index(term.coordinate), term.slope,
                         term.curvature});
    }
  }
  for (const PathPoint& point : path.points()) {
    if (point.motion < 0) continue;
    for (int k = 0; k < 3; ++k) {
      for (const auto& term : point.moving[at(k)]) {
        const auto f = term.function(kinematics.q()[term.coordinate]);
        const CoordinateNow& c = kinematics.coordinate(term.coordinate);
        w.terms.push_back({point.motion + k, path.coordinate_index(c.independent), f[1] * c.slope,
                           f[2] * c.slope * c.slope + f[1] * c.curvature});
      }
    }
  }
}

void add_spans(const Path& path, const Kinematics& kinematics, bool second, PathWorkspace& w) {
  const Eigen::Index n = path.n_motions();
  w.motion_gradient.head(n).setZero();
  if (second) w.motion_hessian.topLeftCorner(n, n).setZero();
  for (const PathSpan& span : w.spans) {
    if (span.cylinder < 0) {
      add_straight(path, kinematics, span, second, w);
    } else {
      add_around(path, kinematics, span, second, w);
    }
  }
  if (second) eliminate_free(path, w);
}

void gradient_by_coordinates(const PathWorkspace& w, Eigen::Ref<Eigen::VectorXd> gradient) {
  gradient.setZero();
  for (const MotionTerm& term : w.terms) {
    gradient[term.coordinate] += w.motion_gradient[term.motion] * term.slope;
  }
}

}  // namespace

double Path::length(const Kinematics& kinematics, PathWorkspace& workspace,
                    const PathSnapshot* held) const {
  lay_path(*this, kinematics, workspace, held);
  return workspace.length;
}

double Path::gradient(const Kinematics& kinematics, PathWorkspace& workspace,
                      Eigen::Ref<Eigen::VectorXd> gradient, const PathSnapshot* held) const {
  require_size(*this, "the gradient", gradient.size(), coordinates_.size());
  lay_path(*this, kinematics, workspace, held);
  add_spans(*this, kinematics, false, workspace);
  collect_terms(*this, kinematics, workspace);
  gradient_by_coordinates(workspace, gradient);
  return workspace.length;
}

double Path::hessian(const Kinematics& kinematics, PathWorkspace& workspace,
                     std::span<const int> columns, Eigen::Ref<Eigen::VectorXd> gradient,
                     Eigen::Ref<Eigen::MatrixXd> hessian, const PathSnapshot* held) const {
  require_size(*this, "the gradient", gradient.size(), coordinates_.size());
  require_size(*this, "a column of the Hessian", hessian.rows(), coordinates_.size());
  require_size(*this, "a row of the Hessian", hessian.cols(), columns.size());
  lay_path(*this, kinematics, workspace, held);
  collect_terms(*this, kinematics, workspace);

  std::fill(workspace.column.begin(), workspace.column.end(), -1);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const int index = coordinate_index(columns[c]);
    if (index >= 0) workspace.column[at(index)] = static_cast<int>(c);
  }
  std::fill(workspace.wanted.begin(), workspace.wanted.end(), char{0});
  for (int f = free_motion_; f < n_motions(); ++f) workspace.wanted[at(f)] = 1;
  for (const MotionTerm& term : workspace.terms) {
    if (workspace.column[at(term.coordinate)] >= 0) workspace.wanted[at(term.motion)] = 1;
  }

  add_spans(*this, kinematics, true, workspace);
  gradient_by_coordinates(workspace, gradient);
  hessian.setZero();
  for (const MotionTerm& by : workspace.terms) {
    const int c = workspace.column[at(by.coordinate)];
    if (c < 0) continue;
    hessian(by.coordinate, c) += workspace.motion_gradient[by.motion] * by.curvature;
    for (const MotionTerm& of : workspace.terms) {
      hessian(of.coordinate, c) +=
          of.slope * workspace.motion_hessian(of.motion, by.motion) * by.slope;
    }
  }
  return workspace.length;
}

PathSnapshot Path::snapshot(const Kinematics& kinematics, PathWorkspace& workspace) const {
  lay_path(*this, kinematics, workspace, nullptr);
  PathSnapshot held;
  const auto hold = [&](int slot, const Vector3& p_G) {
    const int body = bodies_[at(slot)];
    held.points.push_back({body, kinematics.X_GB(body).inverse() * p_G});
  };
  for (const PathSpan& span : workspace.spans) {
    const PathNode &a = workspace.nodes[at(span.a)], &b = workspace.nodes[at(span.b)];
    if (a.free < 0) hold(a.slot, a.p_G);
    if (span.cylinder >= 0) {
      const int slot = cylinders_[at(span.cylinder)].slot;
      hold(slot, workspace.X_GC[at(span.cylinder)] * span.line.tangent_a);
      hold(slot, workspace.X_GC[at(span.cylinder)] * span.line.tangent_b);
      held.arc_excess += span.line.arc - (span.line.tangent_a - span.line.tangent_b).norm();
    }
    if (&span == &workspace.spans.back()) hold(b.slot, b.p_G);
  }
  return held;
}

}  // namespace condyle::model
