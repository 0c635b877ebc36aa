// SPDX-License-Identifier: Apache-2.0
// Where this program is, on disk: what is delivered with it lies beside it.
#pragma once

#include <filesystem>

namespace condyle::surrogate {

/// The folder of the executable or shared library that this function was linked into, as an
/// absolute path. Works without /proc. Empty if the system does not tell.
std::filesystem::path module_folder();

}  // namespace condyle::surrogate
