// SPDX-License-Identifier: Apache-2.0
// Force-dependent kinematics of one time frame: from a start to equilibrium, by whatever way leads
// there, and a record of it.
//
// Ways, in this order, until one converges:
//   1. Newton from each start given (a trial's forward run gives its extrapolation first)
//   2. continuation in time: motion and external loads in substeps from the last time frame in
//      equilibrium; loads are mixed as wrenches about ground's origin
//   3. continuation in stiffness: from the first start on a contact whose loads are multiplied by a
//      small share, then larger ones, then 1
//   4. Newton from each start with C = 0 (below): an equilibrium all the same, where muscles can
//      balance their coordinates so, shared as if α were driven
// Where none does, the attempt with the smallest residual is kept, and reported as what it is.
//
// Recruitment takes into account how α gives under the muscles' pull (musculoskeletal_frame.hpp):
// its coupling C is held while Newton's iteration looks for a step, and taken anew at every iterate
// until that changes the residual little (`sharing_tolerance`); from there on it is held, and
// convergence is quadratic. The end is an equilibrium of all coordinates whatever C is; C touches
// only how muscles share. With `max_sharing_updates` = 0, C is 0: muscles share the balanced
// coordinates' loads as if α were driven, which fails where they work through a floating patella.
//
// "In equilibrium" is: every |r_i| within its tolerance (forces and moments apart) AND recruitment
// converged there. What the tolerances mean is in the record: `remaining`, the Newton step J⁻¹ r
// that is left, is how far α still is from equilibrium; `attainable`, ε Σ_j |J_ij| times 1 m or 1
// rad, is what rounding of placements alone leaves of r_i: tolerances below it cannot be met.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/fdk/muscle_equilibrium.hpp"
#include "condyle/fdk/seating.hpp"

namespace condyle::fdk {

struct ForceDependentSettings {
  numerics::NewtonSettings newton;
  int max_sharing_updates = 60;  ///< of C in a Newton iteration; 0: C = 0
  /// C is held where |r_i|, and what a new C changes of it, are within this many tolerances; within
  /// twice as many after five more updates, and so on: where muscles hardly pull it may swing.
  double sharing_tolerance = 10.0;
  int max_substeps = 16;  ///< smallest substep in time is 1/max_substeps; 1: none
  /// Shares, rising, each within (0, 1); empty: none.
  std::vector<double> softer_contact{0.01, 0.1};
  bool uncoupled = true;  ///< whether C = 0 is the last way
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const ForceDependentSettings& settings);

enum class ForceDependentStatus : int {
  kConverged = 0,
  kNotConverged = 1,
  kRecruitmentFailed = 2,  ///< residuals are within tolerance, but muscles cannot carry the loads
  kImplausibleDepth = 3,   ///< in equilibrium, but overlapping deeper than plausible
};
std::string_view name(ForceDependentStatus status);
/// One sentence: what happened, and what the user can do next.
std::string_view advice(ForceDependentStatus status);

/// Which way led to the result; the last one is a trial's (trial_simulation.hpp).
enum class Approach : int { kStart, kSubsteps, kSofterContact, kUncoupled, kFromOtherSide };
std::string_view name(Approach approach);

/// A time frame with everything that is known of it.
struct FrameInstant {
  Eigen::VectorXd q, qd, qdd;  ///< (n_coordinates)
  std::vector<model::ExternalLoad> loads;
  const model::PathSnapshots* snapshots = nullptr;
  std::size_t snapshot_row = 0;

  FrameMotion motion() const { return {q, qd, qdd, loads, snapshots, snapshot_row}; }
};

/// Between two time frames, t in [0, 1]; paths are held as in the second.
FrameInstant between(const FrameInstant& a, const FrameInstant& b, double t);

/// A time frame in equilibrium: where continuation begins.
struct Anchor {
  FrameInstant instant;
  numerics::Unknowns alpha;
  Eigen::MatrixXd coupling;  ///< C there, which the next time frame begins with; empty: 0
};

struct ForceDependentRecord {
  ForceDependentStatus status = ForceDependentStatus::kNotConverged;
  numerics::NewtonStatus newton = numerics::NewtonStatus::kMaxIterations;  ///< of the attempt kept
  Approach approach = Approach::kStart;
  int start = 0;        ///< index of the start that led to the result
  std::string message;  ///< the status in words: coordinates by name, values, what to do
  numerics::Unknowns alpha;
  numerics::Unknowns residual;  ///< net generalised force on α [N, Nm]
  int worst_coordinate = 0;     ///< index among α of the largest |r_i|/tolerance_i
  std::string worst_name;
  std::vector<double> history;  ///< max_i |r_i|/tolerance_i before each step of the last Newton
                                ///< run, and at its end [-]
  int iterations = 0, evaluations = 0, regularised_steps = 0;  ///< of all attempts together
  int substeps = 0;                                            ///< solved in continuation
  int sharing_updates = 0;                                     ///< of C in the attempt kept
  double sharing_change = 0.0;  ///< max |r_i|/tolerance_i that the last C changed [-]
  bool sharing_settled = true;  ///< within the settings' sharing_tolerance, and not `uncoupled`
  double remaining_m = 0.0, remaining_rad = 0.0;  ///< largest |J⁻¹ r|; NaN where J is singular
  double attainable_force = 0.0, attainable_moment = 0.0;  ///< [N, Nm]
  recruitment::RecruitmentStatus recruitment = recruitment::RecruitmentStatus::kConverged;
  double least_trust = 1.0;  ///< of the contacts
  PhaseSeconds seconds{};    ///< where the time went; the only entry that differs between runs

  bool converged() const {
    return status == ForceDependentStatus::kConverged ||
           status == ForceDependentStatus::kImplausibleDepth;
  }
};

/// Solves a time frame. Afterwards `problem` holds the configuration reported, evaluated with
/// derivatives.
/// @param starts at least one α. @param last nullptr: no continuation in time.
/// @throws std::invalid_argument for no start, one of another size or not finite, a setting out of
/// range.
ForceDependentRecord solve_force_dependent(MuscleEquilibrium& problem, const FrameInstant& goal,
                                           std::span<const numerics::Unknowns> starts,
                                           const Anchor* last = nullptr,
                                           const ForceDependentSettings& settings = {});

/// α of least change from `start` that puts a contact into its seated pose (seating.hpp) at the
/// flexion it has there. `start` as it is where the contact has no seat or α cannot reach it.
/// @throws std::invalid_argument for a contact that the problem has not.
numerics::Unknowns seated_start(MuscleEquilibrium& problem, const FrameInstant& instant,
                                const numerics::Unknowns& start, std::size_t contact,
                                const SeatingSettings& settings = {});

}  // namespace condyle::fdk
