// SPDX-License-Identifier: Apache-2.0
// Musculoskeletal models in JSON files: {"format": "condyle-model", "version": 1, ...}, described in docs/model_files.md and
// by docs/schema/model.schema.json. SI units and radians.
//
// Reading checks the form: types, keys, names that differ. Whether the model hangs together (a body of that name, a tree,
// a mass that a body can have) is model::Model's to say.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "condyle/model/model_description.hpp"

namespace condyle::io {

inline constexpr const char* kModelFormat = "condyle-model";
inline constexpr int kModelVersion = 1;

/// Reads a model file. The description's `source` is the file, its `provenance` the file's "source".
/// @throws std::invalid_argument naming file, item, key, value and what is allowed, as
///   model.json: joints[3] "knee_r": rotations[1].terms[0].function.kind: "spline": … (allowed: linear, polynomial, …)
/// A syntax error gives line and column.
model::ModelDescription read_model_file(const std::filesystem::path& file);

/// Likewise from a text; `source` stands for the file in messages.
model::ModelDescription parse_model(std::string_view json, std::string source);

/// The text of a model file that reads back to the same description, number for number.
/// @throws std::invalid_argument for a number that is not finite.
std::string model_text(const model::ModelDescription& description);

/// Writes it, whole or not at all. @throws std::runtime_error naming the file when it cannot be written.
void write_model_file(const model::ModelDescription& description, const std::filesystem::path& file);

}  // namespace condyle::io
