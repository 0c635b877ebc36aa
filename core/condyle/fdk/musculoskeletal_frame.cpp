// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/musculoskeletal_frame.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "condyle/model/model_checks.hpp"

namespace condyle::fdk {
namespace {

using model::CoordinateBalance;
using model::CoordinateRole;
using model::Model;

// Pivots below this share of the largest are noise; rows are in N and Nm, columns by m and rad.
constexpr double kSingularPivot = 1e-12;

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

void require_columns(const Model& model, const std::vector<int>& columns) {
  for (const int c : columns) {
    if (c >= 0 && c < model.n_coordinates() && !model.dependent(c)) continue;
    throw std::invalid_argument(model_label(model.description()) + ": derivatives by coordinate " + std::to_string(c) +
                                ": must be 0 to " + std::to_string(model.n_coordinates() - 1) +
                                " and not follow another");
  }
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

MusculoskeletalFrame::MusculoskeletalFrame(const Model& model, const MuscleSettings& settings,
                                           std::span<const int> columns)
    : model_(&model),
      settings_(settings),
      columns_(columns.begin(), columns.end()),
      balanced_(balanced_coordinates(model)),
      kinematics_(model),
      dynamics_(model),
      paths_(muscle_paths(model)),
      strands_(model),
      strand_loads_(strands_, columns),
      held_(paths_.size(), nullptr),
      muscles_(paths_.size()) {
  require_reserve("reserve_moment", settings.reserve_moment);
  require_reserve("reserve_force", settings.reserve_force);
  require_columns(model, columns_);
  const auto n = static_cast<Eigen::Index>(model.n_coordinates());
  const auto m = static_cast<Eigen::Index>(paths_.size());
  const auto k = static_cast<Eigen::Index>(balanced_.size());
  const auto c = static_cast<Eigen::Index>(columns_.size());
  for (const model::Path& path : paths_) {
    gradients_.emplace_back(Eigen::VectorXd::Zero(path.n_coordinates()));
    const bool moves = std::any_of(columns_.begin(), columns_.end(),
                                   [&](int column) { return path.coordinate_index(column) >= 0; });
    moves_.push_back(moves ? 1 : 0);
    hessians_.emplace_back(Eigen::MatrixXd::Zero(moves ? path.n_coordinates() : 0, c));
    path_workspace_.reserve(path, 0);
  }
  moment_arms_.setZero(n, m);
  for (Eigen::VectorXd* v : {&ligament_tau_, &spring_tau_, &passive_, &residual_, &q_, &qd_, &qdd_, &no_others_}) {
    v->setZero(n);
  }
  for (Eigen::VectorXd* v : {&forces_, &strengths_, &active_}) v->setZero(m);
  loads_.setZero(k);
  arms_.setZero(k, m);
  coupling_.setZero(k, c);
  for (Eigen::MatrixXd* matrix : {&dynamics_rates_, &passive_rates_, &other_rates_}) matrix->setZero(n, c);
  force_rates_.setZero(m, c);
  load_rates_.setZero(c, k);
  arm_rates_.setZero(c * k, m);
  arm_change_.setZero(k, c);
  places_.resize(static_cast<std::size_t>(n));
  for (int j = 0; j < static_cast<int>(k); ++j) {
    places_[static_cast<std::size_t>(balanced_[static_cast<std::size_t>(j)])].balanced = j;
  }
  for (int j = 0; j < static_cast<int>(c); ++j) {
    places_[static_cast<std::size_t>(columns_[static_cast<std::size_t>(j)])].column = j;
  }
  strength_rates_.setZero(c, m);
  active_rates_.setZero(c, m);
  reserve_rates_.setZero(c, k);
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
  q_ = q;
  qd_ = qd;
  qdd_ = qdd;
  all_paths_ = true;
  warm_ = false;
}

void MusculoskeletalFrame::move_columns(const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (std::size_t i = 0; i < columns_.size(); ++i) q_[columns_[i]] = values[static_cast<Eigen::Index>(i)];
  kinematics_.set(q_, qd_, qdd_);
}

void MusculoskeletalFrame::compute_dynamics(std::span<const model::ExternalLoad> loads) {
  dynamics_.compute(kinematics_, loads);
}

void MusculoskeletalFrame::differentiate_dynamics() {
  dynamics_.derivative(kinematics_, columns_, dynamics_rates_);
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
  all_paths_ = true;
}

void MusculoskeletalFrame::compute_muscles(bool derivatives) {
  const auto& descriptions = model_->description().muscles;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (!all_paths_ && !moves_[i]) continue;
    const model::Path& path = paths_[i];
    Eigen::VectorXd& gradient = gradients_[i];
    MuscleNow& now = muscles_[i];
    now.length = derivatives && moves_[i]
                     ? path.hessian(kinematics_, path_workspace_, columns_, gradient, hessians_[i], held_[i])
                     : path.gradient(kinematics_, path_workspace_, gradient, held_[i]);
    now.velocity = path.velocity(kinematics_, gradient);
    now.strength = muscle_strength(descriptions[i], settings_.strength, now.length, now.velocity);
    auto arms = moment_arms_.col(static_cast<Eigen::Index>(i));
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      arms[path.coordinates()[static_cast<std::size_t>(k)]] = -gradient[k];
    }
  }
  all_paths_ = false;
}

void MusculoskeletalFrame::compute_ligaments(bool derivatives) {
  ligament_tau_.setZero();
  spring_tau_.setZero();
  add_spring_force(kinematics_, spring_tau_);
  if (!derivatives) {
    strands_.add_forces(kinematics_, strand_loads_, ligament_tau_);
    return;
  }
  passive_rates_.setZero();
  passive_differentiated_ = false;
  strands_.add_forces_and_stiffness(kinematics_, strand_loads_, ligament_tau_, passive_rates_);
  add_spring_force_derivative(kinematics_, columns_, passive_rates_);
}

// What is passive, and what is left of τ on the balanced coordinates.
void MusculoskeletalFrame::balance(const Eigen::Ref<const Eigen::VectorXd>& others) {
  for (std::size_t i = 0; i < muscles_.size(); ++i) {
    const auto m = static_cast<Eigen::Index>(i);
    strengths_[m] = muscles_[i].strength.strength;
    forces_[m] = muscles_[i].strength.passive;
  }
  passive_.noalias() = moment_arms_ * forces_;
  passive_ += ligament_tau_ + spring_tau_ + others;
  for (std::size_t j = 0; j < balanced_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    loads_[row] = dynamics_.generalised_forces()[balanced_[j]] - passive_[balanced_[j]];
    arms_.row(row) = moment_arms_.row(balanced_[j]);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const double share = coupling_(row, static_cast<Eigen::Index>(i));
      if (share == 0.0) continue;
      loads_[row] += share * (dynamics_.generalised_forces()[columns_[i]] - passive_[columns_[i]]);
      arms_.row(row) += share * moment_arms_.row(columns_[i]);
    }
  }
}

void MusculoskeletalFrame::finish() {
  residual_.noalias() = moment_arms_ * active_;
  residual_ = dynamics_.generalised_forces() - passive_ - residual_;
  forces_ += active_;
}

const recruitment::Recruitment& MusculoskeletalFrame::recruit() { return recruit(no_others_); }

const recruitment::Recruitment& MusculoskeletalFrame::recruit(
    const Eigen::Ref<const Eigen::VectorXd>& others) {
  if (!solver_) {
    throw std::logic_error(model_label(model_->description()) +
                           ": no muscles, or no coordinate that muscles balance: nothing to recruit");
  }
  balance(others);
  const recruitment::RecruitmentFrame now{arms_, loads_, strengths_, minima_};
  const recruitment::Recruitment& result =
      warm_ ? solver_->solve(now, solver_->warm_start()) : solver_->solve(now);
  warm_ = true;
  active_ = result.forces;
  finish();
  return result;
}

void MusculoskeletalFrame::leave_passive(const Eigen::Ref<const Eigen::VectorXd>& others) {
  balance(others);
  active_.setZero();
  finish();
}

// Adds ∂(R tension)/∂q_c of one muscle at fixed tension: −H tension.
void MusculoskeletalFrame::add_tension_derivative(std::size_t muscle, double tension,
                                                  Eigen::Ref<Eigen::MatrixXd> derivative) const {
  const auto coordinates = paths_[muscle].coordinates();
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    derivative.row(coordinates[k]) -= tension * hessians_[muscle].row(static_cast<Eigen::Index>(k));
  }
}

void MusculoskeletalFrame::differentiate_recruitment() {
  const auto k = static_cast<Eigen::Index>(balanced_.size());
  for (std::size_t j = 0; j < balanced_.size(); ++j) {
    const int b = balanced_[j];
    auto column = load_rates_.col(static_cast<Eigen::Index>(j));
    column = (dynamics_rates_.row(b) - passive_rates_.row(b) - other_rates_.row(b)).transpose();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const int a = columns_[i];
      column += coupling_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) *
                (dynamics_rates_.row(a) - passive_rates_.row(a) - other_rates_.row(a)).transpose();
    }
  }
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (!moves_[i]) continue;
    const auto m = static_cast<Eigen::Index>(i);
    const model::MuscleStrength& now = muscles_[i].strength;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const auto column = static_cast<Eigen::Index>(c);
      const int own = paths_[i].coordinate_index(columns_[c]);
      double rate = own < 0 ? 0.0 : now.strength_by_length * gradients_[i][own];
      rate += now.strength_by_velocity * paths_[i].velocity(kinematics_, hessians_[i].col(column));
      strength_rates_(column, m) = rate;
    }
    // −∂(R_b + C R_α)/∂q_c of this muscle: its Hessian's rows, each where its coordinate goes.
    const auto coordinates = paths_[i].coordinates();
    arm_change_.setZero();
    for (std::size_t row = 0; row < coordinates.size(); ++row) {
      const Place place = places_[static_cast<std::size_t>(coordinates[row])];
      const auto hessian = hessians_[i].row(static_cast<Eigen::Index>(row));
      if (place.balanced >= 0) arm_change_.row(place.balanced) += hessian;
      if (place.column >= 0) arm_change_.noalias() += coupling_.col(place.column) * hessian;
    }
    for (Eigen::Index c = 0; c < arm_change_.cols(); ++c) {
      arm_rates_.col(m).segment(c * k, k) = -arm_change_.col(c);
    }
  }
  solver_->forces_along(load_rates_, arm_rates_, strength_rates_, active_rates_, reserve_rates_);
  force_rates_ = active_rates_.transpose();
}

void MusculoskeletalFrame::differentiate_passive() {
  if (passive_differentiated_) return;
  passive_differentiated_ = true;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const model::MuscleStrength& now = muscles_[i].strength;
    if (!moves_[i] || (now.passive == 0.0 && now.passive_by_length == 0.0)) continue;
    add_tension_derivative(i, now.passive, passive_rates_);
    const auto arms = moment_arms_.col(static_cast<Eigen::Index>(i));
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const int own = paths_[i].coordinate_index(columns_[c]);
      if (own < 0) continue;
      passive_rates_.col(static_cast<Eigen::Index>(c)) +=
          (now.passive_by_length * gradients_[i][own]) * arms;
    }
  }
}

void MusculoskeletalFrame::differentiate_held(const Eigen::Ref<const Eigen::MatrixXd>& others,
                                              Eigen::Ref<Eigen::MatrixXd> derivative) {
  differentiate_passive();
  other_rates_ = others;
  derivative = dynamics_rates_ - passive_rates_ - other_rates_;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const double tension = active_[static_cast<Eigen::Index>(i)];
    if (moves_[i] && tension != 0.0) add_tension_derivative(i, -tension, derivative);
  }
}

void MusculoskeletalFrame::differentiate_residual(const Eigen::Ref<const Eigen::MatrixXd>& others,
                                                  Eigen::Ref<Eigen::MatrixXd> derivative) {
  differentiate_held(others, derivative);
  force_rates_.setZero();
  if (!solver_ || !solver_->result().converged()) return;
  differentiate_recruitment();
  derivative.noalias() -= moment_arms_ * force_rates_;
}

bool MusculoskeletalFrame::coupling(const Eigen::Ref<const Eigen::MatrixXd>& held,
                                    Eigen::Ref<Eigen::MatrixXd> C) const {
  const auto k = static_cast<Eigen::Index>(balanced_.size());
  const auto c = static_cast<Eigen::Index>(columns_.size());
  Eigen::MatrixXd K_balanced(k, c), K_columns(c, c);
  for (Eigen::Index j = 0; j < k; ++j) {
    K_balanced.row(j) = held.row(balanced_[static_cast<std::size_t>(j)]);
  }
  for (Eigen::Index j = 0; j < c; ++j) {
    K_columns.row(j) = held.row(columns_[static_cast<std::size_t>(j)]);
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(K_columns.transpose());
  const auto pivots = lu.matrixLU().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > kSingularPivot * pivots.maxCoeff())) return false;
  const Eigen::MatrixXd found = -lu.solve(K_balanced.transpose()).transpose();
  if (!found.allFinite()) return false;
  C = found;
  return true;
}

}  // namespace condyle::fdk
