// SPDX-License-Identifier: Apache-2.0
// Where the real implants are, if they are on this machine.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace condyle::test {

/// The folder named by CONDYLE_DATA, else the one beside the project; nothing where neither holds implants.
inline std::optional<std::filesystem::path> shared_data() {
  const char* named = std::getenv("CONDYLE_DATA");
  const std::filesystem::path folder = named != nullptr ? named : CONDYLE_SHARED_DATA;
  if (std::filesystem::exists(folder / "implants")) return folder;
  return std::nullopt;
}

}  // namespace condyle::test

/// Leaves the test case with a message when there are no real implants.
#define CONDYLE_REQUIRE_DATA(variable)                                              \
  const auto variable##_optional = condyle::test::shared_data();                    \
  if (!variable##_optional) {                                                       \
    MESSAGE("skipped: no implants (set CONDYLE_DATA, or put shared/data beside the project)"); \
    return;                                                                         \
  }                                                                                 \
  const std::filesystem::path variable = *variable##_optional
