// SPDX-License-Identifier: Apache-2.0
// An ONNX file opened in onnxruntime: what it says of itself, and its outputs at many poses.
// Nothing here knows what the outputs mean; see onnx_contract.hpp. The only capability that
// includes onnxruntime.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "condyle/common/pose.hpp"
#include "condyle/surrogate/onnx_contract.hpp"

namespace condyle::surrogate {

/// Version of the onnxruntime library in use, "1.31.1"; opens it if no surrogate has.
/// @throws std::runtime_error as onnxruntime_entry_point(), or when the library is older than 1.17.
std::string onnxruntime_version();

/// One session, shared by all threads: one thread inside a run, no spinning, buffers bound once and
/// kept for the next run. A run at one pose allocates nothing of ours.
///
/// Thread safety: run() is const and may be called from many threads at once.
class OnnxSession {
 public:
  /// Rows that a run takes at most: large enough to hide a run's fixed cost, small enough to stay
  /// in the cache.
  static constexpr std::size_t kMaxRows = 1024;

  /// @throws std::invalid_argument naming the file when it is missing, empty, truncated or no ONNX
  /// model.
  /// @throws std::runtime_error when there is no usable onnxruntime.
  explicit OnnxSession(const std::filesystem::path& file);
  ~OnnxSession();
  OnnxSession(OnnxSession&&) noexcept;
  OnnxSession& operator=(OnnxSession&&) noexcept;

  /// Names, types and shapes of inputs and outputs, and the metadata.
  const FileSignature& signature() const;

  /// outputs[i]: row-major values of the i-th output of the signature, poses.size() rows.
  using Read = std::function<void(std::span<const double* const> outputs)>;

  /// Evaluates the graph at poses and calls `read` once; the outputs are gone when it returns.
  /// @pre check_contract() accepted the signature; 1 ≤ poses.size() ≤ kMaxRows.
  /// @throws std::runtime_error when onnxruntime fails.
  void run(std::span<const Pose> poses, const Read& read) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace condyle::surrogate
