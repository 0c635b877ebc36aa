// SPDX-License-Identifier: Apache-2.0
// A surrogate where it may be trusted, the reference where it may not, and a blend in between.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "condyle/contact/contact_model.hpp"

namespace condyle::surrogate {

/// Evaluates the surrogate, and the reference where the surrogate's trust is not high.
///
/// With t the surrogate's trust at the pose, loads are
///
///   the reference's                      where t < 0.5 or is not a number,
///   (1 − w)·reference + w·surrogate      where 0.5 ≤ t < 0.75, w = s²·(3 − 2s), s = 4t − 2,
///   the surrogate's                      where t ≥ 0.75.
///
/// A jump by the surrogate's error would leave a solver without an equilibrium where the loads that
/// are asked for lie in it. The blend is as continuous as trust is. Its band should be wide: trust
/// follows the loads and passes it within 2.5 % of a domain's half width, 40 N of Fy at 3 kN on a
/// side, and a difference of the models beyond two thirds of that makes a fold in the force over y.
/// It should be narrow, too: every pose in it costs a reference evaluation (docs/decisions.md).
///
/// In the band:
/// - `stiffness` is the derivative of the blend: (1 − w)·reference's + w·surrogate's + the
///   difference of the wrenches times ∂w/∂pose. Models do not give ∂trust/∂pose: it is a central
///   difference over ±1e-7 m, ±1e-6 rad, twelve evaluations of the surrogate. Trust has kinks;
///   there it is the mean slope.
/// - `error` is (1 − w)·reference's + w·surrogate's: the blend differs from the reference by w
///   times what the surrogate does, so a bound that holds for the surrogate holds for the blend.
/// - `trust` is (1 − w)·reference's + w·t, at least 0.5 with a mesh contact, whose trust is 1.
/// - `implausible_depth` is set where either sets it.
/// A blend has no energy: on a closed path through the band its work is the surrogate's error.
///
/// Evaluations are counted, and how often the reference was called (below the band and in it); the
/// first poses of these are kept.
///
/// Thread safety: all const functions, as far as the two models allow it.
class HybridContactModel final : public contact::ContactModel {
 public:
  /// A pose that the reference was called for, and the surrogate's trust there.
  struct Call {
    Pose pose;
    double trust = 0.0;
  };
  /// Trust below which the reference stands alone.
  static constexpr double kTrusted = 0.5;
  /// Trust from which the surrogate stands alone.
  static constexpr double kTrustedAlone = 0.75;
  /// Calls that log() keeps; those after it are counted only.
  static constexpr std::size_t kLogged = 1000;

  /// @throws std::invalid_argument if one is null, they are of different sides of the body, or the
  ///   surrogate does not know its trust (a wrench-only file).
  HybridContactModel(std::shared_ptr<const contact::ContactModel> surrogate,
                     std::shared_ptr<const contact::ContactModel> reference);
  ~HybridContactModel() override;

  SideOfBody side_of_body() const override;
  contact::ContactLoads evaluate(const Pose& pose, contact::Derivatives derivatives) const override;

  /// The surrogate's batch first, then the reference at the poses where it does not stand alone.
  void evaluate_batch(std::span<const Pose> poses, contact::Derivatives derivatives, int threads,
                      std::span<contact::ContactLoads> loads) const override;

  /// Poses that it was asked about, since the beginning.
  std::uint64_t evaluations() const;
  /// Those of them that the reference was called for.
  std::uint64_t reference_calls() const;
  /// The first of them, in the order of the calls.
  std::vector<Call> log() const;

 private:
  struct Record;
  void record(const Pose& pose, double trust) const;
  contact::ContactLoads with_reference(const Pose& pose, contact::Derivatives derivatives,
                                       const contact::ContactLoads& known) const;
  Vector6 trust_gradient(const Pose& pose) const;

  std::shared_ptr<const contact::ContactModel> surrogate_;
  std::shared_ptr<const contact::ContactModel> reference_;
  std::unique_ptr<Record> record_;
};

}  // namespace condyle::surrogate
