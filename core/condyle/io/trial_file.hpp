// SPDX-License-Identifier: Apache-2.0
// A recorded activity of a model, from OpenSim's files: the motion of its coordinates and the loads
// on its bodies.
//
// Coordinates are differentiated as OpenSim's inverse dynamics does: by the natural quintic spline
// through all rows of the file (motion_file.hpp), also where only some of them are taken. Filter
// before, if they are raw.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "condyle/model/external_load.hpp"
#include "condyle/model/model.hpp"

namespace condyle::io {

/// Times of motion, snapshots and what a user asks for that differ by less are the same [s].
inline constexpr double kSameTime = 1e-5;

/// One row a time frame.
struct Trial {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  std::vector<double> times;  ///< (T) [s]
  Rows q, qd, qdd;            ///< (T, coordinates) in the model's order [rad, m, s]
  /// (T) external loads in ground, the same bodies in every time frame; empty: none at all.
  std::vector<std::vector<model::ExternalLoad>> loads;
  /// Force-dependent coordinates that the motion says nothing of: they are at their default.
  std::vector<std::string> at_default;
};

struct TrialReading {
  double start = -std::numeric_limits<double>::infinity();  ///< first time taken [s]
  double end = std::numeric_limits<double>::infinity();     ///< last time taken [s]
  double negligible_force = 0.0;  ///< of external loads (external_loads.hpp) [N]
  /// A coordinate farther than this many half-widths from the middle of its range is taken for one
  /// in other units; infinity: never.
  double range_factor = 3.0;
};

/// Reads a trial.
/// @param motion STO or MOT file with a column a coordinate, in radians or degrees as its header
/// says. Coordinates without a column are at their default; that is an error unless they are
/// locked, follow another or are force-dependent: inverse kinematics may know nothing of these.
/// @param external_loads OpenSim's XML file; its table is found beside it. Empty: none.
/// @throws std::invalid_argument naming file, column, time and value of what cannot be read,
/// columns that do not match the model (with the near miss), no time frame within the times asked
/// for, values far beyond a coordinate's range, a gap in the loads, a body that the model lacks.
Trial read_trial(const model::Model& model, const std::filesystem::path& motion,
                 const std::filesystem::path& external_loads = {},
                 const TrialReading& reading = {});

}  // namespace condyle::io
