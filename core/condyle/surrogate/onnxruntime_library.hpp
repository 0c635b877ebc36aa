// SPDX-License-Identifier: Apache-2.0
// Where the onnxruntime shared library is. Nothing links against it: it is opened by name when the
// first surrogate is read, so that Condyle starts, and computes mesh contact, on a machine that has
// none.
//
// Searched in this order; the first that exists is taken, and what cannot be opened is an error,
// never a reason to go on:
//   1. the environment variable CONDYLE_ONNXRUNTIME: a file, or a folder that holds one;
//   2. libonnxruntime.so.1.x.y (the highest) beside the executable or library of this code;
//   3. the file given to set_library_path (Python gives the copy inside the onnxruntime wheel);
//   4. libonnxruntime.so.1, wherever the system's loader finds it.
#pragma once

#include <filesystem>
#include <string>

namespace condyle::surrogate {

/// Sets the third place of the search. Without effect on a library that is open already.
void set_library_path(const std::filesystem::path& file);

/// The library in use, or the one that would be opened: an absolute path, or "libonnxruntime.so.1"
/// for the system's. Does not open anything. @throws std::invalid_argument when CONDYLE_ONNXRUNTIME
/// names nothing that exists.
std::string onnxruntime_library();

/// Opens the library, once a process, and returns the address of its function OrtGetApiBase.
/// It stays open to the end of the process. Thread-safe.
/// @throws std::invalid_argument when CONDYLE_ONNXRUNTIME names nothing that exists.
/// @throws std::runtime_error naming the library, the loader's reason and the way to set another.
void* onnxruntime_entry_point();

}  // namespace condyle::surrogate
