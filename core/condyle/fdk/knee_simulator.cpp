// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/knee_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "condyle/fdk/substeps.hpp"

namespace condyle::fdk {
namespace {

constexpr std::array<int, 5> kUnknown{kX, kY, kZ, kThetaX, kThetaY};
constexpr std::array<const char*, 5> kCoordinate{"x", "y", "z", "theta_x", "theta_y"};
constexpr std::array<const char*, 5> kUnit{"N", "N", "N", "Nm", "Nm"};

// Flexion and loads of one instant: what continuation interpolates.
struct Instant {
  double flexion = 0.0;
  KneeLoad load;
};

Instant instant_of(const LoadCase& c, std::size_t i) {
  return {c.flexion[i], {c.axial_force[i], c.ap_force[i], c.ie_torque[i]}};
}

Instant between(const Instant& a, const Instant& b, double t) {
  const auto mix = [t](double u, double v) { return u + t * (v - u); };
  return {mix(a.flexion, b.flexion),
          {mix(a.load.axial_force, b.load.axial_force), mix(a.load.ap_force, b.load.ap_force),
           mix(a.load.ie_torque, b.load.ie_torque)}};
}

// The last equilibrium found: where the next time frame starts from.
struct Anchor {
  Pose pose;
  Instant instant;
};

class Simulator {
 public:
  Simulator(const KneeSetup& setup, const KneeSimulatorSettings& settings)
      : setup_(setup), settings_(settings) {}

  /// One equilibrium from a start pose; true where converged, with `frame` holding it either way.
  bool solve(const Instant& instant, const Pose& start, KneeFrame& frame) const {
    Pose pose = start;
    pose[kThetaZ] = -instant.flexion;
    KneeEquilibrium problem(setup_, instant.load, pose, kUnknown);
    const numerics::NewtonResult newton =
        solve_newton(problem, problem.unknowns(pose), settings_.newton);
    frame.iterations += newton.statistics.iterations;
    frame.evaluations += newton.statistics.evaluations;
    frame.pose = problem.pose(newton.alpha);
    frame.residual = newton.residual;
    frame.worst_coordinate = kUnknown[static_cast<std::size_t>(newton.worst_coordinate)];
    return newton.converged();
  }

  /// From `anchor` to `goal` in substeps.
  bool continue_to(const Instant& goal, const Anchor& anchor, KneeFrame& frame) const {
    Pose here = anchor.pose;
    const Substeps way = go_in_substeps(settings_.max_substeps, [&](double t) {
      const bool found =
          solve(t < 1.0 ? between(anchor.instant, goal, t) : goal, here, frame);
      if (found) here = frame.pose;
      return found;
    });
    frame.substeps = way.taken;
    // Report the time frame that was asked for, not a substep of it.
    return way.reached || solve(goal, here, frame);
  }

  void finish(bool converged, KneeFrame& frame) const {
    frame.loads = setup_.contact.evaluate(frame.pose, contact::Derivatives::kStiffness);
    ++frame.evaluations;
    frame.clinical = clinical_kinematics(frame.pose, setup_.contact.side_of_body());
    if (!converged) {
      frame.status = FrameStatus::kNotConverged;
    } else if (frame.loads.implausible_depth) {
      frame.status = FrameStatus::kImplausibleDepth;
    } else {
      frame.status = FrameStatus::kConverged;
    }
  }

 private:
  const KneeSetup& setup_;
  const KneeSimulatorSettings& settings_;
};

// The springs' references: as given, else of the settled pose at zero flexion.
RestraintSprings with_references(const contact::ContactModel& model,
                                 const KneeSimulatorSettings& settings) {
  RestraintSprings springs = settings.restraint;
  if (springs.reference_x && springs.reference_z && springs.reference_theta_y) return springs;
  Pose settled = Pose::Zero();
  const bool needed = (!springs.reference_x && springs.ap_stiffness > 0.0) ||
                      (!springs.reference_z && springs.ml_stiffness > 0.0);
  if (needed) settled = settled_pose(model, 0.0, settings.settle).pose;
  if (!springs.reference_x) springs.reference_x = settled[kX];
  if (!springs.reference_z) springs.reference_z = settled[kZ];
  if (!springs.reference_theta_y) springs.reference_theta_y = 0.0;
  return springs;
}

}  // namespace

std::string_view name(FrameStatus status) {
  switch (status) {
    case FrameStatus::kConverged: return "converged";
    case FrameStatus::kNotConverged: return "not_converged";
    case FrameStatus::kImplausibleDepth: return "implausible_depth";
  }
  return "unknown";
}

std::string_view advice(FrameStatus status) {
  switch (status) {
    case FrameStatus::kConverged:
      return "converged: the residual forces and moments are within their tolerances";
    case FrameStatus::kNotConverged:
      return "not converged: check that restraints and implant can carry these loads, raise "
             "max_iterations or max_substeps, or resolve the load case more finely in time";
    case FrameStatus::kImplausibleDepth:
      return "in equilibrium, but deeper than the plausible depth: reduce the load, or check the "
             "pressure modulus";
  }
  return "unknown status";
}

void require_valid(const KneeSimulatorSettings& settings) {
  const auto refuse = [](const char* setting, double value, const char* limit) {
    throw std::invalid_argument("knee simulator settings: " + std::string(setting) + " is " +
                                std::to_string(value) + ": must be " + limit);
  };
  require_valid(settings.newton);
  require_valid(settings.restraint);
  require_valid(settings.settle.touch);
  for (const model::Ligament& ligament : settings.ligaments) require_valid(ligament);
  if (!(settings.insert_width > 0.0 && settings.insert_width < 0.3)) {
    refuse("insert_width", settings.insert_width, "above 0 and below 0.3 [m]");
  }
  if (!(std::abs(settings.axial_offset_ratio) <= 0.5)) {
    refuse("axial_offset_ratio", settings.axial_offset_ratio, "within ±0.5 [-]");
  }
  if (settings.max_substeps < 1) {
    refuse("max_substeps", settings.max_substeps, "at least 1");
  }
  if (!(settings.least_trust >= 0.0 && settings.least_trust <= 1.0)) {
    refuse("least_trust", settings.least_trust, "within 0 and 1");
  }
  if (settings.initial_pose) contact::require_finite(*settings.initial_pose);
}

std::string summary(const KneeSimulation& simulation) {
  std::ostringstream text;
  const std::size_t count = simulation.frames.size();
  text << count - static_cast<std::size_t>(simulation.not_converged) << " of " << count
       << " time frames converged";
  if (simulation.implausible > 0) {
    text << ", " << simulation.implausible << " of them deeper than plausible";
  }
  if (simulation.untrusted > 0) {
    text << "; in " << simulation.untrusted
         << " the contact model does not trust itself (widen its sampled domains, or use the "
            "reference or hybrid contact)";
  }
  for (std::size_t i = 0; i < count; ++i) {
    const KneeFrame& frame = simulation.frames[i];
    if (frame.status != FrameStatus::kNotConverged) continue;
    const auto worst = static_cast<std::size_t>(
        std::find(kUnknown.begin(), kUnknown.end(), frame.worst_coordinate) - kUnknown.begin());
    text << "; first not converged: time frame " << i << ", residual "
         << frame.residual[static_cast<int>(worst)] << ' ' << kUnit[worst] << " on "
         << kCoordinate[worst];
    break;
  }
  return text.str();
}

KneeSimulation simulate_knee(const contact::ContactModel& model, const LoadCase& load_case,
                             const KneeSimulatorSettings& settings) {
  require_valid(load_case, "given");
  require_valid(settings);
  KneeSimulation simulation;
  simulation.restraint = with_references(model, settings);
  simulation.axial_offset = settings.axial_offset_ratio * settings.insert_width;
  const KneeSetup setup{model, simulation.axial_offset, simulation.restraint, settings.ligaments};
  const Simulator simulator(setup, settings);

  // The first start: given, or the settled pose, where only the light settling load acts.
  Anchor anchor{Pose::Zero(), instant_of(load_case, 0)};
  if (settings.initial_pose) {
    anchor.pose = *settings.initial_pose;
  } else {
    anchor.pose = settled_pose(model, load_case.flexion[0], settings.settle).pose;
    anchor.instant.load = {settings.settle.axial_force, 0.0, 0.0};
  }
  simulation.frames.resize(load_case.size());
  for (std::size_t i = 0; i < load_case.size(); ++i) {
    KneeFrame& frame = simulation.frames[i];
    const Instant instant = instant_of(load_case, i);
    const bool converged = simulator.solve(instant, anchor.pose, frame) ||
                           simulator.continue_to(instant, anchor, frame);
    simulator.finish(converged, frame);
    if (converged) anchor = {frame.pose, instant};
    simulation.not_converged += converged ? 0 : 1;
    simulation.implausible += frame.status == FrameStatus::kImplausibleDepth ? 1 : 0;
    simulation.untrusted += frame.loads.trust < settings.least_trust ? 1 : 0;
  }
  return simulation;
}

}  // namespace condyle::fdk
