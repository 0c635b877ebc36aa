// SPDX-License-Identifier: Apache-2.0
// Paths as another program found them at each time frame, in JSON files:
//   {"format": "condyle-path-snapshots", "version": 1, "source": "...", "bodies": ["femur_r", ...], "times": [T],
//    "paths": {"vasmed_r": [{"points": [[body, x, y, z], ...], "arc_excess": e}, … T of them]}}
// for surfaces that Condyle does not wrap paths around itself. Points are in the frame of their body, an index into the
// file's `bodies` ("ground" may be one) [m]. Schema: docs/schema/path_snapshots.schema.json.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "condyle/model/model_description.hpp"
#include "condyle/model/path_snapshot.hpp"

namespace condyle::io {

inline constexpr const char* kPathSnapshotsFormat = "condyle-path-snapshots";
inline constexpr int kPathSnapshotsVersion = 1;

/// Reads the snapshots of a model's paths; bodies become indices into the model's list.
/// @throws std::invalid_argument naming file, path, time frame, key, value and what is allowed: as a model file's messages,
/// and for a body, muscle or ligament that the model lacks, times that do not ascend, another number of snapshots than of
/// times, a path of fewer than two points.
model::PathSnapshots read_path_snapshots(const std::filesystem::path& file,
                                         const model::ModelDescription& model);
/// Likewise from a text; `source` stands for the file in messages.
model::PathSnapshots parse_path_snapshots(std::string_view json, std::string source,
                                          const model::ModelDescription& model);

/// Text that reads back to the same snapshots, number for number; `provenance` says in words what made them.
/// @throws std::invalid_argument for a body that the model lacks or a number that is not finite.
std::string path_snapshots_text(const model::PathSnapshots& snapshots,
                                const model::ModelDescription& model,
                                std::string_view provenance);

}  // namespace condyle::io
