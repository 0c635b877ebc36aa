// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/muscle_equilibrium.hpp"

#include <chrono>
#include <stdexcept>

#include "condyle/model/model_checks.hpp"

namespace condyle::fdk {
namespace {

using model::CoordinateBalance;
using model::CoordinateRole;
using model::Model;

std::vector<int> force_dependent_coordinates(const Model& model) {
  const std::string label = model_label(model.description());
  std::vector<int> found;
  for (int c = 0; c < model.n_coordinates(); ++c) {
    const auto& coordinate = model.description().coordinates[static_cast<std::size_t>(c)];
    if (coordinate.role != CoordinateRole::kForceDependent) continue;
    if (model.dependent(c)) {
      throw std::invalid_argument(
          label + ": coordinate '" + coordinate.name +
          "' is force-dependent and follows another; it must be one of both");
    }
    found.push_back(c);
  }
  if (found.empty()) {
    throw std::invalid_argument(
        label + ": no coordinate has the role force_dependent: nothing to solve for");
  }
  if (found.size() > static_cast<std::size_t>(numerics::kMaxUnknowns)) {
    throw std::invalid_argument(label + ": " + std::to_string(found.size()) +
                                " force-dependent coordinates: must be at most " +
                                std::to_string(numerics::kMaxUnknowns));
  }
  return found;
}

std::vector<BodyContact> make_contacts(const Model& model,
                                       std::span<const BodyContactDescription> descriptions,
                                       std::span<const int> columns) {
  std::vector<BodyContact> contacts;
  contacts.reserve(descriptions.size());
  for (const BodyContactDescription& description : descriptions) {
    for (const BodyContact& other : contacts) {
      if (other.name() == description.name) {
        throw std::invalid_argument("contact '" + description.name +
                                    "': two contacts have that name");
      }
    }
    contacts.emplace_back(model, description, columns);
  }
  return contacts;
}

// Adds the time of its life to a sum.
class Timer {
 public:
  Timer(PhaseSeconds& seconds, Phase phase)
      : sum_(seconds[static_cast<std::size_t>(phase)]), start_(std::chrono::steady_clock::now()) {}
  ~Timer() {
    sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& sum_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace

std::string_view name(Phase phase) {
  switch (phase) {
    case Phase::kKinematics:
      return "kinematics";
    case Phase::kDynamics:
      return "dynamics";
    case Phase::kPaths:
      return "paths";
    case Phase::kLigaments:
      return "ligaments";
    case Phase::kRecruitment:
      return "recruitment";
    case Phase::kContact:
      return "contact";
    case Phase::kLinearAlgebra:
      return "linear_algebra";
  }
  return "unknown";
}

MuscleEquilibrium::MuscleEquilibrium(const Model& model, const MuscleSettings& settings,
                                     std::span<const BodyContactDescription> contacts)
    : model_(&model),
      columns_(force_dependent_coordinates(model)),
      frame_(model, settings, columns_),
      contacts_(make_contacts(model, contacts, columns_)) {
  contact_tau_.setZero(model.n_coordinates());
  contact_stiffness_.setZero(model.n_coordinates(), size());
  derivative_.setZero(model.n_coordinates(), size());
}

numerics::Unknowns MuscleEquilibrium::unknowns(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  numerics::Unknowns alpha(size());
  for (int i = 0; i < size(); ++i) alpha[i] = q[columns_[static_cast<std::size_t>(i)]];
  return alpha;
}

void MuscleEquilibrium::set_frame(const FrameMotion& motion) {
  frame_.set_motion(motion.q, motion.qd, motion.qdd);
  frame_.hold_paths(motion.snapshots, motion.snapshot_row);
  loads_ = motion.loads;
  alpha_.resize(0);
}

void MuscleEquilibrium::place(const numerics::Unknowns& alpha) {
  alpha_.resize(0);
  frame_.move_columns(alpha);
}

bool MuscleEquilibrium::couple_recruitment() {
  if (!frame_.recruits()) return false;
  Eigen::MatrixXd C = frame_.used_coupling();
  if (!frame_.coupling(derivative_, C)) return false;
  frame_.set_coupling(C);
  alpha_.resize(0);
  return true;
}

void MuscleEquilibrium::uncouple_recruitment() {
  frame_.set_coupling(
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(frame_.balanced().size()), size()));
  alpha_.resize(0);
}

numerics::LoadKind MuscleEquilibrium::load_kind(int i) const {
  const auto c = static_cast<std::size_t>(columns_[static_cast<std::size_t>(i)]);
  return model_->description().coordinates[c].rotational ? numerics::LoadKind::kMoment
                                                         : numerics::LoadKind::kForce;
}

std::string_view MuscleEquilibrium::coordinate_name(int i) const {
  return model_->description()
      .coordinates[static_cast<std::size_t>(columns_[static_cast<std::size_t>(i)])]
      .name;
}

void MuscleEquilibrium::evaluate(const numerics::Unknowns& alpha, bool derivatives) {
  {
    const Timer timer(seconds_, Phase::kKinematics);
    frame_.move_columns(alpha);
  }
  {
    const Timer timer(seconds_, Phase::kDynamics);
    frame_.compute_dynamics(loads_);
    if (derivatives) frame_.differentiate_dynamics();
  }
  {
    const Timer timer(seconds_, Phase::kPaths);
    frame_.compute_muscles(derivatives);
  }
  {
    const Timer timer(seconds_, Phase::kLigaments);
    frame_.compute_ligaments(derivatives);
  }
  {
    const Timer timer(seconds_, Phase::kContact);
    contact_tau_.setZero();
    contact_stiffness_.setZero();
    const auto what = derivatives ? contact::Derivatives::kStiffness : contact::Derivatives::kNone;
    for (BodyContact& contact : contacts_) {
      contact.evaluate(frame_.kinematics(), what, contact_share_);
      contact.add_force(frame_.kinematics(), contact_tau_);
      if (derivatives) contact.add_stiffness(frame_.kinematics(), contact_stiffness_);
    }
  }
  const Timer timer(seconds_, Phase::kRecruitment);
  if (frame_.recruits()) {
    recruited_ = &frame_.recruit(contact_tau_);
  } else {
    frame_.leave_passive(contact_tau_);
  }
  if (derivatives) frame_.differentiate_residual(contact_stiffness_, derivative_);
  alpha_ = alpha;
}

void MuscleEquilibrium::net_force(numerics::Unknowns& r) const {
  for (int i = 0; i < size(); ++i) r[i] = -frame_.residual()[columns_[static_cast<std::size_t>(i)]];
}

void MuscleEquilibrium::residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) {
  evaluate(alpha, false);
  net_force(r);
}

void MuscleEquilibrium::residual_and_jacobian(const numerics::Unknowns& alpha,
                                              numerics::Unknowns& r, numerics::Jacobian& J) {
  evaluate(alpha, true);
  net_force(r);
  const Timer timer(seconds_, Phase::kLinearAlgebra);
  for (int i = 0; i < size(); ++i)
    J.row(i) = -derivative_.row(columns_[static_cast<std::size_t>(i)]);
}

std::string MuscleEquilibrium::recruitment_message() const {
  return recruited_ == nullptr ? "nothing to recruit" : frame_.recruitment_message();
}

}  // namespace condyle::fdk
