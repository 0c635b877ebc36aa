// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/musculoskeletal_frame.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "condyle/model/model_checks.hpp"

namespace condyle::fdk {
namespace {

using model::CoordinateBalance;
using model::CoordinateRole;
using model::Model;

std::vector<int> balanced_coordinates(const Model& model) {
  std::vector<char> dependent(static_cast<std::size_t>(model.n_coordinates()), 0);
  for (const auto& coupling : model.description().couplings) {
    dependent[static_cast<std::size_t>(model.coordinate(coupling.dependent))] = 1;
  }
  std::vector<int> found;
  for (int c = 0; c < model.n_coordinates(); ++c) {
    const auto& coordinate = model.description().coordinates[static_cast<std::size_t>(c)];
    if (coordinate.role == CoordinateRole::kDriven && coordinate.balance == CoordinateBalance::kMuscles &&
        !dependent[static_cast<std::size_t>(c)]) {
      found.push_back(c);
    }
  }
  return found;
}

std::vector<model::Path> muscle_paths(const Model& model) {
  std::vector<model::Path> paths;
  paths.reserve(model.description().muscles.size());
  for (const auto& muscle : model.description().muscles) {
    require_valid(muscle);
    paths.emplace_back(model, muscle.path, "muscle '" + muscle.name + "'");
  }
  return paths;
}

void require_reserve(const char* field, double value) {
  if (std::isfinite(value) && value >= 0.0) return;
  std::ostringstream text;
  text << "muscle settings: " << field << " is " << value << "; it must be at least 0";
  throw std::invalid_argument(text.str());
}

recruitment::RecruitmentSetup recruitment_setup(const Model& model, const std::vector<int>& balanced,
                                                const MuscleSettings& settings) {
  recruitment::RecruitmentSetup setup;
  setup.coordinates = static_cast<int>(balanced.size());
  setup.muscles = static_cast<int>(model.description().muscles.size());
  for (const auto& muscle : model.description().muscles) setup.muscle_names.push_back(muscle.name);
  setup.reserve_strengths.resize(setup.coordinates);
  setup.reserve_prices.setConstant(setup.coordinates, settings.reserve_price);
  for (int j = 0; j < setup.coordinates; ++j) {
    const auto& coordinate =
        model.description().coordinates[static_cast<std::size_t>(balanced[static_cast<std::size_t>(j)])];
    setup.coordinate_names.push_back(coordinate.name);
    setup.reserve_strengths[j] =
        coordinate.rotational ? settings.reserve_moment : settings.reserve_force;
  }
  return setup;
}

}  // namespace

MusculoskeletalFrame::MusculoskeletalFrame(const Model& model, const MuscleSettings& settings)
    : model_(&model),
      settings_(settings),
      balanced_(balanced_coordinates(model)),
      kinematics_(model),
      dynamics_(model),
      paths_(muscle_paths(model)),
      strands_(model),
      strand_loads_(strands_),
      held_(paths_.size(), nullptr),
      muscles_(paths_.size()) {
  require_reserve("reserve_moment", settings.reserve_moment);
  require_reserve("reserve_force", settings.reserve_force);
  const auto n = static_cast<Eigen::Index>(model.n_coordinates());
  const auto m = static_cast<Eigen::Index>(paths_.size());
  const auto k = static_cast<Eigen::Index>(balanced_.size());
  for (const model::Path& path : paths_) {
    gradients_.emplace_back(Eigen::VectorXd::Zero(path.n_coordinates()));
    path_workspace_.reserve(path, 0);
  }
  moment_arms_.setZero(n, m);
  for (Eigen::VectorXd* v : {&ligament_tau_, &spring_tau_, &passive_, &residual_}) v->setZero(n);
  for (Eigen::VectorXd* v : {&forces_, &strengths_}) v->setZero(m);
  loads_.setZero(k);
  arms_.setZero(k, m);
  if (k > 0 && m > 0) {
    solver_.emplace(recruitment_setup(model, balanced_, settings), settings.recruitment);
  }
}

std::vector<std::string> MusculoskeletalFrame::wraps_ignored() const {
  std::vector<std::string> found;
  for (const model::Path& path : paths_) {
    for (const std::string& wrap : path.wraps_ignored()) found.push_back(path.owner() + ": " + wrap);
  }
  for (int i = 0; i < strands_.size(); ++i) {
    const model::Strand& strand = strands_[i];
    for (const std::string& wrap : strand.path.wraps_ignored()) {
      found.push_back("ligament '" + strand.name + "': " + wrap);
    }
  }
  return found;
}

void MusculoskeletalFrame::set_motion(const Eigen::Ref<const Eigen::VectorXd>& q,
                                      const Eigen::Ref<const Eigen::VectorXd>& qd,
                                      const Eigen::Ref<const Eigen::VectorXd>& qdd) {
  kinematics_.set(q, qd, qdd);
}

void MusculoskeletalFrame::compute_dynamics(std::span<const model::ExternalLoad> loads) {
  dynamics_.compute(kinematics_, loads);
}

void MusculoskeletalFrame::hold_paths(const model::PathSnapshots* snapshots, std::size_t row) {
  const auto& muscles = model_->description().muscles;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    held_[i] = snapshots == nullptr ? nullptr : snapshots->find(muscles[i].name, row);
  }
  if (snapshots != nullptr) {
    strand_loads_.hold(*snapshots, row);
  } else {
    for (int i = 0; i < strands_.size(); ++i) strand_loads_.hold(i, nullptr);
  }
}

void MusculoskeletalFrame::compute_muscles() {
  const auto& descriptions = model_->description().muscles;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const model::Path& path = paths_[i];
    Eigen::VectorXd& gradient = gradients_[i];
    MuscleNow& now = muscles_[i];
    now.length = path.gradient(kinematics_, path_workspace_, gradient, held_[i]);
    now.velocity = path.velocity(kinematics_, gradient);
    now.strength = muscle_strength(descriptions[i], settings_.strength, now.length, now.velocity);
    auto arms = moment_arms_.col(static_cast<Eigen::Index>(i));
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      arms[path.coordinates()[static_cast<std::size_t>(k)]] = -gradient[k];
    }
  }
}

void MusculoskeletalFrame::compute_ligaments() {
  ligament_tau_.setZero();
  strands_.add_forces(kinematics_, strand_loads_, ligament_tau_);
  spring_tau_.setZero();
  add_spring_force(kinematics_, spring_tau_);
}

const recruitment::Recruitment& MusculoskeletalFrame::recruit() {
  if (!solver_) {
    throw std::logic_error(model_label(model_->description()) +
                           ": no muscles, or no coordinate that muscles balance: nothing to recruit");
  }
  for (std::size_t i = 0; i < muscles_.size(); ++i) {
    const auto m = static_cast<Eigen::Index>(i);
    strengths_[m] = muscles_[i].strength.strength;
    forces_[m] = muscles_[i].strength.passive;
  }
  passive_.noalias() = moment_arms_ * forces_;
  passive_ += ligament_tau_ + spring_tau_;
  for (std::size_t j = 0; j < balanced_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    loads_[row] = dynamics_.generalised_forces()[balanced_[j]] - passive_[balanced_[j]];
    arms_.row(row) = moment_arms_.row(balanced_[j]);
  }
  const recruitment::Recruitment& result = solver_->solve({arms_, loads_, strengths_, minima_});
  residual_.noalias() = moment_arms_ * result.forces;
  residual_ = dynamics_.generalised_forces() - passive_ - residual_;
  forces_ += result.forces;
  return result;
}

}  // namespace condyle::fdk
