// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/surrogate/module_folder.hpp"

namespace fs = std::filesystem;

TEST_CASE("the folder is that of this program, wherever it is run from [property]") {
  const fs::path expected = fs::read_symlink("/proc/self/exe").parent_path();
  CHECK(condyle::surrogate::module_folder() == expected);
  const fs::path before = fs::current_path();
  fs::current_path("/");
  CHECK(condyle::surrogate::module_folder() == expected);
  fs::current_path(before);
}
