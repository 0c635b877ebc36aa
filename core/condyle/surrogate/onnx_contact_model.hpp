// SPDX-License-Identifier: Apache-2.0
// A contact model that is a neural network in an ONNX file (contract version 1, onnx_contract.hpp).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "condyle/contact/contact_model.hpp"

namespace condyle::surrogate {

/// What evaluates a surrogate file.
enum class Runtime {
  kAuto,         ///< fused where the file's graph is known to it, else onnxruntime
  kFused,        ///< Condyle's own kernels (fused_surrogate.hpp); needs no other library
  kOnnxruntime,  ///< any graph (onnxruntime_library.hpp)
};

/// "auto", "fused", "onnxruntime"
const char* name(Runtime runtime);
/// @throws std::invalid_argument for any other word.
Runtime runtime_from_name(const std::string& word);

/// Evaluates a surrogate file: the same numbers, to rounding, whatever the runtime.
///
/// The loads are the file's numbers, SI in and SI out: nothing is scaled or gated here. `error` is
/// the file's calibrated 95 % bound and `trust` its own judgement of the pose. A wrench-only file
/// knows neither: both are then NaN, which says "unknown" and compares as not trusted. Where the
/// network overflows to a wrench that is not finite, trust is 0. `implausible_depth` is never set:
/// a network knows no depth; distrust shows in `trust`.
///
/// Thread safety: all const functions. Batches go through the network in pieces of 1 024 poses
/// counted from the first, so that the result is the same bytes for any number of threads. With
/// onnxruntime a pose evaluated alone may differ in the last digits; fused it may not.
class OnnxContactModel final : public contact::ContactModel {
 public:
  /// @throws std::invalid_argument in one line naming the file and the field that is missing or
  ///   does not match the contract, or that the file is missing, truncated, no ONNX model, or gives
  ///   values that are not finite; or, asked for kFused, where its graph is not a known one.
  /// @throws std::runtime_error when onnxruntime is needed and there is none that can be used.
  explicit OnnxContactModel(const std::filesystem::path& file, Runtime runtime = Runtime::kAuto);
  ~OnnxContactModel() override;
  OnnxContactModel(OnnxContactModel&&) noexcept;
  OnnxContactModel& operator=(OnnxContactModel&&) noexcept;

  SideOfBody side_of_body() const override;

  /// @throws std::invalid_argument if stiffness is asked of a wrench-only file, or the pose is not
  /// finite.
  contact::ContactLoads evaluate(const Pose& pose, contact::Derivatives derivatives) const override;

  void evaluate_batch(std::span<const Pose> poses, contact::Derivatives derivatives, int threads,
                      std::span<contact::ContactLoads> loads) const override;

  void evaluate_into(std::span<const Pose> poses, int threads,
                     const contact::LoadSpans& loads) const override;

  /// False for a wrench-only file, which has neither stiffness nor error nor trust.
  bool has_stiffness() const;

  /// The file's metadata_props: contract, units, side of body, implant, contact law, domain bounds,
  /// error table, training.
  const std::map<std::string, std::string>& metadata() const;

  /// What evaluates it: kFused or kOnnxruntime.
  Runtime runtime() const;

  /// Why the fused path did not take the file; empty where it did, or was not asked.
  const std::string& fused_refusal() const;

  /// Of the fused kernels: "baseline", "avx2" or "avx512"; empty with onnxruntime.
  std::string instruction_set() const;

  /// The file that was read.
  const std::filesystem::path& file() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace condyle::surrogate
