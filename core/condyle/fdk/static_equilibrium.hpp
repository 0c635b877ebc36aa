// SPDX-License-Identifier: Apache-2.0
// Static equilibrium of a sample: with {x, z, θy, θz} given, the y and θx at which the contact carries a prescribed load.
//
//   Σ_sides Fy(y, θx) = Fy*,     Σ_sides Mx(y, θx) = Mx*        (2 unknowns), or
//   Σ_sides Fy(y)     = Fy*      with θx given                  (1 unknown).
//
// Fy and Mx are the CONTACT wrench on the femur, at Fo, expressed in T, summed over the sides (the applied load is its
// negative). Converged means |ΔFy| ≤ 0.1 % Fy* + 0.01 N and |ΔMx| ≤ 0.1 % |Mx*| + 0.0005 Nm.
//
// Method. The start comes from a TouchMap or from a hint. Each evaluation refits the local law of each side (see
// side_response.hpp); the next point is where those laws carry the load, which is Newton's step with the curvature of
// contact in it: three to four evaluations are usual. What that does not settle goes to a bracketed search: at each θx the
// y(θx) that carries Fy*, then θx along Mx(θx), which rises with θx on the stable branch (Mx = dV/dθx of the reduced energy).
// Its largest value is the limit of statics: beyond it there is no equilibrium.
//
// Source: Marra et al. 2017, Methods (what is prescribed and solved for); tolerances and rejection are Condyle's own.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "condyle/contact/contact_model.hpp"
#include "condyle/fdk/touch_map.hpp"

namespace condyle::fdk {

struct StaticEquilibriumSettings {
  double force_tolerance = 0.01;           ///< absolute part of the tolerance on Fy [N]
  double force_relative_tolerance = 1e-3;  ///< part of |Fy*| [-]
  double moment_tolerance = 5e-4;          ///< absolute part of the tolerance on Mx [Nm]
  double moment_relative_tolerance = 1e-3;  ///< part of |Mx*| [-]
  int max_iterations = 12;          ///< Newton steps before the bracketed search takes over
  int max_evaluations = 250;        ///< contact evaluations a sample, bracketed search included
  double max_newton_step_m = 2e-3;  ///< bound on a step in y [m]: the plausible depth
  double max_newton_step_rad = 0.05;   ///< bound on a step in θx [rad]
  double max_theta_x = 0.2;            ///< |θx| searched [rad]: 11°, far beyond lift-off
  double greatest_moment_arm = 0.045;  ///< |Mx*| > this × Fy* is refused unseen [m]: outside any insert
  TouchSearch touch;                   ///< where first touch is looked for
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const StaticEquilibriumSettings& settings);

enum class EquilibriumStatus : int {
  kConverged = 0,
  kNoEquilibrium = 1,  ///< statics: contact cannot carry this Mx with this Fy, or Fy ≤ 0
  kOverclosure = 2,    ///< the load needs more than the plausible depth
  kOffInsert = 3,      ///< no touch anywhere along y: the femur passes beside the insert
  kNotConverged = 4,
};
std::string_view name(EquilibriumStatus status);
/// One sentence: what happened, and what the user can do next.
std::string_view advice(EquilibriumStatus status);

/// What is prescribed for one sample.
struct StaticLoad {
  double x = 0.0;        ///< [m]
  double z = 0.0;        ///< [m]
  double theta_y = 0.0;  ///< [rad]
  double theta_z = 0.0;  ///< [rad]
  double Fy = 0.0;       ///< contact's total compression [N]
  double Mx = 0.0;       ///< contact's total moment about x_T at Fo [Nm]; not used where theta_x is given
  std::optional<double> theta_x;        ///< given: solve y only [rad]
  std::optional<SensitivePoint> start;  ///< a hint; the map's start otherwise
};

struct StaticEquilibrium {
  EquilibriumStatus status = EquilibriumStatus::kNotConverged;
  Pose pose = Pose::Zero();     ///< the pose last evaluated; the equilibrium where converged
  contact::ContactLoads loads;  ///< wrench and stiffness per side there
  int evaluations = 0;          ///< contact evaluations of this sample, those of the map's nodes not included
  int iterations = 0;           ///< Newton steps
  bool searched = false;        ///< the bracketed search was needed
};

/// Solves samples on one contact model. Thread-safe.
class StaticEquilibriumSolver {
 public:
  /// `model` must outlive the solver. @throws std::invalid_argument for a setting out of range.
  explicit StaticEquilibriumSolver(const contact::ContactModel& model,
                                   const StaticEquilibriumSettings& settings = {});

  /// @throws std::invalid_argument naming the field of `load` that is not finite.
  StaticEquilibrium solve(const StaticLoad& load) const;

  /// One result per load, on `threads` threads (0: all); the same bytes for any number of threads and any split of
  /// the loads into batches. @throws as solve(), naming the row.
  std::vector<StaticEquilibrium> solve_batch(std::span<const StaticLoad> loads, int threads) const;

  /// Contact evaluations spent on the map of first touches so far.
  long map_evaluations() const { return map_.evaluations(); }

 private:
  const contact::ContactModel& model_;
  const StaticEquilibriumSettings settings_;
  TouchMap map_;
};

}  // namespace condyle::fdk
