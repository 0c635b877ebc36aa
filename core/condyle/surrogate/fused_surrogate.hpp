// SPDX-License-Identifier: Apache-2.0
// A surrogate file evaluated by Condyle's own kernels, without onnxruntime: only where the file's
// graph is, node by node, one that is known here. Everything else is for onnxruntime.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "condyle/common/pose.hpp"
#include "condyle/surrogate/onnx_file.hpp"

namespace condyle::surrogate {

/// Where the results of n poses go, row-major; what is null is not written (and, but for the wrench
/// where error or trust follow from it, not computed).
struct FusedOutputs {
  double* wrench = nullptr;     ///< (n, 2, 6), always
  double* stiffness = nullptr;  ///< (n, 2, 6, 6)
  double* error = nullptr;      ///< (n, 2, 6)
  double* trust = nullptr;      ///< (n)
};

/// Thread safety: all const functions. A pose gives the same bytes alone, in a batch, and with or
/// without stiffness.
class FusedSurrogate {
 public:
  /// @pre check_contract() accepted the file's signature.
  /// @throws UnknownGraph (graph_template.hpp) saying where the graph departs from those known.
  explicit FusedSurrogate(const OnnxFile& file);
  ~FusedSurrogate();
  FusedSurrogate(FusedSurrogate&&) noexcept;
  FusedSurrogate& operator=(FusedSurrogate&&) noexcept;

  /// "two_stage" or "potential"
  const std::string& architecture() const;
  /// Of the kernels: "baseline", "avx2" or "avx512".
  const char* instruction_set() const;

  /// @pre stiffness, error and trust only where the file has them. Allocates on a thread's first
  /// call only.
  void evaluate(std::span<const Pose> poses, const FusedOutputs& outputs) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace condyle::surrogate
