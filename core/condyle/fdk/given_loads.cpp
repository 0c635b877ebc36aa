// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "condyle/fdk/substeps.hpp"

namespace condyle::fdk {
namespace {

constexpr std::array<const char*, 5> kCoordinate{"x", "y", "z", "theta_x", "theta_y"};
constexpr std::array<const char*, 5> kUnit{"N", "N", "N", "Nm", "Nm"};

// The last equilibrium found: where the next time frame starts from.
struct Anchor {
  Pose pose;
  GivenLoadsFrame frame;
};

class Solver {
 public:
  Solver(const contact::ContactModel& contact, const GivenLoadsSetup& setup,
         const GivenLoadsSettings& settings)
      : contact_(contact),
        setup_(setup),
        settings_(settings),
        muscles_(setup.muscles, settings.recruitment) {}

  /// One equilibrium from a start pose; true where found, with `result` holding it either way.
  bool solve(const GivenLoadsFrame& frame, const Pose& start, GivenLoadsResult& result) {
    GivenLoadsEquilibrium problem(contact_, setup_, muscles_, frame);
    const numerics::NewtonResult newton =
        solve_newton(problem, problem.unknowns(start), settings_.newton);
    result.iterations += newton.statistics.iterations;
    result.evaluations += newton.statistics.evaluations;
    result.pose = problem.pose(newton.alpha);
    result.worst_coordinate = kSecondary[static_cast<std::size_t>(newton.worst_coordinate)];
    newton_ = newton.status;
    return newton.converged();
  }

  /// From `anchor` to `goal` in substeps.
  bool continue_to(const GivenLoadsFrame& goal, const Anchor& anchor, GivenLoadsResult& result) {
    Pose here = anchor.pose;
    const Substeps way = go_in_substeps(settings_.max_substeps, [&](double t) {
      const bool found = solve(t < 1.0 ? between(anchor.frame, goal, t) : goal, here, result);
      if (found) here = result.pose;
      return found;
    });
    result.substeps = way.taken;
    // Report the time frame that was asked for, not a substep of it.
    return way.reached || solve(goal, here, result);
  }

  /// Everything at the pose found, computed once more there.
  void finish(const GivenLoadsFrame& frame, bool converged, GivenLoadsResult& result) {
    GivenLoadsEquilibrium problem(contact_, setup_, muscles_, frame);
    numerics::Unknowns r(5);
    numerics::Jacobian J(5, 5);
    problem.residual_and_jacobian(problem.unknowns(result.pose), r, J);
    ++result.evaluations;
    result.residual = r;
    result.loads = problem.loads();
    const recruitment::Recruitment& muscles = problem.muscles();
    result.muscle_forces = muscles.forces;
    result.activities = muscles.activities;
    result.reserves = muscles.reserves;
    result.unmet = muscles.unmet;
    for (const model::Ligament& ligament : setup_.ligaments) {
      result.ligament_tensions.push_back(tension(ligament, length(ligament, result.pose)));
    }
    result.clinical = clinical_kinematics(result.pose, contact_.side_of_body());
    judge(converged, muscles, result);
  }

 private:
  void judge(bool converged, const recruitment::Recruitment& muscles, GivenLoadsResult& result) {
    if (!muscles.converged()) {
      const bool infeasible = muscles.status == recruitment::RecruitmentStatus::kInfeasible;
      result.status =
          infeasible ? GivenLoadsStatus::kInfeasible : GivenLoadsStatus::kNotConverged;
      result.message = muscles_.message();
    } else if (!converged) {
      result.status = GivenLoadsStatus::kNotConverged;
      std::ostringstream text;
      const int k = result.worst_coordinate;
      text << "residual " << result.residual[k] << ' ' << kUnit[static_cast<std::size_t>(k)]
           << " on " << kCoordinate[static_cast<std::size_t>(k)] << ": "
           << numerics::advice(newton_);
      result.message = text.str();
    } else if (result.loads.implausible_depth) {
      result.status = GivenLoadsStatus::kImplausibleDepth;
      result.message = advice(result.status);
    } else {
      result.status = GivenLoadsStatus::kConverged;
    }
  }

  const contact::ContactModel& contact_;
  const GivenLoadsSetup& setup_;
  const GivenLoadsSettings& settings_;
  recruitment::RecruitmentSolver muscles_;
  numerics::NewtonStatus newton_ = numerics::NewtonStatus::kConverged;
};

// Where the femur sits without loads; where seating fails, the settled pose, however far it came: the first time
// frame's status then tells.
Pose first_start(const contact::ContactModel& contact, double flexion,
                 const GivenLoadsSettings& settings) {
  if (settings.initial_pose) return *settings.initial_pose;
  const SeatedPose seat = seated_pose(contact, flexion, settings.seating);
  if (seat.converged()) return seat.pose;
  return settled_pose(contact, flexion, settings.seating.settle).pose;
}

void count(const GivenLoadsResult& result, double least_trust, GivenLoadsSimulation& simulation) {
  simulation.not_converged += result.status == GivenLoadsStatus::kNotConverged ? 1 : 0;
  simulation.infeasible += result.status == GivenLoadsStatus::kInfeasible ? 1 : 0;
  simulation.implausible += result.status == GivenLoadsStatus::kImplausibleDepth ? 1 : 0;
  simulation.untrusted += result.loads.trust < least_trust ? 1 : 0;
}

}  // namespace

std::string_view name(GivenLoadsStatus status) {
  switch (status) {
    case GivenLoadsStatus::kConverged: return "converged";
    case GivenLoadsStatus::kNotConverged: return "not_converged";
    case GivenLoadsStatus::kImplausibleDepth: return "implausible_depth";
    case GivenLoadsStatus::kInfeasible: return "infeasible";
  }
  return "unknown";
}

std::string_view advice(GivenLoadsStatus status) {
  switch (status) {
    case GivenLoadsStatus::kConverged:
      return "converged: residual forces and moments are within their tolerances";
    case GivenLoadsStatus::kNotConverged:
      return "not converged: check that contact, ligaments and muscles can carry these loads, and their "
             "signs; raise max_iterations or max_substeps, or give time frames more densely";
    case GivenLoadsStatus::kImplausibleDepth:
      return "in equilibrium, but deeper than the plausible depth: check the loads and the pressure "
             "modulus";
    case GivenLoadsStatus::kInfeasible:
      return "muscles within their bounds cannot balance the loads: check strengths and the signs of "
             "loads and moment arms, or allow reserves";
  }
  return "unknown status";
}

void require_valid(const GivenLoadsSettings& settings) {
  const auto refuse = [](const char* setting, double value, const char* limit) {
    throw std::invalid_argument("given loads settings: " + std::string(setting) + " is " +
                                std::to_string(value) + ": must be " + limit);
  };
  require_valid(settings.newton);
  if (settings.max_substeps < 1) refuse("max_substeps", settings.max_substeps, "at least 1");
  if (!(settings.least_trust >= 0.0 && settings.least_trust <= 1.0)) {
    refuse("least_trust", settings.least_trust, "within 0 and 1");
  }
  if (settings.initial_pose) contact::require_finite(*settings.initial_pose);
}

std::string summary(const GivenLoadsSimulation& simulation) {
  std::ostringstream text;
  const std::size_t size = simulation.frames.size();
  text << size - static_cast<std::size_t>(simulation.not_converged + simulation.infeasible)
       << " of " << size << " time frames converged";
  if (simulation.infeasible > 0) {
    text << ", " << simulation.infeasible << " asked too much of the muscles";
  }
  if (simulation.implausible > 0) {
    text << ", " << simulation.implausible << " of them deeper than plausible";
  }
  if (simulation.untrusted > 0) {
    text << "; in " << simulation.untrusted
         << " the contact model does not trust itself (widen its sampled domains, or use the "
            "reference or hybrid contact)";
  }
  for (std::size_t i = 0; i < size; ++i) {
    const GivenLoadsResult& frame = simulation.frames[i];
    if (frame.status != GivenLoadsStatus::kNotConverged &&
        frame.status != GivenLoadsStatus::kInfeasible) {
      continue;
    }
    text << "; the first not: time frame " << i << ", " << frame.message;
    break;
  }
  return text.str();
}

GivenLoadsSimulation solve_given_loads(const contact::ContactModel& contact,
                                       const GivenLoadsSetup& setup,
                                       std::span<const GivenLoadsFrame> frames,
                                       const GivenLoadsSettings& settings) {
  require_valid(settings);
  require_valid(setup, contact);
  if (frames.empty()) throw std::invalid_argument("given loads: there are no time frames");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    require_valid(frames[i], setup, i);
    if (frames[i].minima.size() != frames[0].minima.size() ||
        frames[i].arms_by_pose.rows() != frames[0].arms_by_pose.rows()) {
      throw std::invalid_argument("given loads: time frame " + std::to_string(i) +
                                  ": minima and arms_by_pose must be given in all time frames or "
                                  "in none");
    }
  }
  Solver solver(contact, setup, settings);

  Anchor anchor{first_start(contact, frames[0].flexion, settings), unloaded(frames[0])};
  GivenLoadsSimulation simulation;
  simulation.frames.resize(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    GivenLoadsResult& result = simulation.frames[i];
    const bool converged = solver.solve(frames[i], anchor.pose, result) ||
                           solver.continue_to(frames[i], anchor, result);
    solver.finish(frames[i], converged, result);
    if (converged) anchor = {result.pose, frames[i]};
    count(result, settings.least_trust, simulation);
  }
  return simulation;
}

}  // namespace condyle::fdk
