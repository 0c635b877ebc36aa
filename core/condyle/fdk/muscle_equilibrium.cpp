// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/muscle_equilibrium.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
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

// How much of a new C is taken (renew): as found on four trials of a subject in gait and crouched gait, where these
// leave no time frame swinging, and the usual one with 5 or 6 evaluations.
constexpr double kNearer = 0.7, kGrowth = 1.3, kLeastWeight = 0.1;
constexpr int kUsualUpdates = 5;
constexpr double kNear = 10.0;  // [tolerances of sharing]

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

void MuscleEquilibrium::follow_sharing(int most, double force_tolerance, double moment_tolerance) {
  sharing_ = Sharing{};
  sharing_.most = frame_.recruits() ? most : 0;
  sharing_.force_tolerance = force_tolerance;
  sharing_.moment_tolerance = moment_tolerance;
}

void MuscleEquilibrium::uncouple_recruitment() {
  use_coupling(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(frame_.balanced().size()), size()));
}

bool MuscleEquilibrium::renew(const numerics::Unknowns& alpha, numerics::Unknowns& r,
                              numerics::Jacobian& J) {
  if (!renews()) return false;
  // Again where r is small by chance: f is part of C, and C of f.
  for (bool again = true; again;) {
    evaluate(alpha, Derivatives::kHeld);
    if (!take_coupling()) break;
    evaluate(alpha, Derivatives::kNone);
    const numerics::Unknowns before = r;
    net_force(r);
    const double change = in_tolerances(r - before) / sharing_.weight;
    // Longer than usual near the end it takes where muscles hardly pull, and C matters little.
    const double enough = std::exp2(std::max(0, sharing_.near - kUsualUpdates) / 5.0);
    const bool small = in_tolerances(r) <= enough;
    if (in_tolerances(r) <= kNear) ++sharing_.near;
    sharing_.held = small && change <= enough;
    again = small && !sharing_.held && ++sharing_.updates < sharing_.most;
    // C, f and α answer to each other, and may swing about where they agree: smaller parts then.
    const bool nearer = change < kNearer * sharing_.change;
    sharing_.weight = nearer ? std::min(1.0, kGrowth * sharing_.weight)
                             : std::max(kLeastWeight, 0.5 * sharing_.weight);
    sharing_.change = change;
  }
  ++sharing_.updates;
  evaluate(alpha, Derivatives::kWhole);
  net_force(r);
  net_stiffness(J);
  return true;
}

// Moves C towards what it is now. False where α's stiffness is singular.
bool MuscleEquilibrium::take_coupling() {
  Eigen::MatrixXd C = frame_.used_coupling();
  {
    const Timer timer(seconds_, Phase::kLinearAlgebra);
    if (!frame_.coupling(derivative_, C)) return false;
  }
  use_coupling(sharing_.weight * C + (1.0 - sharing_.weight) * frame_.used_coupling());
  return true;
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

void MuscleEquilibrium::evaluate(const numerics::Unknowns& alpha, Derivatives derivatives) {
  const bool wanted = derivatives != Derivatives::kNone;
  if (alpha_.size() == alpha.size() && alpha_ == alpha && (differentiated_ || !wanted)) {
    if (!shared_) share();
    differentiate(derivatives);
    return;
  }
  alpha_.resize(0);
  {
    const Timer timer(seconds_, Phase::kKinematics);
    frame_.move_columns(alpha);
  }
  {
    const Timer timer(seconds_, Phase::kDynamics);
    frame_.compute_dynamics(loads_);
    if (wanted) frame_.differentiate_dynamics();
  }
  {
    const Timer timer(seconds_, Phase::kPaths);
    frame_.compute_muscles(wanted);
  }
  {
    const Timer timer(seconds_, Phase::kLigaments);
    frame_.compute_ligaments(wanted);
  }
  {
    const Timer timer(seconds_, Phase::kContact);
    contact_tau_.setZero();
    contact_stiffness_.setZero();
    const auto what = wanted ? contact::Derivatives::kStiffness : contact::Derivatives::kNone;
    for (BodyContact& contact : contacts_) {
      contact.evaluate(frame_.kinematics(), what, contact_share_);
      contact.add_force(frame_.kinematics(), contact_tau_);
      if (wanted) contact.add_stiffness(frame_.kinematics(), contact_stiffness_);
    }
  }
  alpha_ = alpha;
  differentiated_ = wanted;
  share();
  differentiate(derivatives);
}

// What changes with C alone.
void MuscleEquilibrium::share() {
  const Timer timer(seconds_, Phase::kRecruitment);
  if (frame_.recruits()) {
    recruited_ = &frame_.recruit(contact_tau_);
  } else {
    frame_.leave_passive(contact_tau_);
  }
  shared_ = true;
  derivative_is_ = Derivatives::kNone;
}

// The derivative with or without the muscles' answer.
void MuscleEquilibrium::differentiate(Derivatives derivatives) {
  if (derivatives == Derivatives::kNone || derivatives == derivative_is_) return;
  const Timer timer(seconds_, Phase::kRecruitment);
  if (derivatives == Derivatives::kHeld) {
    frame_.differentiate_held(contact_stiffness_, derivative_);
  } else {
    frame_.differentiate_residual(contact_stiffness_, derivative_);
  }
  derivative_is_ = derivatives;
}

void MuscleEquilibrium::net_force(numerics::Unknowns& r) const {
  for (int i = 0; i < size(); ++i) r[i] = -frame_.residual()[columns_[static_cast<std::size_t>(i)]];
}

void MuscleEquilibrium::net_stiffness(numerics::Jacobian& J) const {
  for (int i = 0; i < size(); ++i)
    J.row(i) = -derivative_.row(columns_[static_cast<std::size_t>(i)]);
}

double MuscleEquilibrium::in_tolerances(const numerics::Unknowns& r) const {
  double largest = 0.0;
  for (int i = 0; i < size(); ++i) {
    const bool force = load_kind(i) == numerics::LoadKind::kForce;
    largest = std::max(largest, std::abs(r[i]) / (force ? sharing_.force_tolerance
                                                        : sharing_.moment_tolerance));
  }
  return largest;
}

void MuscleEquilibrium::residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) {
  evaluate(alpha, Derivatives::kNone);
  net_force(r);
}

void MuscleEquilibrium::residual_and_jacobian(const numerics::Unknowns& alpha,
                                              numerics::Unknowns& r, numerics::Jacobian& J) {
  // Where C is taken anew next, the answer to the C of now would be thrown away.
  evaluate(alpha, renews() ? Derivatives::kHeld : Derivatives::kWhole);
  net_force(r);
  net_stiffness(J);
}

std::string MuscleEquilibrium::recruitment_message() const {
  return recruited_ == nullptr ? "nothing to recruit" : frame_.recruitment_message();
}

}  // namespace condyle::fdk
