// SPDX-License-Identifier: Apache-2.0
#include "result_folder.hpp"

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "condyle/common/sha256.hpp"
#include "condyle/io/json_node.hpp"
#include "condyle/io/table.hpp"

namespace condyle::apps {
namespace {

namespace fs = std::filesystem;

/// Files that an earlier summary names; none where there is no such summary.
std::vector<std::string> earlier_files(const fs::path& folder, const std::string& format) {
  try {
    const io::JsonNode summary = io::JsonNode::read(folder / kSummary);
    if (summary.at("format").text() != format) return {};
    return summary.at("files").keys();
  } catch (const std::invalid_argument&) {
    return {};
  }
}

void remove_if_there(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw std::runtime_error(file.string() + ": cannot be removed: " + error.message());
}

}  // namespace

void require_folder(const fs::path& folder) {
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw std::invalid_argument("--out " + folder.string() + ": is a file: must be a folder");
  }
}

void write_result_folder(const fs::path& folder, const std::string& format,
                         const std::vector<ResultFile>& files, io::JsonObject summary) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": cannot be made: " + error.message());
  const std::vector<std::string> earlier = earlier_files(folder, format);
  remove_if_there(folder / kSummary);
  io::JsonObject hashes;
  for (const ResultFile& file : files) {
    io::write_whole(folder / file.name, file.text);
    hashes.add_string(file.name, sha256(file.text));
  }
  for (const std::string& name : earlier) {
    const auto same = [&](const ResultFile& file) { return file.name == name; };
    const bool ours = std::any_of(files.begin(), files.end(), same);
    // A name alone: a summary says nothing of other folders.
    if (!ours && fs::path(name).filename() == name) remove_if_there(folder / name);
  }
  summary.add("files", hashes.text());
  io::write_whole(folder / kSummary, summary.text() + '\n');
}

}  // namespace condyle::apps
