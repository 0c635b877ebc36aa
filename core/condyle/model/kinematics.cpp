// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/kinematics.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/model/model_checks.hpp"

namespace condyle::model {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

// R·E for a turn by `angle` about the unit `axis`: Rodrigues' formula.
Matrix3 turned(const Matrix3& R, double angle, const Vector3& axis) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vector3 a = (1.0 - c) * axis;
  Matrix3 E;
  E << c + a.x() * axis.x(), a.x() * axis.y() - s * axis.z(), a.x() * axis.z() + s * axis.y(),
      a.x() * axis.y() + s * axis.z(), c + a.y() * axis.y(), a.y() * axis.z() - s * axis.x(),
      a.x() * axis.z() - s * axis.y(), a.y() * axis.z() + s * axis.x(), c + a.z() * axis.z();
  return R * E;
}

}  // namespace

Kinematics::Kinematics(const Model& model)
    : model_(&model),
      follows_(at(model.n_coordinates())),
      axes_(at(model.n_axes())),
      X_GA_(at(model.n_axes())),
      X_GB_(at(model.n_bodies() + 1)),
      twists_(at(model.n_axes() + 1)),
      rates_(at(model.n_axes() + 1)) {
  q_.resize(model.n_coordinates());
  for (int c = 0; c < model.n_coordinates(); ++c) {
    q_[c] = model.description().coordinates[at(c)].default_value;
    follows_[at(c)].independent = c;
  }
  qd_ = qdd_ = Eigen::VectorXd::Zero(model.n_coordinates());
  for (const ModelCoupling& c : model.couplings()) {
    follows_[at(c.dependent)].independent = follows_[at(c.independent)].independent;
  }
  for (int a = 0; a < model.n_axes(); ++a) {
    axes_[at(a)].rotational = model.axes()[at(a)].rotational;
    first_term_.push_back(static_cast<int>(terms_.size()));
    for (const ModelAxis::Term& term : model.axes()[at(a)].terms) {
      TermNow now;
      now.axis = a;
      now.coordinate = follows_[at(term.coordinate)].independent;
      terms_.push_back(now);
    }
  }
  first_term_.push_back(static_cast<int>(terms_.size()));
  follow_couplings();
  place();
}

void Kinematics::set(const Eigen::Ref<const Eigen::VectorXd>& q) {
  require("q", q);
  q_ = q;
  qd_.setZero();
  qdd_.setZero();
  follow_couplings();
  place();
  for (Twist& twist : twists_) twist = {};
  for (Twist& rate : rates_) rate = {};
}

void Kinematics::set(const Eigen::Ref<const Eigen::VectorXd>& q,
                     const Eigen::Ref<const Eigen::VectorXd>& qd,
                     const Eigen::Ref<const Eigen::VectorXd>& qdd) {
  require("q", q);
  require("qd", qd);
  require("qdd", qdd);
  q_ = q;
  qd_ = qd;
  qdd_ = qdd;
  follow_couplings();
  place();
  move();
}

// What is given for a dependent coordinate is not looked at.
void Kinematics::require(const char* what, const Eigen::Ref<const Eigen::VectorXd>& given) const {
  if (given.size() != q_.size()) {
    throw std::invalid_argument(model_label(model_->description()) + ": " + what + " has " +
                                std::to_string(given.size()) + " values; the model has " +
                                std::to_string(q_.size()) + " coordinates");
  }
  for (int c = 0; c < given.size(); ++c) {
    if (std::isfinite(given[c]) || model_->dependent(c)) continue;
    throw std::invalid_argument(model_label(model_->description()) + ": " + what +
                                " of coordinate '" + model_->description().coordinates[at(c)].name +
                                "' is " + std::to_string(given[c]) + "; it must be finite");
  }
}

// Derivatives of d = g(i), i itself a function of the free coordinate, by the chain rule to third
// order.
void Kinematics::follow_couplings() {
  for (const ModelCoupling& coupling : model_->couplings()) {
    const CoordinateNow& i = follows_[at(coupling.independent)];
    CoordinateNow& d = follows_[at(coupling.dependent)];
    const auto [g, g1, g2, g3] = coupling.function(q_[coupling.independent]);
    q_[coupling.dependent] = g;
    d.slope = g1 * i.slope;
    d.curvature = g2 * i.slope * i.slope + g1 * i.curvature;
    d.third = g3 * i.slope * i.slope * i.slope + 3.0 * g2 * i.slope * i.curvature + g1 * i.third;
    const double rate = qd_[d.independent];
    qd_[coupling.dependent] = d.slope * rate;
    qdd_[coupling.dependent] = d.slope * qdd_[d.independent] + d.curvature * rate * rate;
  }
}

void Kinematics::place() {
  for (int a = 0; a < model_->n_axes(); ++a) {
    const ModelAxis& axis = model_->axes()[at(a)];
    double amount = axis.constant;
    for (std::size_t k = 0; k < axis.terms.size(); ++k) {
      const auto [f, f1, f2, f3] = axis.terms[k].function(q_[axis.terms[k].coordinate]);
      const CoordinateNow& c = follows_[at(axis.terms[k].coordinate)];
      TermNow& term = terms_[at(first_term(a)) + k];
      amount += f;
      term.slope = f1 * c.slope;
      term.curvature = f2 * c.slope * c.slope + f1 * c.curvature;
      term.third =
          f3 * c.slope * c.slope * c.slope + 3.0 * f2 * c.slope * c.curvature + f1 * c.third;
    }
    RigidTransform& X = X_GA_[at(a)];
    X = axis.predecessor < 0 ? axis.before : X_GA_[at(axis.predecessor)] * axis.before;
    AxisNow& now = axes_[at(a)];
    now.direction.noalias() = X.R * axis.direction;
    if (axis.rotational) {
      X.R = turned(X.R, amount, axis.direction);
    } else {
      X.p += amount * now.direction;
    }
    now.point = X.p;
  }
  for (int b = 0; b < model_->n_bodies(); ++b) {
    const int last = model_->last_axis(b);
    X_GB_[at(b + 1)] = last < 0 ? model_->after(b) : X_GA_[at(last)] * model_->after(b);
  }
}

void Kinematics::move() {
  for (int a = 0; a < model_->n_axes(); ++a) {
    double rate = 0.0, acceleration = 0.0;
    for (const TermNow& term : terms(a)) {
      const double qd = qd_[term.coordinate];
      rate += term.slope * qd;
      acceleration += term.slope * qdd_[term.coordinate] + term.curvature * qd * qd;
    }
    const AxisNow& now = axes_[at(a)];
    const int before = model_->axes()[at(a)].predecessor;
    const Twist& V_before = axis_twist(before);
    const Twist& A_before = axis_twist_rate(before);
    Twist& V = twists_[at(a + 1)];
    Twist& A = rates_[at(a + 1)];
    // V × S = (ω × s, ω × s_v + v × s) for S = (s, s_v); the axis's own share of V drops out, S × S
    // = 0.
    if (now.rotational) {
      const Vector3 s_v = now.point.cross(now.direction);
      V.w = V_before.w + rate * now.direction;
      V.v = V_before.v + rate * s_v;
      A.w = A_before.w + acceleration * now.direction + rate * V_before.w.cross(now.direction);
      A.v = A_before.v + acceleration * s_v +
            rate * (V_before.w.cross(s_v) + V_before.v.cross(now.direction));
    } else {
      V.w = V_before.w;
      V.v = V_before.v + rate * now.direction;
      A.w = A_before.w;
      A.v = A_before.v + acceleration * now.direction + rate * V_before.w.cross(now.direction);
    }
  }
}

}  // namespace condyle::model
