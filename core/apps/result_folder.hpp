// SPDX-License-Identifier: Apache-2.0
// Results in a folder: files, and a summary that stands for them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "condyle/io/json_text.hpp"

namespace condyle::apps {

inline constexpr const char* kSummary = "summary.json";

struct ResultFile {
  std::string name;
  std::string text;
};

/// Refuses a place where no folder can be. @throws std::invalid_argument naming it.
void require_folder(const std::filesystem::path& folder);

/// Writes the files, each whole or not at all, and last of all the summary, to which it adds their
/// SHA-256 (`files`). While they are written the folder has no summary, and what an earlier one of
/// the same format names and this run does not write is removed: a summary stands for the files
/// beside it.
/// @param format of the summary.
/// @throws std::runtime_error naming the file that cannot be written.
void write_result_folder(const std::filesystem::path& folder, const std::string& format,
                         const std::vector<ResultFile>& files, io::JsonObject summary);

}  // namespace condyle::apps
