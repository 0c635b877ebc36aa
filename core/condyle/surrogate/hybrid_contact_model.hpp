// SPDX-License-Identifier: Apache-2.0
// A surrogate where it may be trusted, the reference where it may not.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "condyle/contact/contact_model.hpp"

namespace condyle::surrogate {

/// Evaluates the surrogate, and the reference where the surrogate's trust is not at least 0.5.
///
/// Loads are then the reference's own, with its error and trust (0 and 1 for a mesh contact): the
/// wrench jumps from one to the other by the surrogate's error, so a solver near the border of the
/// sampled domains sees a small step. How often the reference was called is counted, and the first
/// poses are kept.
///
/// Thread safety: all const functions, as far as the two models allow it.
class HybridContactModel final : public contact::ContactModel {
 public:
  /// A pose that the reference was called for, and the surrogate's trust there.
  struct Call {
    Pose pose;
    double trust = 0.0;
  };
  static constexpr double kTrusted = 0.5;
  /// Calls that log() keeps; those after it are counted only.
  static constexpr std::size_t kLogged = 1000;

  /// @throws std::invalid_argument if one is null, they are of different sides of the body, or the
  ///   surrogate does not know its trust (a wrench-only file).
  HybridContactModel(std::shared_ptr<const contact::ContactModel> surrogate,
                     std::shared_ptr<const contact::ContactModel> reference);
  ~HybridContactModel() override;

  SideOfBody side_of_body() const override;
  contact::ContactLoads evaluate(const Pose& pose, contact::Derivatives derivatives) const override;

  /// The surrogate's batch first, then the reference at the poses that it does not know.
  void evaluate_batch(std::span<const Pose> poses, contact::Derivatives derivatives, int threads,
                      std::span<contact::ContactLoads> loads) const override;

  /// Poses that the reference was called for, since the beginning.
  std::uint64_t reference_calls() const;
  /// The first of them, in the order of the calls.
  std::vector<Call> log() const;

 private:
  struct Record;
  void record(const Pose& pose, double trust) const;

  std::shared_ptr<const contact::ContactModel> surrogate_;
  std::shared_ptr<const contact::ContactModel> reference_;
  std::unique_ptr<Record> record_;
};

}  // namespace condyle::surrogate
