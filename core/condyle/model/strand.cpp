// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/strand.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace condyle::model {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }
Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// The points of a path as it is described, where they are all fixed and nothing wraps; empty
/// otherwise.
PathSnapshot fixed_points(const Path& path) {
  PathSnapshot points;
  if (!path.cylinders().empty()) return points;
  for (const PathPoint& point : path.points()) {
    if (point.motion >= 0 || point.condition_coordinate >= 0) return {};
    points.points.push_back({path.bodies()[at(point.slot)], point.location});
  }
  return points;
}

void require_size(const char* what, Eigen::Index is, Eigen::Index must_be) {
  if (is == must_be) return;
  throw std::invalid_argument(std::string("ligament strands: ") + what + " is " +
                              std::to_string(is) + ": must be " + std::to_string(must_be));
}

}  // namespace

Strands::Strands(const Model& model)
    : n_bodies_(model.n_bodies()), n_axes_(model.n_axes()), n_coordinates_(model.n_coordinates()) {
  pair_index_.assign(at(n_bodies_ + 1) * at(n_bodies_ + 1), -1);
  for (const LigamentDescription& from : model.description().ligaments) {
    const std::string owner = "ligament '" + from.name + "'";
    const LigamentForceLaw law = force_law(from);
    require_valid(law, owner);
    strands_.push_back({from.name, law, Path(model, from.path, owner)});
    const Path& path = strands_.back().path;
    const int n = static_cast<int>(path.bodies().size());
    for (int s = 0; s < n; ++s) {
      for (int t = 0; t < n; ++t) {
        const int a = path.bodies()[at(s)], b = path.bodies()[at(t)];
        if (a >= b || path.chain(s, t).empty() || pair(a, b) >= 0) continue;
        pair_index_[at(a + 1) * at(n_bodies_ + 1) + at(b + 1)] = static_cast<int>(pairs_.size());
        pairs_.push_back({a, b, path.chain(s, t)});
      }
    }
  }
}

std::vector<std::string> Strands::wraps_ignored() const {
  std::vector<std::string> ignored;
  for (const Strand& strand : strands_) {
    for (const std::string& wrap : strand.path.wraps_ignored()) {
      ignored.push_back(strand.name + ": " + wrap);
    }
  }
  return ignored;
}

int Strands::pair(int body_a, int body_b) const {
  return pair_index_[at(body_a + 1) * at(n_bodies_ + 1) + at(body_b + 1)];
}

double Strands::energy(const StrandWorkspace& workspace) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    sum += model::energy(strands_[i].law, workspace.length[index(i)]);
  }
  return sum;
}

// Tension of strand i from its length and velocity; returns it, and leaves its derivative by length
// in by_length_.
double Strands::tension_of(std::size_t i, StrandWorkspace& w, StrandDamping damping) const {
  const Eigen::Index k = index(i);
  const LigamentForceLaw& law = strands_[i].law;
  LigamentTension t = tension(law, w.length[k]);
  if (damping == StrandDamping::kBlankevoort) {
    const LigamentDamping d = model::damping(law, w.length[k], w.velocity[k]);
    t.force += d.force;
    t.by_length += d.by_length;
  }
  w.strain[k] = t.strain;
  w.force[k] = t.force;
  w.by_length_[k] = t.by_length;
  return t.force;
}

void Strands::sum_straight(const Kinematics& kinematics, StrandWorkspace& w, bool second,
                           StrandDamping damping) const {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    StrandWorkspace::PairSums& sums = w.sums_[p];
    const RigidTransform &X_GA = kinematics.X_GB(pairs_[p].body_a),
                         &X_GB = kinematics.X_GB(pairs_[p].body_b);
    const auto A = kinematics.twist(pairs_[p].body_a), B = kinematics.twist(pairs_[p].body_b);
    const Matrix3 R_AG = X_GA.R.transpose();
    sums.R_AB = R_AG * X_GB.R;
    sums.p_AB = R_AG * (X_GB.p - X_GA.p);
    const Vector3 turning = B.w - A.w;
    sums.w = R_AG * turning;
    sums.v = R_AG * (B.v - A.v + turning.cross(X_GB.p));
    sums.force.setZero();
    sums.moment.setZero();
    sums.virial.setZero();
    sums.stiffness.setZero();
    sums.used = false;
  }
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    const StrandWorkspace::Line& line = w.lines_[i];
    if (line.pair < 0) continue;
    StrandWorkspace::PairSums& sums = w.sums_[at(line.pair)];
    const Vector3 r = sums.R_AB * line.b;
    const Vector3 d = r + sums.p_AB - line.a;
    const double run = d.norm(), inverse = run > 0.0 ? 1.0 / run : 0.0;
    const Vector3 u = inverse * d;
    w.length[index(i)] = run + line.fixed;
    w.velocity[index(i)] = u.dot(sums.v + sums.w.cross(r));
    const double F = tension_of(i, w, damping);
    if (F == 0.0 && w.by_length_[index(i)] == 0.0) continue;
    sums.used = true;
    const Vector3 arm = r.cross(u);
    sums.force += F * u;
    sums.moment += F * arm;
    if (!second) continue;
    sums.virial += (F * r) * u.transpose();
    // D = α 1 + β u uᵀ gives Jᵀ D J = α JᵀJ + β (u, r×u)(u, r×u)ᵀ; only the upper triangle is
    // summed.
    const double alpha = F * inverse, beta = w.by_length_[index(i)] - alpha;
    Vector6 wrench;
    wrench << u, arm;
    Matrix6& S = sums.stiffness;
    for (int row = 0; row < 6; ++row) {
      const double scaled = beta * wrench[row];
      for (int column = row; column < 6; ++column) S(row, column) += scaled * wrench[column];
    }
    const Vector3 ar = alpha * r;
    S(0, 0) += alpha, S(1, 1) += alpha, S(2, 2) += alpha;
    S(0, 4) += ar.z(), S(0, 5) -= ar.y();
    S(1, 3) -= ar.z(), S(1, 5) += ar.x();
    S(2, 3) += ar.y(), S(2, 4) -= ar.x();
    S(3, 3) += ar.y() * r.y() + ar.z() * r.z(), S(3, 4) -= ar.x() * r.y(),
        S(3, 5) -= ar.x() * r.z();
    S(4, 4) += ar.x() * r.x() + ar.z() * r.z(), S(4, 5) -= ar.y() * r.z();
    S(5, 5) += ar.x() * r.x() + ar.y() * r.y();
  }
}

void Strands::project_pairs(const Kinematics& kinematics, StrandWorkspace& w, bool second) const {
  w.axis_force_.setZero();
  if (second) w.axis_hessian_.setZero();
  const auto axes = kinematics.axes();
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const StrandWorkspace::PairSums& sums = w.sums_[p];
    if (!sums.used) continue;
    const auto& chain = pairs_[p].chain;
    const Matrix3 R_AG = kinematics.X_GB(pairs_[p].body_a).R.transpose();
    const Vector3& origin = kinematics.X_GB(pairs_[p].body_b).p;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const AxisNow& axis = axes[at(chain[k].axis)];
      const Vector3 direction = R_AG * (chain[k].sign * axis.direction);
      if (axis.rotational) {
        w.chain_w_[k] = direction;
        w.chain_v_[k] = direction.cross(R_AG * (origin - axis.point));
      } else {
        w.chain_w_[k].setZero();
        w.chain_v_[k] = direction;
      }
      w.axis_force_[chain[k].axis] -=
          sums.force.dot(w.chain_v_[k]) + sums.moment.dot(w.chain_w_[k]);
    }
    if (!second) continue;
    const double trace = sums.virial.trace();
    for (std::size_t j = 0; j < chain.size(); ++j) {
      const bool wanted = w.axis_wanted_[at(chain[j].axis)] != 0;
      Vector6 twist;
      twist << w.chain_v_[j], w.chain_w_[j];
      const Vector6 bent = sums.stiffness.selfadjointView<Eigen::Upper>() * twist;
      // What the nearer axis does to this one's velocity: Σ F u·(ω_i × (v_j + ω_j × r)).
      const Vector3 swung =
          w.chain_v_[j].cross(sums.force) + sums.virial * w.chain_w_[j] - trace * w.chain_w_[j];
      const Vector3 by_w = bent.tail<3>() + swung, by_v = bent.head<3>();
      for (std::size_t i = 0; i <= j; ++i) {
        if (!wanted && w.axis_wanted_[at(chain[i].axis)] == 0) continue;
        const double value = w.chain_v_[i].dot(by_v) + w.chain_w_[i].dot(by_w);
        w.axis_hessian_(chain[i].axis, chain[j].axis) += value;
        if (i != j) w.axis_hessian_(chain[j].axis, chain[i].axis) += value;
      }
    }
  }
}

void Strands::add_other(const Kinematics& kinematics, StrandWorkspace& w,
                        Eigen::Ref<Eigen::VectorXd> tau, Eigen::Ref<Eigen::MatrixXd>* stiffness,
                        StrandDamping damping) const {
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    if (w.lines_[i].pair >= 0) continue;
    const Path& path = strands_[i].path;
    auto gradient = w.gradient_.head(path.n_coordinates());
    auto hessian = w.hessian_.topLeftCorner(path.n_coordinates(), index(w.columns_.size()));
    if (stiffness) {
      w.length[index(i)] =
          path.hessian(kinematics, w.path_, w.columns_, gradient, hessian, w.held_[i]);
    } else {
      w.length[index(i)] = path.gradient(kinematics, w.path_, gradient, w.held_[i]);
    }
    w.velocity[index(i)] = path.velocity(kinematics, gradient);
    const double F = tension_of(i, w, damping), by_length = w.by_length_[index(i)];
    if (F == 0.0 && by_length == 0.0) continue;
    for (int k = 0; k < path.n_coordinates(); ++k) {
      tau[path.coordinates()[at(k)]] -= F * gradient[k];
    }
    if (!stiffness) continue;
    for (std::size_t c = 0; c < w.columns_.size(); ++c) {
      const int own = path.coordinate_index(w.columns_[c]);
      if (own < 0) continue;
      for (int k = 0; k < path.n_coordinates(); ++k) {
        (*stiffness)(path.coordinates()[at(k)], index(c)) -=
            by_length * gradient[k] * gradient[own] + F * hessian(k, index(c));
      }
    }
  }
}

void Strands::add(const Kinematics& kinematics, StrandWorkspace& w, Eigen::Ref<Eigen::VectorXd> tau,
                  Eigen::Ref<Eigen::MatrixXd>* stiffness, StrandDamping damping) const {
  require_size("the number of generalised forces", tau.size(), n_coordinates_);
  const bool second = stiffness != nullptr;
  sum_straight(kinematics, w, second, damping);
  project_pairs(kinematics, w, second);
  add_other(kinematics, w, tau, stiffness, damping);
  for (const TermNow& of : kinematics.terms()) {
    tau[of.coordinate] += w.axis_force_[of.axis] * of.slope;
  }
  if (!second) return;
  for (const TermNow& by : kinematics.terms()) {
    const int c = w.column_of_coordinate_[at(by.coordinate)];
    if (c < 0) continue;
    (*stiffness)(by.coordinate, c) += w.axis_force_[by.axis] * by.curvature;
    const double slope = by.slope;
    for (const TermNow& of : kinematics.terms()) {
      (*stiffness)(of.coordinate, c) -= of.slope * w.axis_hessian_(of.axis, by.axis) * slope;
    }
  }
}

void Strands::add_forces(const Kinematics& kinematics, StrandWorkspace& workspace,
                         Eigen::Ref<Eigen::VectorXd> tau, StrandDamping damping) const {
  add(kinematics, workspace, tau, nullptr, damping);
}

void Strands::add_forces_and_stiffness(const Kinematics& kinematics, StrandWorkspace& workspace,
                                       Eigen::Ref<Eigen::VectorXd> tau,
                                       Eigen::Ref<Eigen::MatrixXd> stiffness,
                                       StrandDamping damping) const {
  require_size("the number of the stiffness's rows", stiffness.rows(), n_coordinates_);
  require_size("the number of the stiffness's columns", stiffness.cols(),
               index(workspace.columns_.size()));
  // Axes that a column moves are wanted; which those are does not change, so they are found once.
  if (workspace.axis_wanted_.empty()) {
    workspace.axis_wanted_.assign(at(n_axes_), 0);
    for (const TermNow& term : kinematics.terms()) {
      if (workspace.column_of_coordinate_[at(term.coordinate)] < 0) continue;
      workspace.axis_wanted_[at(term.axis)] = 1;
    }
  }
  add(kinematics, workspace, tau, &stiffness, damping);
}

StrandWorkspace::StrandWorkspace(const Strands& strands, std::span<const int> columns)
    : strands_(&strands), columns_(columns.begin(), columns.end()) {
  const auto n = strands.strands_.size();
  column_of_coordinate_.assign(at(strands.n_coordinates_), -1);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c] < 0 || columns_[c] >= strands.n_coordinates_) {
      throw std::invalid_argument("ligament strands: column " + std::to_string(c) +
                                  " is coordinate " + std::to_string(columns_[c]) +
                                  ": must be 0 to " + std::to_string(strands.n_coordinates_ - 1));
    }
    column_of_coordinate_[at(columns_[c])] = static_cast<int>(c);
  }
  for (Eigen::VectorXd* v : {&length, &velocity, &strain, &force, &by_length_}) {
    v->setZero(index(n));
  }
  lines_.resize(n);
  held_.assign(n, nullptr);
  sums_.resize(strands.pairs_.size());
  int longest = 0, most = 0;
  for (const Strand& strand : strands.strands_) {
    path_.reserve(strand.path, 0);
    most = std::max(most, strand.path.n_coordinates());
  }
  for (const auto& pair : strands.pairs_) {
    longest = std::max(longest, static_cast<int>(pair.chain.size()));
  }
  chain_v_.resize(at(longest));
  chain_w_.resize(at(longest));
  axis_force_.setZero(strands.n_axes_);
  axis_hessian_.setZero(strands.n_axes_, strands.n_axes_);
  gradient_.setZero(most);
  hessian_.setZero(most, index(columns_.size()));
  for (std::size_t i = 0; i < n; ++i) make_line(fixed_points(strands.strands_[i].path), lines_[i]);
  described_ = lines_;
}

// Whether a held path has one straight part between bodies that move to one another, and its line
// if so.
bool StrandWorkspace::make_line(const PathSnapshot& points, Line& line) const {
  line = Line{};
  line.fixed = points.arc_excess;
  int moving = 0;
  for (std::size_t i = 0; i + 1 < points.points.size(); ++i) {
    const HeldPoint *a = &points.points[i], *b = &points.points[i + 1];
    if (a->body == b->body) {
      line.fixed += (b->location - a->location).norm();
      continue;
    }
    if (a->body > b->body) std::swap(a, b);
    line.pair = strands_->pair(a->body, b->body);
    line.a = a->location;
    line.b = b->location;
    // A second such part, or two bodies that are one, is for the general way.
    if (line.pair < 0 || ++moving > 1) {
      line.pair = -1;
      return false;
    }
  }
  return line.pair >= 0;
}

void StrandWorkspace::hold(int strand, const PathSnapshot* snapshot) {
  if (strand < 0 || strand >= strands_->size()) {
    throw std::invalid_argument("ligament strands: strand " + std::to_string(strand) +
                                ": must be 0 to " + std::to_string(strands_->size() - 1));
  }
  held_[at(strand)] = snapshot;
  lines_[at(strand)] = described_[at(strand)];
  if (!snapshot) return;
  const Path& path = (*strands_)[strand].path;
  for (const HeldPoint& point : snapshot->points) held_slot(path, point);
  path_.reserve(path, snapshot->points.size());
  make_line(*snapshot, lines_[at(strand)]);
}

void StrandWorkspace::hold(const PathSnapshots& snapshots, std::size_t time_frame) {
  for (int i = 0; i < strands_->size(); ++i) {
    hold(i, snapshots.find((*strands_)[i].name, time_frame));
  }
}

}  // namespace condyle::model
