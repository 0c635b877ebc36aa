// SPDX-License-Identifier: Apache-2.0
// A whole trial of a musculoskeletal model whose every coordinate is known: inverse dynamics, muscle paths and strengths,
// ligaments and recruitment, time frame by time frame (what OpenSim calls inverse dynamics and static optimisation).
//
// Time frames do not know of each other, so they are spread over threads, and the results are the same bytes for any number
// of these.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "condyle/fdk/musculoskeletal_frame.hpp"

namespace condyle::fdk {

/// One row a time frame.
using TimeFrames = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct TrialInput {
  TimeFrames q, qd, qdd;  ///< (T, n_coordinates) [rad, m, s]
  /// External loads of each time frame, in ground; empty: none at all.
  std::vector<std::vector<model::ExternalLoad>> loads;
  const model::PathSnapshots* snapshots = nullptr;  ///< paths that are not computed; nullptr: none
  std::vector<std::size_t> snapshot_rows;           ///< (T) which of the snapshots' times a time frame takes
};

/// What to compute; each needs those before it but kinematics alone.
struct TrialParts {
  bool dynamics = true, muscles = true, ligaments = true, recruitment = true;
};

/// Arrays of what was not asked for have no rows. Shapes: T time frames, n coordinates, b bodies, m muscles, s ligaments,
/// k coordinates that muscles balance.
struct TrialAnalysis {
  TimeFrames segment_poses;          ///< (T, 12 b): per body R_GB row by row, then p_GBo [m]
  TimeFrames generalised_forces;     ///< (T, n) τ of inverse dynamics [Nm, N]
  TimeFrames muscle_lengths;         ///< (T, m) [m]
  TimeFrames muscle_velocities;      ///< (T, m) lengthening positive [m/s]
  TimeFrames moment_arms;            ///< (T, n m): coordinate by coordinate, −∂L/∂q [m, -]
  TimeFrames muscle_strengths;       ///< (T, m) N [N]
  TimeFrames passive_forces;         ///< (T, m) P [N]
  TimeFrames ligament_lengths;       ///< (T, s) [m]
  TimeFrames ligament_strains;       ///< (T, s) [-]
  TimeFrames ligament_forces;        ///< (T, s) [N]
  TimeFrames ligament_loads;         ///< (T, n) their generalised forces [Nm, N]
  TimeFrames spring_loads;           ///< (T, n) those of coordinate springs [Nm, N]
  TimeFrames muscle_forces;          ///< (T, m) active and passive [N]
  TimeFrames activities;             ///< (T, m) active force over strength [-]
  TimeFrames reserves;               ///< (T, k) [Nm, N]
  TimeFrames residuals;              ///< (T, n) what muscles, ligaments and springs do not give of τ [Nm, N]
  std::vector<recruitment::RecruitmentStatus> status;  ///< (T)
  std::vector<std::string> messages;                   ///< (T) in words
  std::vector<double> kkt;                             ///< (T) largest scaled KKT residual
};

/// @throws std::invalid_argument for shapes that do not fit the model or each other, or a value that is not finite, naming
/// the time frame.
TrialAnalysis analyse_trial(const model::Model& model, const TrialInput& input, const MuscleSettings& settings,
                            const TrialParts& parts = {}, int threads = 0);

}  // namespace condyle::fdk
