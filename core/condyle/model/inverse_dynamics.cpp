// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/inverse_dynamics.hpp"

#include <Eigen/Geometry>
#include <stdexcept>
#include <string>

#include "condyle/model/model_checks.hpp"

namespace condyle::model {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

Screw screw(const Kinematics::Twist& twist) { return {twist.w, twist.v}; }

Screw scaled(const Screw& S, double factor) { return {factor * S.w, factor * S.v}; }

Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

}  // namespace

InverseDynamics::InverseDynamics(const Model& model)
    : model_(&model),
      bodies_(at(model.n_bodies())),
      S_(at(model.n_axes())),
      inertial_(at(model.n_axes())),
      external_(at(model.n_axes())),
      load_(at(model.n_axes())),
      tau_(Eigen::VectorXd::Zero(model.n_coordinates())),
      composite_(at(model.n_axes())),
      IS_(at(model.n_axes())),
      BS_(at(model.n_axes())),
      change_(at(model.n_axes())) {
  for (const BodyDescription& body : model.description().bodies) {
    const Vector6& J = body.inertia;
    Matrix3 inertia;
    inertia << J[0], J[3], J[4], J[3], J[1], J[5], J[4], J[5], J[2];
    mass_.push_back(body.mass);
    mass_centre_.push_back(body.mass_centre);
    inertia_.push_back(inertia);
  }
}

void InverseDynamics::require(std::span<const ExternalLoad> loads) const {
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const ExternalLoad& load = loads[i];
    const std::string name =
        model_label(model_->description()) + ": external load " + std::to_string(i);
    if (load.body < -1 || load.body >= model_->n_bodies()) {
      throw std::invalid_argument(name + ": body is " + std::to_string(load.body) +
                                  "; the model has bodies 0 to " +
                                  std::to_string(model_->n_bodies() - 1) + " and ground, -1");
    }
    const auto finite = [&](const char* field, const Vector3& value) {
      if (value.allFinite()) return;
      throw std::invalid_argument(name + ": " + field + " is (" + std::to_string(value.x()) + ", " +
                                  std::to_string(value.y()) + ", " + std::to_string(value.z()) +
                                  "); it must be finite");
    };
    finite("force_G", load.force_G);
    finite("point_G", load.point_G);
    finite("moment_G", load.moment_G);
  }
}

const Eigen::VectorXd& InverseDynamics::compute(const Kinematics& kinematics,
                                                std::span<const ExternalLoad> loads) {
  for (const ExternalLoad& load : loads) {
    const bool known = load.body >= -1 && load.body < model_->n_bodies();
    // The message is put together apart, so that good loads cost no allocation.
    if (!known || !load.force_G.allFinite() || !load.point_G.allFinite() ||
        !load.moment_G.allFinite()) {
      require(loads);
    }
  }
  for (int a = 0; a < model_->n_axes(); ++a) {
    S_[at(a)] = axis_screw(kinematics.axes()[at(a)]);
    inertial_[at(a)] = external_[at(a)] = {};
  }
  const Vector3& gravity = model_->description().gravity;
  for (int b = 0; b < model_->n_bodies(); ++b) {
    const int axis = model_->last_axis(b);
    if (axis < 0) continue;
    const RigidTransform& X = kinematics.X_GB(b);
    BodyNow& now = bodies_[at(b)];
    now.centre = X * mass_centre_[at(b)];
    now.inertia.noalias() = X.R * inertia_[at(b)] * X.R.transpose();
    const Kinematics::Twist& V = kinematics.axis_twist(axis);
    const Kinematics::Twist& A = kinematics.axis_twist_rate(axis);
    const Vector3 acceleration =
        A.v + A.w.cross(now.centre) + V.w.cross(Vector3(V.v + V.w.cross(now.centre)));
    const Vector3 force = mass_[at(b)] * (acceleration - gravity);
    const Vector3 moment = now.inertia * A.w + V.w.cross(Vector3(now.inertia * V.w));
    inertial_[at(axis)] += wrench_at_origin(force, now.centre, moment);
  }
  for (const ExternalLoad& load : loads) {
    const int axis = model_->last_axis(load.body);
    if (axis < 0) continue;
    external_[at(axis)] += wrench_at_origin(load.force_G, load.point_G, load.moment_G);
  }
  tau_.setZero();
  for (int a = model_->n_axes() - 1; a >= 0; --a) {
    load_[at(a)] = power(S_[at(a)], inertial_[at(a)]) - power(S_[at(a)], external_[at(a)]);
    for (const TermNow& term : kinematics.terms(a)) {
      tau_[term.coordinate] += term.slope * load_[at(a)];
    }
    const int before = model_->axes()[at(a)].predecessor;
    if (before < 0) continue;
    inertial_[at(before)] += inertial_[at(a)];
    external_[at(before)] += external_[at(a)];
  }
  return tau_;
}

InverseDynamics::Composite& InverseDynamics::Composite::operator+=(const Composite& other) {
  mass += other.mass;
  h += other.h;
  J += other.J;
  M += other.M;
  P += other.P;
  return *this;
}

// I α + B β.
ForceScrew InverseDynamics::Composite::times(const Screw& alpha, const Screw& beta) const {
  return {J * alpha.w + h.cross(alpha.v) + M * beta.w,
          mass * alpha.v - h.cross(alpha.w) + 2.0 * beta.w.cross(P)};
}

void InverseDynamics::compose(const Kinematics& kinematics) {
  for (Composite& composite : composite_) composite = {};
  for (int b = 0; b < model_->n_bodies(); ++b) {
    const int axis = model_->last_axis(b);
    if (axis < 0) continue;
    const Kinematics::Twist& V = kinematics.axis_twist(axis);
    const BodyNow& now = bodies_[at(b)];
    Composite body;
    body.mass = mass_[at(b)];
    body.h = body.mass * now.centre;
    body.J = now.inertia - body.h * now.centre.transpose();
    body.J.diagonal().array() += body.h.dot(now.centre);
    body.P = body.mass * V.v + V.w.cross(body.h);
    // M = 2 [ω] J − tr(J) [ω] − 2 [h][v], with [h][v] = v hᵀ − (h·v) 1.
    Matrix3 J = 2.0 * body.J;
    J.diagonal().array() -= body.J.trace();
    body.M.noalias() = cross_matrix(V.w) * J;
    body.M -= 2.0 * V.v * body.h.transpose();
    body.M.diagonal().array() += 2.0 * body.h.dot(V.v);
    composite_[at(axis)] += body;
  }
  for (int a = model_->n_axes() - 1; a >= 0; --a) {
    const Composite& composite = composite_[at(a)];
    const Screw& S = S_[at(a)];
    IS_[at(a)] = composite.times(S, {});
    BS_[at(a)] = composite.M.transpose() * S.w + 2.0 * composite.P.cross(S.v);
    const int before = model_->axes()[at(a)].predecessor;
    if (before >= 0) composite_[at(before)] += composite;
  }
}

void InverseDynamics::derivative(const Kinematics& kinematics, std::span<const int> coordinates,
                                 Eigen::Ref<Eigen::MatrixXd> derivative) {
  if (derivative.rows() != tau_.size() ||
      derivative.cols() != static_cast<Eigen::Index>(coordinates.size())) {
    throw std::invalid_argument(
        "inverse dynamics: derivative is " + std::to_string(derivative.rows()) + " × " +
        std::to_string(derivative.cols()) + "; it must be " + std::to_string(tau_.size()) + " × " +
        std::to_string(coordinates.size()));
  }
  compose(kinematics);
  for (std::size_t column = 0; column < coordinates.size(); ++column) {
    const int c = coordinates[column];
    if (c < 0 || c >= model_->n_coordinates()) {
      throw std::invalid_argument("inverse dynamics: coordinate is " + std::to_string(c) +
                                  "; the model has 0 to " +
                                  std::to_string(model_->n_coordinates() - 1));
    }
    auto out = derivative.col(static_cast<Eigen::Index>(column));
    out.setZero();
    for (double& change : change_) change = 0.0;
    for (const TermNow& term : kinematics.terms()) {
      if (term.coordinate != c) continue;
      add_axis_derivative(kinematics, term);
      out[c] += term.curvature * load_[at(term.axis)];
    }
    for (const TermNow& term : kinematics.terms()) {
      out[term.coordinate] += term.slope * change_[at(term.axis)];
    }
  }
}

// Adds to change_ what a term's coordinate does to all axis loads through the amount, rate and
// acceleration of its axis j.
void InverseDynamics::add_axis_derivative(const Kinematics& kinematics, const TermNow& by) {
  const int j = by.axis;
  const double qd = kinematics.qd()[by.coordinate], qdd = kinematics.qdd()[by.coordinate];
  const double amount = by.slope, rate = by.curvature * qd,
               acceleration = by.curvature * qdd + by.third * qd * qd;
  const Screw& S = S_[at(j)];
  const Screw V = screw(kinematics.axis_twist(j));
  Screw A = screw(kinematics.axis_twist_rate(j));
  A.v -= model_->description().gravity;
  const Screw u = cross(V, S);
  Screw alpha = scaled(cross(A, S), amount);
  alpha += scaled(cross(V, u), amount);
  alpha += scaled(u, 2.0 * rate);
  alpha += scaled(S, acceleration);
  Screw beta = scaled(u, amount);
  beta += scaled(S, rate);

  // Axes further out: their inertial loads are carried along, external ones stay behind.
  const Screw moved = scaled(S, amount);
  for (int a = j + 1; a < model_->axes()[at(j)].subtree_end; ++a) {
    change_[at(a)] += power(alpha, IS_[at(a)]) + beta.w.dot(BS_[at(a)]) -
                      power(cross(moved, S_[at(a)]), external_[at(a)]);
  }
  // The axis itself and those it hangs on: they feel the change of everything on it.
  ForceScrew change = composite_[at(j)].times(alpha, beta);
  change += cross(moved, inertial_[at(j)]);
  for (int a = j; a >= 0; a = model_->axes()[at(a)].predecessor) {
    change_[at(a)] += power(S_[at(a)], change);
  }
}

}  // namespace condyle::model
