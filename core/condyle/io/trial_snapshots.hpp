// SPDX-License-Identifier: Apache-2.0
// Path snapshots (path_snapshot_file.hpp) put beside the motion that they were made of.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

#include "condyle/model/model.hpp"
#include "condyle/model/path_snapshot.hpp"

namespace condyle::io {

struct TrialSnapshots {
  model::PathSnapshots snapshots;
  std::vector<std::size_t> rows;  ///< (T) which of the snapshots' times a time frame takes
};

/// Reads snapshots and finds those of a trial's time frames.
/// @param times (T) of the trial, at least one [s].
/// @param q (coordinates) of its first time frame [rad, m]: where held paths must begin and end
/// where the model's own do, to 0.1 mm, or they are another model's.
/// @throws std::invalid_argument naming the file, and what cannot be read (path_snapshot_file.hpp),
/// the first time without a snapshot, or the muscle or ligament that begins or ends elsewhere.
TrialSnapshots read_trial_snapshots(const std::filesystem::path& file, const model::Model& model,
                                    std::span<const double> times,
                                    const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace condyle::io
