// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/force_dependent.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "condyle/fdk/substeps.hpp"

namespace condyle::fdk {
namespace {

using numerics::LoadKind;
using numerics::NewtonResult;
using numerics::Unknowns;
using Clock = std::chrono::steady_clock;

// The way of one time frame; counts over all attempts go to the record.
class Search {
 public:
  Search(MuscleEquilibrium& problem, const ForceDependentSettings& settings)
      : problem_(problem), settings_(settings) {}

  ForceDependentRecord run(const FrameInstant& goal, std::span<const Unknowns> starts,
                           const Anchor* last) {
    const auto began = Clock::now();
    problem_.reset_seconds();
    problem_.soften_contact(1.0);
    problem_.uncouple_recruitment();
    if (settings_.max_sharing_updates > 0 && last != nullptr && last->coupling.size() > 0) {
      problem_.use_coupling(last->coupling);
    }
    first_coupling_ = problem_.frame().used_coupling();
    const bool found = from_starts(goal, starts) || (last != nullptr && in_substeps(goal, *last)) ||
                       from_softer_contact(goal, starts) || uncoupled(goal, starts);
    finish(goal, found);
    // What the phases did not take is linear algebra.
    record_.seconds = problem_.seconds();
    double phases = 0.0;
    for (const double seconds : record_.seconds) phases += seconds;
    const double all = std::chrono::duration<double>(Clock::now() - began).count();
    record_.seconds[static_cast<std::size_t>(Phase::kLinearAlgebra)] += std::max(0.0, all - phases);
    return std::move(record_);
  }

 private:
  // Newton's iteration from the problem's present C.
  NewtonResult newton(const FrameInstant& instant, const Unknowns& start) {
    hold(instant);
    problem_.follow_sharing(uncoupled_ ? 0 : settings_.max_sharing_updates,
                            settings_.sharing_tolerance * settings_.newton.force_tolerance,
                            settings_.sharing_tolerance * settings_.newton.moment_tolerance);
    return count(numerics::solve_newton(problem_, start, settings_.newton));
  }

  void hold(const FrameInstant& instant) {
    if (held_ == &instant) return;
    problem_.set_frame(instant.motion());
    held_ = &instant;
  }

  NewtonResult count(NewtonResult result) {
    record_.iterations += result.statistics.iterations;
    record_.evaluations += result.statistics.evaluations;
    record_.regularised_steps += result.statistics.regularised_steps;
    return result;
  }

  // The attempt at the time frame itself whose residual is smallest.
  bool attempt(const FrameInstant& goal, const Unknowns& start, Approach approach, int index) {
    NewtonResult result = newton(goal, start);
    const double residual = result.statistics.residual.back();
    if (result.converged() || !kept_ || residual < kept_residual_) {
      kept_ = true;
      kept_residual_ = std::isfinite(residual) ? residual : std::numeric_limits<double>::infinity();
      record_.newton = result.status;
      record_.approach = approach;
      record_.start = index;
      record_.alpha = result.alpha;
      record_.worst_coordinate = result.worst_coordinate;
      record_.history = std::move(result.statistics.residual);
      record_.sharing_updates = problem_.sharing_updates();
      record_.sharing_change = settings_.sharing_tolerance * problem_.sharing_change();
      record_.sharing_settled = record_.sharing_change <= settings_.sharing_tolerance;
      coupling_ = problem_.frame().used_coupling();
    }
    return result.converged();
  }

  bool from_starts(const FrameInstant& goal, std::span<const Unknowns> starts) {
    for (std::size_t i = 0; i < starts.size(); ++i) {
      problem_.use_coupling(first_coupling_);
      if (attempt(goal, starts[i], Approach::kStart, static_cast<int>(i))) return true;
    }
    return false;
  }

  bool in_substeps(const FrameInstant& goal, const Anchor& last) {
    problem_.use_coupling(first_coupling_);
    Unknowns here = last.alpha;
    const Substeps way = go_in_substeps(settings_.max_substeps, [&](double t) {
      if (t == 1.0) return attempt(goal, here, Approach::kSubsteps, 0);
      const FrameInstant part = between(last.instant, goal, t);
      const NewtonResult result = newton(part, here);
      held_ = nullptr;
      if (result.converged()) here = result.alpha;
      return result.converged();
    });
    record_.substeps = way.taken;
    return way.reached;
  }

  bool from_softer_contact(const FrameInstant& goal, std::span<const Unknowns> starts) {
    if (settings_.softer_contact.empty()) return false;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      problem_.use_coupling(first_coupling_);
      Unknowns here = starts[i];
      for (const double share : settings_.softer_contact) {
        problem_.soften_contact(share);
        const NewtonResult result = newton(goal, here);
        if (result.alpha.allFinite()) here = result.alpha;
      }
      problem_.soften_contact(1.0);
      if (attempt(goal, here, Approach::kSofterContact, static_cast<int>(i))) return true;
    }
    return false;
  }

  // An end that muscles cannot carry is none: what was kept before it stays.
  bool uncoupled(const FrameInstant& goal, std::span<const Unknowns> starts) {
    if (!settings_.uncoupled || settings_.max_sharing_updates == 0) return false;
    if (!problem_.frame().recruits()) return false;
    ForceDependentRecord kept = record_;
    const Eigen::MatrixXd kept_coupling = coupling_;
    uncoupled_ = true;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      problem_.uncouple_recruitment();
      if (attempt(goal, starts[i], Approach::kUncoupled, static_cast<int>(i)) &&
          problem_.recruited()->converged()) {
        record_.sharing_settled = false;
        return true;
      }
    }
    kept.iterations = record_.iterations;
    kept.evaluations = record_.evaluations;
    kept.regularised_steps = record_.regularised_steps;
    record_ = std::move(kept);
    coupling_ = kept_coupling;
    return false;
  }

  void finish(const FrameInstant& goal, bool found) {
    hold(goal);
    problem_.use_coupling(coupling_);
    const int n = problem_.size();
    record_.residual.resize(n);
    numerics::Jacobian J(n, n);
    problem_.residual_and_jacobian(record_.alpha, record_.residual, J);
    ++record_.evaluations;
    record_.worst_name = problem_.coordinate_name(record_.worst_coordinate);
    const Eigen::ColPivHouseholderQR<numerics::Jacobian> qr(J);
    const Unknowns remaining = qr.solve(record_.residual);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const bool regular = qr.isInvertible() && remaining.allFinite();
    for (int i = 0; i < n; ++i) {
      const bool force = problem_.load_kind(i) == LoadKind::kForce;
      double& way = force ? record_.remaining_m : record_.remaining_rad;
      way = regular ? std::max(way, std::abs(remaining[i])) : nan;
      double& least = force ? record_.attainable_force : record_.attainable_moment;
      least = std::max(least, std::numeric_limits<double>::epsilon() * J.row(i).cwiseAbs().sum());
    }
    if (problem_.recruited() != nullptr) record_.recruitment = problem_.recruited()->status;
    bool implausible = false;
    for (const BodyContact& contact : problem_.contacts()) {
      implausible = implausible || contact.loads().implausible_depth;
      record_.least_trust = std::min(record_.least_trust, contact.loads().trust);
    }
    if (!found) {
      record_.status = ForceDependentStatus::kNotConverged;
    } else if (record_.recruitment != recruitment::RecruitmentStatus::kConverged) {
      record_.status = ForceDependentStatus::kRecruitmentFailed;
    } else {
      record_.status =
          implausible ? ForceDependentStatus::kImplausibleDepth : ForceDependentStatus::kConverged;
    }
    record_.message = message();
  }

  std::string message() const {
    std::ostringstream text;
    text << advice(record_.status);
    if (record_.status == ForceDependentStatus::kNotConverged) {
      const bool force = problem_.load_kind(record_.worst_coordinate) == LoadKind::kForce;
      text << "; " << record_.residual[record_.worst_coordinate] << (force ? " N" : " Nm")
           << " remain on " << record_.worst_name << " (" << name(record_.newton) << ", "
           << record_.iterations << " steps)";
    }
    if (record_.recruitment != recruitment::RecruitmentStatus::kConverged) {
      text << "; recruitment: " << problem_.recruitment_message();
    }
    return text.str();
  }

  MuscleEquilibrium& problem_;
  const ForceDependentSettings& settings_;
  ForceDependentRecord record_;
  const FrameInstant* held_ = nullptr;  // by the problem
  Eigen::MatrixXd first_coupling_;      // C that attempts begin with
  Eigen::MatrixXd coupling_;            // of the attempt kept
  bool uncoupled_ = false;
  bool kept_ = false;
  double kept_residual_ = 0.0;
};

}  // namespace

std::string_view name(ForceDependentStatus status) {
  switch (status) {
    case ForceDependentStatus::kConverged:
      return "converged";
    case ForceDependentStatus::kNotConverged:
      return "not_converged";
    case ForceDependentStatus::kRecruitmentFailed:
      return "recruitment_failed";
    case ForceDependentStatus::kImplausibleDepth:
      return "implausible_depth";
  }
  return "unknown";
}

std::string_view advice(ForceDependentStatus status) {
  switch (status) {
    case ForceDependentStatus::kConverged:
      return "converged: the residual forces and moments are within their tolerances";
    case ForceDependentStatus::kNotConverged:
      return "not converged: give a start nearer to equilibrium, raise max_iterations or "
             "max_substeps, or check that "
             "contact, ligaments and muscles can carry the loads";
    case ForceDependentStatus::kRecruitmentFailed:
      return "the residuals are within their tolerances, but muscles cannot carry the loads: add "
             "reserve actuators, "
             "or check strengths, motion and external loads";
    case ForceDependentStatus::kImplausibleDepth:
      return "in equilibrium, but overlapping deeper than plausible: check the loads, the pressure "
             "modulus and the "
             "implant's placement";
  }
  return "unknown status";
}

std::string_view name(Approach approach) {
  switch (approach) {
    case Approach::kStart:
      return "start";
    case Approach::kSubsteps:
      return "substeps";
    case Approach::kSofterContact:
      return "softer_contact";
    case Approach::kUncoupled:
      return "uncoupled";
    case Approach::kFromOtherSide:
      return "from_other_side";
  }
  return "unknown";
}

void require_valid(const ForceDependentSettings& settings) {
  numerics::require_valid(settings.newton);
  const auto refuse = [](const char* setting, double value, const char* limit) {
    std::ostringstream text;
    text << "force-dependent settings: " << setting << " is " << value << ": must be " << limit;
    throw std::invalid_argument(text.str());
  };
  if (settings.max_substeps < 1) refuse("max_substeps", settings.max_substeps, "at least 1");
  if (settings.max_sharing_updates < 0)
    refuse("max_sharing_updates", settings.max_sharing_updates, "at least 0");
  if (!(settings.sharing_tolerance > 0.0))
    refuse("sharing_tolerance", settings.sharing_tolerance, "above 0");
  double last = 0.0;
  for (const double share : settings.softer_contact) {
    if (!(share > last && share < 1.0))
      refuse("softer_contact", share, "above 0, below 1 and rising");
    last = share;
  }
}

FrameInstant between(const FrameInstant& a, const FrameInstant& b, double t) {
  FrameInstant mixed = b;
  mixed.q = (1.0 - t) * a.q + t * b.q;
  mixed.qd = (1.0 - t) * a.qd + t * b.qd;
  mixed.qdd = (1.0 - t) * a.qdd + t * b.qdd;
  for (std::size_t i = 0; i < mixed.loads.size() && a.loads.size() == b.loads.size(); ++i) {
    const auto about_origin = [](const model::ExternalLoad& load) -> Vector3 {
      return load.moment_G + load.point_G.cross(load.force_G);
    };
    mixed.loads[i].force_G = (1.0 - t) * a.loads[i].force_G + t * b.loads[i].force_G;
    mixed.loads[i].moment_G = (1.0 - t) * about_origin(a.loads[i]) + t * about_origin(b.loads[i]);
    mixed.loads[i].point_G.setZero();
  }
  return mixed;
}

ForceDependentRecord solve_force_dependent(MuscleEquilibrium& problem, const FrameInstant& goal,
                                           std::span<const Unknowns> starts, const Anchor* last,
                                           const ForceDependentSettings& settings) {
  require_valid(settings);
  if (starts.empty()) throw std::invalid_argument("force-dependent kinematics: no start is given");
  return Search(problem, settings).run(goal, starts, last);
}

Unknowns seated_start(MuscleEquilibrium& problem, const FrameInstant& instant,
                      const Unknowns& start, std::size_t contact, const SeatingSettings& settings) {
  constexpr int kSteps = 20;
  constexpr double kReached = 1e-9;  // [m, rad]: well below first touch's own accuracy
  if (contact >= problem.contacts().size()) {
    throw std::invalid_argument("seated start: contact " + std::to_string(contact) + " of " +
                                std::to_string(problem.contacts().size()));
  }
  const BodyContact& joint = problem.contacts()[contact];
  problem.set_frame(instant.motion());
  problem.place(start);
  const double flexion = -joint.pose(problem.frame().kinematics())[kThetaZ];
  const SeatedPose seat = seated_pose(joint.model(), flexion, settings);
  if (!seat.converged()) return start;
  Eigen::MatrixXd rates(6, problem.size());
  Unknowns alpha = start;
  for (int step = 0; step < kSteps; ++step) {
    const Pose now = joint.pose(problem.frame().kinematics());
    const Eigen::Matrix<double, 5, 1> away = (seat.pose - now).head<5>();
    if (away.cwiseAbs().maxCoeff() < kReached) return alpha;
    joint.pose_derivative(problem.frame().kinematics(), rates);
    alpha += rates.topRows<5>().completeOrthogonalDecomposition().solve(away);
    if (!alpha.allFinite()) break;
    problem.place(alpha);
  }
  return start;
}

}  // namespace condyle::fdk
