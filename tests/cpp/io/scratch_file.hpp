// SPDX-License-Identifier: Apache-2.0
// A small file that goes away with the test.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace condyle::test {

class ScratchFile {
 public:
  explicit ScratchFile(const std::string& name, const std::string& text = {})
      : path_(std::filesystem::temp_directory_path() / ("condyle_io_" + name)) {
    if (!text.empty()) std::ofstream(path_, std::ios::binary) << text;
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// The text of the std::invalid_argument that `body` throws.
template <typename Error, typename Body>
std::string message_of(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace condyle::test
