// SPDX-License-Identifier: Apache-2.0
// A folder that keeps a test program's distance fields while it runs, so that each is built once.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace condyle::test {

class FieldFolder {
 public:
  /// @param name of the program: programs may run side by side.
  explicit FieldFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("condyle-test-fields-" + name)) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ~FieldFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  FieldFolder(const FieldFolder&) = delete;
  FieldFolder& operator=(const FieldFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace condyle::test
