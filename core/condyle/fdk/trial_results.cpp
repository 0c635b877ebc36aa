// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/trial_results.hpp"

#include <initializer_list>
#include <sstream>

namespace condyle::fdk {
namespace {

void keep_bodies(const MuscleEquilibrium& problem, Eigen::Index row, TrialSimulation& out) {
  const model::Kinematics& kinematics = problem.frame().kinematics();
  out.q.row(row) = kinematics.q().transpose();
  for (int body = 0; body < kinematics.model().n_bodies(); ++body) {
    const RigidTransform& X_GB = kinematics.X_GB(body);
    auto place = out.segment_poses.row(row).segment<12>(12 * body);
    for (int i = 0; i < 3; ++i) place.segment<3>(3 * i) = X_GB.R.row(i);
    place.tail<3>() = X_GB.p.transpose();
  }
}

void keep_contacts(const MuscleEquilibrium& problem, Eigen::Index row, TrialSimulation& out) {
  for (std::size_t i = 0; i < problem.contacts().size(); ++i) {
    const BodyContact& contact = problem.contacts()[i];
    const auto c = static_cast<Eigen::Index>(i);
    out.contact_poses.row(row).segment<6>(6 * c) = contact.pose().transpose();
    out.contact_trust(row, c) = contact.loads().trust;
    for (int side = 0; side < kSides; ++side) {
      const auto s = static_cast<std::size_t>(side);
      out.contact_wrenches.row(row).segment<6>(12 * c + 6 * side) =
          contact.loads().wrench[s].transpose();
      out.contact_errors.row(row).segment<6>(12 * c + 6 * side) =
          contact.loads().error[s].transpose();
    }
  }
  out.contact_loads.row(row) = problem.contact_forces().transpose();
}

void keep_muscles(const MuscleEquilibrium& problem, Eigen::Index row, TrialSimulation& out) {
  const MusculoskeletalFrame& frame = problem.frame();
  for (std::size_t i = 0; i < frame.muscles().size(); ++i) {
    const auto m = static_cast<Eigen::Index>(i);
    out.muscle_lengths(row, m) = frame.muscles()[i].length;
    out.muscle_strengths(row, m) = frame.muscles()[i].strength.strength;
    out.passive_forces(row, m) = frame.muscles()[i].strength.passive;
  }
  out.muscle_forces.row(row) = frame.muscle_forces().transpose();
  if (problem.recruited() != nullptr) {
    out.activities.row(row) = problem.recruited()->activities.transpose();
    out.reserves.row(row) = problem.recruited()->reserves.transpose();
  }
}

}  // namespace

TrialSimulation empty_results(const model::Model& model, const MuscleEquilibrium& problem,
                              Eigen::Index frames) {
  TrialSimulation out;
  out.force_dependent.assign(problem.force_dependent().begin(), problem.force_dependent().end());
  for (const BodyContact& contact : problem.contacts()) out.contact_names.push_back(contact.name());
  const Eigen::Index n = model.n_coordinates();
  const auto a = static_cast<Eigen::Index>(problem.size());
  const auto c = static_cast<Eigen::Index>(problem.contacts().size());
  const auto m = static_cast<Eigen::Index>(model.description().muscles.size());
  const auto s = static_cast<Eigen::Index>(model.description().ligaments.size());
  const auto room = [&](Eigen::Index columns, std::initializer_list<TimeFrames*> tables) {
    for (TimeFrames* table : tables) table->setZero(frames, columns);
  };
  room(n, {&out.q, &out.contact_loads, &out.generalised_forces, &out.ligament_loads,
           &out.spring_loads, &out.residuals});
  room(a, {&out.alpha, &out.alpha_residuals});
  room(12 * model.n_bodies(), {&out.segment_poses});
  room(6 * c, {&out.contact_poses});
  room(12 * c, {&out.contact_wrenches, &out.contact_errors});
  room(c, {&out.contact_trust});
  room(m, {&out.muscle_lengths, &out.muscle_strengths, &out.passive_forces, &out.muscle_forces,
           &out.activities});
  room(static_cast<Eigen::Index>(problem.frame().balanced().size()), {&out.reserves});
  room(s, {&out.ligament_lengths, &out.ligament_strains, &out.ligament_forces});
  out.records.resize(static_cast<std::size_t>(frames));
  return out;
}

void keep_time_frame(const MuscleEquilibrium& problem, Eigen::Index row, TrialSimulation& out) {
  const MusculoskeletalFrame& frame = problem.frame();
  const ForceDependentRecord& record = out.records[static_cast<std::size_t>(row)];
  keep_bodies(problem, row, out);
  keep_contacts(problem, row, out);
  keep_muscles(problem, row, out);
  out.alpha.row(row) = record.alpha.transpose();
  out.alpha_residuals.row(row) = record.residual.transpose();
  out.generalised_forces.row(row) = frame.generalised_forces().transpose();
  out.ligament_loads.row(row) = frame.ligament_forces().transpose();
  out.spring_loads.row(row) = frame.spring_forces().transpose();
  out.residuals.row(row) = frame.residual().transpose();
  out.ligament_lengths.row(row) = frame.strand_loads().length.transpose();
  out.ligament_strains.row(row) = frame.strand_loads().strain.transpose();
  out.ligament_forces.row(row) = frame.strand_loads().force.transpose();
}

std::string summary(const TrialSimulation& simulation) {
  std::ostringstream text;
  const std::size_t count = simulation.records.size();
  text << count - static_cast<std::size_t>(simulation.not_converged) << " of " << count
       << " time frames converged";
  if (simulation.implausible > 0)
    text << ", " << simulation.implausible << " of them deeper than plausible";
  if (simulation.untrusted > 0) {
    text << "; in " << simulation.untrusted
         << " a contact model does not trust itself (widen its sampled domains, or use the "
            "reference or hybrid contact)";
  }
  for (std::size_t i = 0; i < count; ++i) {
    const ForceDependentRecord& record = simulation.records[i];
    if (record.converged()) continue;
    text << "; first not converged: time frame " << i << ": " << record.message;
    break;
  }
  return text.str();
}

}  // namespace condyle::fdk
