// SPDX-License-Identifier: Apache-2.0
// Damped Newton iteration for static equilibrium: find α with r(α) = 0.
//
//   J(α) Δ = −r(α),      α ← α + s Δ,      |Δ_i| ≤ max_newton_step,      0 < s ≤ 1
//
// r_i is the NET GENERALISED FORCE on coordinate α_i: where it derives from an energy Π, r = −∂Π/∂α, and −J is positive
// definite at a stable equilibrium. The solver uses that sign in two places:
//   * when J is (near) singular, when the Newton step leaves its bounds, or when it would move against the net force
//     (towards an unstable equilibrium), the step is regularised, (μ D − J) Δ = r with D a diagonal of stiffness units.
//     For μ → ∞ it follows the net force, so a body out of contact is moved towards contact;
//   * a regularised step is accepted when the merit falls OR the net force still does positive work at its end, since the
//     merit is flat out of contact.
//
// The merit is ½ Σ (r_i / tolerance_i)²: forces and moments are divided by their own tolerances before they are added.
// Contact loads are continuous but only piecewise smooth in α, so J may be one-sided; the line search copes with that,
// and where no step helps, J is taken once more by central differences before the solver gives up.
//
// No heap allocation per iteration: all vectors have a fixed capacity of kMaxUnknowns.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

namespace condyle::numerics {

/// Most unknowns a problem may have: two knees with their patellae are 22.
inline constexpr int kMaxUnknowns = 24;
using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxUnknowns, 1>;
using Jacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxUnknowns, kMaxUnknowns>;

/// What a component of the residual is: the conjugate of a translation [N] or of a rotation [Nm].
enum class LoadKind { kForce, kMoment };

/// A static equilibrium to be found. Implementations may keep scratch data: one problem, one thread.
class EquilibriumProblem {
 public:
  virtual ~EquilibriumProblem() = default;

  /// Number of unknowns n, 1 ≤ n ≤ kMaxUnknowns.
  virtual int size() const = 0;
  /// Kind of the i-th residual; its unknown is in m or in rad accordingly.
  virtual LoadKind load_kind(int i) const = 0;
  /// Name of the i-th unknown, for messages. Must outlive the problem.
  virtual std::string_view coordinate_name(int i) const = 0;
  /// r(α): net generalised force on each unknown [N, Nm]. `r` has n entries on entry.
  virtual void residual(const Unknowns& alpha, Unknowns& r) = 0;
  /// r(α) and J[i][j] = ∂r_i/∂α_j in one pass, since a contact model gives both at once.
  virtual void residual_and_jacobian(const Unknowns& alpha, Unknowns& r, Jacobian& J) = 0;
  /// Called wherever an iterate has been accepted, the start included. A problem that holds
  /// something fixed while the solver looks for a step may take it anew here; r and J, given as they
  /// were, are then to be what they are with it. @returns whether anything has changed.
  virtual bool renew(const Unknowns& /*alpha*/, Unknowns& /*r*/, Jacobian& /*J*/) { return false; }
};

enum class JacobianMethod { kAnalytic, kFiniteDifferences };

struct NewtonSettings {
  double force_tolerance = 0.01;    ///< largest |r_i| of a converged force [N]: 1e-5 of a gait load
  double moment_tolerance = 5e-4;   ///< largest |r_i| of a converged moment [Nm]: the force's, 50 mm away
  int max_iterations = 60;          ///< steps taken at most; 4–8 is usual from a warm start
  double max_newton_step_m = 2e-3;  ///< bound on a translation's step [m]: the plausible depth
  double max_newton_step_rad = 0.05;  ///< bound on a rotation's step [rad]: 2 mm at 40 mm
  int max_line_search = 6;          ///< "local search": halvings of a step that does not improve
  JacobianMethod jacobian = JacobianMethod::kAnalytic;
  double perturbation = 1e-6;       ///< central-difference step [m, rad]
};

enum class NewtonStatus { kConverged, kMaxIterations, kNoProgress, kNotFinite };

/// One sentence: what happened, and what the user can do next.
std::string_view advice(NewtonStatus status);
std::string_view name(NewtonStatus status);

struct NewtonStatistics {
  int iterations = 0;         ///< steps taken
  int evaluations = 0;        ///< residual evaluations, finite differences included
  int regularised_steps = 0;  ///< steps taken with μ > 0
  std::vector<double> residual;  ///< max_i |r_i|/tolerance_i before each step and at the end [-]
  std::vector<double> step;      ///< max_i |sΔ_i|/max_newton_step of each step [-]
};

struct NewtonResult {
  NewtonStatus status = NewtonStatus::kMaxIterations;
  Unknowns alpha;            ///< the last iterate; the equilibrium where converged [m, rad]
  Unknowns residual;         ///< r(alpha) [N, Nm]
  int worst_coordinate = 0;  ///< index of the largest |r_i|/tolerance_i
  NewtonStatistics statistics;

  bool converged() const { return status == NewtonStatus::kConverged; }
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const NewtonSettings& settings);

/// Solves `problem` from `start`.
/// @throws std::invalid_argument if start.size() ≠ problem.size(), a start value is not finite, or a setting is out of
///   range. Numerics that do not work out are a status.
NewtonResult solve_newton(EquilibriumProblem& problem, const Unknowns& start,
                          const NewtonSettings& settings);

}  // namespace condyle::numerics
