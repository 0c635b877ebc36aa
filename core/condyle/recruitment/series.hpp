// SPDX-License-Identifier: Apache-2.0
// Recruitment of many time frames, each started from the last one that was solved.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "condyle/recruitment/recruitment.hpp"

namespace condyle::recruitment {

/// t time frames, row-major, one after another.
struct SeriesInput {
  std::span<const double> moment_arms;  ///< t·n·m
  std::span<const double> loads;        ///< t·n; its size says t
  std::span<const double> strengths;    ///< t·m, or m for all time frames
  std::span<const double> minima;       ///< t·m, m, or empty
};

struct RecruitmentSeries {
  std::vector<RecruitmentStatus> status;  ///< (t)
  std::vector<std::string> message;       ///< (t) of those that did not converge, else empty
  RowMatrix forces, activities;           ///< (t, m) [N], [-]
  RowMatrix reserves, multipliers, unmet;  ///< (t, n)
  RowMatrix kkt;                          ///< (t, 3) primal, stationarity, complementarity
  Vector objective;                       ///< (t)
  std::vector<int> iterations;            ///< (t)
  RowMatrix forces_by_loads;              ///< (t·m, n) ∂f/∂τ, NaN where not converged; no rows unless asked for
};

/// @throws std::invalid_argument where sizes do not fit the solver's n and m, or as RecruitmentSolver::solve, "time frame 12:" before.
RecruitmentSeries recruit_series(RecruitmentSolver& solver, const SeriesInput& input, bool warm_starts,
                                 bool with_forces_by_loads);

}  // namespace condyle::recruitment
