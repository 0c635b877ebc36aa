// SPDX-License-Identifier: Apache-2.0
// Muscle recruitment of one time frame after another: forces, multipliers, how well they satisfy the optimality conditions,
// and their derivatives. The problem is stated in problem.hpp.
//
// p > 1: DualNewton, and where that is led astray (always for p > 3) InteriorPoint and then DualNewton's last steps.
// p = 1: BoundedSimplex. Min–max: MinMax.
//
// A solver belongs to one thread; its results depend on what it is given alone, not on what it solved before. Nothing is
// allocated after construction.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "condyle/recruitment/dual_newton.hpp"
#include "condyle/recruitment/interior_point.hpp"
#include "condyle/recruitment/kkt.hpp"
#include "condyle/recruitment/min_max.hpp"
#include "condyle/recruitment/problem.hpp"
#include "condyle/recruitment/sensitivity.hpp"

namespace condyle::recruitment {

/// Where a muscle is at the solution.
enum class MuscleState : std::uint8_t { kAtMinimum, kBetween, kAtStrength, kAtLevel };

/// From a solution of a problem like the next; empty: none. Multipliers serve p > 1, the basis p = 1; min–max takes none.
struct WarmStart {
  Vector multipliers;                  ///< (n) as Recruitment::multipliers
  std::vector<int> basis;              ///< (n) of BoundedSimplex
  std::vector<std::uint8_t> at_upper;  ///< (m + 2n)
  bool empty() const { return multipliers.size() == 0; }
};

struct Recruitment {
  RecruitmentStatus status = RecruitmentStatus::kMaxIterations;
  Vector forces;        ///< (m) f [N]; where infeasible, forces with the least sum of scaled load violations
  Vector activities;    ///< (m) f/N [-]; 0 for a muscle of zero strength
  Vector reserves;      ///< (n) e [Nm, N]
  Vector multipliers;   ///< (n) ∂objective/∂τ; where infeasible, a proof of it (BoundedSimplex)
  Vector unmet;         ///< (n) τ − R f − e [Nm, N]
  /// Coordinates whose equation cannot be met, the worst first; empty unless infeasible.
  std::vector<int> unmet_coordinates;
  std::vector<MuscleState> states;  ///< (m)
  double objective = 0;             ///< Σ w (f/N)^p + Σ c |e/S|^p; min–max: the first level
  std::vector<double> levels;       ///< min–max: w f/N of each level, falling; else empty
  KktResiduals kkt;
  int iterations = 0;

  bool converged() const { return status == RecruitmentStatus::kConverged; }
};

class RecruitmentSolver {
 public:
  /// @throws std::invalid_argument as require_valid(setup, settings).
  RecruitmentSolver(RecruitmentSetup setup, RecruitmentSettings settings);
  ~RecruitmentSolver();
  RecruitmentSolver(RecruitmentSolver&&) noexcept;
  RecruitmentSolver& operator=(RecruitmentSolver&&) noexcept;

  /// Valid until the next call. @throws std::invalid_argument as require_valid(frame, …), or if the warm start is of another size.
  const Recruitment& solve(const RecruitmentFrame& frame);
  const Recruitment& solve(const RecruitmentFrame& frame, const WarmStart& warm);
  /// Of the last solution; empty where there was none. May be given to the next solve as it is.
  const WarmStart& warm_start() const;
  const Recruitment& result() const;
  const RecruitmentSetup& setup() const;
  const RecruitmentSettings& settings() const;

  // Derivatives at the last solution: see sensitivity.hpp for what they are at a kink.

  /// False where the muscles between their bounds cannot answer every change of the loads.
  /// @throws std::logic_error, as all below, unless the last result converged.
  bool sensitivity_is_regular();
  /// ∂f/∂τ (m, n) and ∂e/∂τ (n, n).
  void forces_by_loads(Eigen::Ref<RowMatrix> forces, Eigen::Ref<RowMatrix> reserves);
  /// Along k directions: loads dτ (k, n), moment_arms dR (k·n, m) one direction after another or of no rows, strengths
  /// dN (k, m) or of no rows → df (k, m), de (k, n).
  void forces_along(const Eigen::Ref<const RowMatrix>& loads,
                    const Eigen::Ref<const RowMatrix>& moment_arms,
                    const Eigen::Ref<const RowMatrix>& strengths, Eigen::Ref<RowMatrix> forces,
                    Eigen::Ref<RowMatrix> reserves);

  /// "converged …" or what went wrong, with the names of coordinates and what the user can do.
  std::string message() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace condyle::recruitment
