// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/body_contact.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "condyle/model/model_checks.hpp"

namespace condyle::fdk {
namespace {

using model::ForceScrew;
using model::Kinematics;
using model::Screw;
using model::TermNow;

// Placements come from files of six or more digits.
constexpr double kRotationTolerance = 1e-5;

[[noreturn]] void refuse(const BodyContactDescription& description, const std::string& what) {
  throw std::invalid_argument("contact '" + description.name + "': " + what);
}

void require_placement(const BodyContactDescription& description, const char* field,
                       const RigidTransform& X) {
  const bool rotation =
      X.R.allFinite() &&
      (X.R.transpose() * X.R - Matrix3::Identity()).cwiseAbs().maxCoeff() < kRotationTolerance &&
      X.R.determinant() > 0.0;
  if (!rotation) refuse(description, std::string(field) + ".R is not a rotation");
  if (!X.p.allFinite()) refuse(description, std::string(field) + ".p is not finite");
}

int body_of(const model::Model& model, const BodyContactDescription& description, const char* field,
            const std::string& name) {
  try {
    return model.body(name);
  } catch (const std::invalid_argument& error) {
    refuse(description, std::string(field) + ": " + error.what());
  }
}

Screw axis_now(const Kinematics& kinematics, int axis) {
  return model::axis_screw(kinematics.axes()[static_cast<std::size_t>(axis)]);
}

Screw scaled(double factor, const Screw& S) { return {factor * S.w, factor * S.v}; }

}  // namespace

BodyContact::BodyContact(const model::Model& model, const BodyContactDescription& description,
                         std::span<const int> columns)
    : name_(description.name),
      contact_(description.model),
      X_BF_(description.X_BF),
      X_BT_(description.X_BT),
      columns_(columns.begin(), columns.end()) {
  if (contact_ == nullptr) refuse(description, "no contact model");
  body_F_ = body_of(model, description, "moving_body", description.moving_body);
  body_T_ = body_of(model, description, "fixed_body", description.fixed_body);
  if (body_F_ == body_T_) {
    refuse(description, "moving_body and fixed_body are both '" + description.moving_body + "'");
  }
  if (contact_->side_of_body() != description.side_of_body) {
    refuse(description, "the contact model is of a " +
                            std::string(condyle::name(contact_->side_of_body())) +
                            " knee; the joint is on the " +
                            std::string(condyle::name(description.side_of_body)) +
                            ": mirror the implant, or place the contact on the other side");
  }
  require_placement(description, "X_BF", X_BF_);
  require_placement(description, "X_BT", X_BT_);
  const auto chain_F = model.axes_to(body_F_), chain_T = model.axes_to(body_T_);
  to_T_.sign = -1.0;
  std::set_difference(chain_F.begin(), chain_F.end(), chain_T.begin(), chain_T.end(),
                      std::back_inserter(to_F_.axes));
  std::set_difference(chain_T.begin(), chain_T.end(), chain_F.begin(), chain_F.end(),
                      std::back_inserter(to_T_.axes));
}

BodyContact::Placed BodyContact::place(const Kinematics& kinematics) const {
  return {kinematics.X_GB(body_T_) * X_BT_, kinematics.X_GB(body_F_) * X_BF_};
}

Pose BodyContact::pose(const Kinematics& kinematics) const {
  const Placed placed = place(kinematics);
  return pose_from_transform(placed.X_GT.inverse() * placed.X_GF);
}

// What branch's end moves with per unit rate of q_c, apart from the axes common to both bodies.
Screw BodyContact::motion(const Kinematics& kinematics, const Branch& branch, int c) const {
  Screw V;
  for (const int a : branch.axes) {
    for (const TermNow& term : kinematics.terms(a)) {
      if (term.coordinate == c) V += scaled(term.slope, axis_now(kinematics, a));
    }
  }
  return V;
}

void BodyContact::pose_derivative(const Kinematics& kinematics,
                                  Eigen::Ref<Eigen::MatrixXd> derivative) const {
  const Placed placed = place(kinematics);
  const Pose pose = pose_from_transform(placed.X_GT.inverse() * placed.X_GF);
  const Matrix3 turn = twist_map(pose).bottomRightCorner<3, 3>().inverse();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Screw F = motion(kinematics, to_F_, columns_[i]);
    const Screw T = motion(kinematics, to_T_, columns_[i]);
    const Vector3 w = F.w - T.w;
    const Vector3 v = F.v - T.v + w.cross(placed.X_GF.p);
    auto column = derivative.col(static_cast<Eigen::Index>(i));
    column.head<3>() = placed.X_GT.R.transpose() * v;
    column.tail<3>() = turn * (placed.X_GT.R.transpose() * w);
  }
}

void BodyContact::evaluate(const Kinematics& kinematics, contact::Derivatives derivatives,
                           double share) {
  placed_ = place(kinematics);
  pose_ = pose_from_transform(placed_.X_GT.inverse() * placed_.X_GF);
  loads_ = contact_->evaluate(pose_, derivatives);
  if (share == 1.0) return;
  for (int s = 0; s < kSides; ++s) {
    loads_.wrench[static_cast<std::size_t>(s)] *= share;
    loads_.stiffness[static_cast<std::size_t>(s)] *= share;
  }
}

ForceScrew BodyContact::wrench_in_ground() const {
  const Wrench wrench = loads_.total_wrench();
  return model::wrench_at_origin(placed_.X_GT.R * wrench.head<3>(), placed_.X_GF.p,
                                 placed_.X_GT.R * wrench.tail<3>());
}

void BodyContact::add_force(const Kinematics& kinematics, Eigen::Ref<Eigen::VectorXd> tau) const {
  const ForceScrew W = wrench_in_ground();
  for (const Branch* branch : {&to_F_, &to_T_}) {
    for (const int a : branch->axes) {
      const double share = branch->sign * model::power(axis_now(kinematics, a), W);
      for (const TermNow& term : kinematics.terms(a)) tau[term.coordinate] += term.slope * share;
    }
  }
}

// Of a wrench that stays as it is in ground: axis j carries every later axis of its branch along,
// and a term's own slope changes by its curvature.
void BodyContact::add_geometric(const Kinematics& kinematics, const ForceScrew& W, int c,
                                Eigen::Ref<Eigen::VectorXd> column) const {
  for (const Branch* branch : {&to_F_, &to_T_}) {
    for (std::size_t j = 0; j < branch->axes.size(); ++j) {
      const Screw S_j = axis_now(kinematics, branch->axes[j]);
      for (const TermNow& by : kinematics.terms(branch->axes[j])) {
        if (by.coordinate != c) continue;
        column[c] += branch->sign * by.curvature * model::power(S_j, W);
        for (std::size_t k = j + 1; k < branch->axes.size(); ++k) {
          const int a = branch->axes[k];
          const double change =
              branch->sign * by.slope * model::power(cross(S_j, axis_now(kinematics, a)), W);
          for (const TermNow& term : kinematics.terms(a)) {
            column[term.coordinate] += term.slope * change;
          }
        }
      }
    }
  }
}

void BodyContact::add_stiffness(const Kinematics& kinematics,
                                Eigen::Ref<Eigen::MatrixXd> stiffness) const {
  const ForceScrew W = wrench_in_ground();
  const Matrix3& R_GT = placed_.X_GT.R;
  const Vector3& p_GFo = placed_.X_GF.p;
  const Matrix6 by_pose = loads_.total_stiffness();
  const Matrix3 turn = twist_map(pose_).bottomRightCorner<3, 3>().inverse();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const int c = columns_[i];
    const Screw V_T = motion(kinematics, to_T_, c);
    const Screw V_F = motion(kinematics, to_F_, c);
    const Vector3 w = V_F.w - V_T.w;
    const Vector3 v = V_F.v - V_T.v + w.cross(p_GFo);
    Pose rate;
    rate << R_GT.transpose() * v, turn * (R_GT.transpose() * w);
    const Wrench change = by_pose * rate;
    ForceScrew dW = cross(V_T, W);
    dW += model::wrench_at_origin(R_GT * change.head<3>(), p_GFo, R_GT * change.tail<3>());
    dW.n += v.cross(W.f);
    auto column = stiffness.col(static_cast<Eigen::Index>(i));
    for (const Branch* branch : {&to_F_, &to_T_}) {
      for (const int a : branch->axes) {
        const double share = branch->sign * model::power(axis_now(kinematics, a), dW);
        for (const TermNow& term : kinematics.terms(a)) {
          column[term.coordinate] += term.slope * share;
        }
      }
    }
    add_geometric(kinematics, W, c, column);
  }
}

}  // namespace condyle::fdk
