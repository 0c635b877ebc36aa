// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/hybrid_contact_model.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "condyle/common/parallel.hpp"

namespace condyle::surrogate {

using contact::ContactLoads;
using contact::Derivatives;

namespace {

constexpr double kBand = HybridContactModel::kTrustedAlone - HybridContactModel::kTrusted;
/// Half a step of trust's central difference. Small beside what trust changes over (some µm of y),
/// yet trust's rounding, 1e-12 or so, hardly shows; a file in float32 still feels it.
constexpr double kStep_m = 1e-7, kStep_rad = 1e-6;

bool stands_alone(const ContactLoads& known) {
  return known.trust >= HybridContactModel::kTrustedAlone;
}

/// How far into the band trust is, 0 to 1; 0 if it is not a number.
double fraction(double trust) {
  return trust > HybridContactModel::kTrusted
             ? std::min((trust - HybridContactModel::kTrusted) / kBand, 1.0)
             : 0.0;
}

}  // namespace

struct HybridContactModel::Record {
  std::atomic<std::uint64_t> evaluations = 0;
  mutable std::mutex mutex;
  std::uint64_t calls = 0;
  std::vector<Call> log;
};

HybridContactModel::HybridContactModel(std::shared_ptr<const contact::ContactModel> surrogate,
                                       std::shared_ptr<const contact::ContactModel> reference)
    : surrogate_(std::move(surrogate)),
      reference_(std::move(reference)),
      record_(std::make_unique<Record>()) {
  if (!surrogate_ || !reference_) {
    throw std::invalid_argument("hybrid contact: a surrogate and a reference are needed");
  }
  if (surrogate_->side_of_body() != reference_->side_of_body()) {
    throw std::invalid_argument(
        "hybrid contact: the surrogate is of a " + std::string(name(surrogate_->side_of_body())) +
        " knee, the reference of a " + std::string(name(reference_->side_of_body())));
  }
  if (std::isnan(surrogate_->evaluate(Pose::Zero(), Derivatives::kNone).trust)) {
    throw std::invalid_argument(
        "hybrid contact: the surrogate does not say how far it can be trusted (output wrench "
        "alone)");
  }
}

HybridContactModel::~HybridContactModel() = default;

SideOfBody HybridContactModel::side_of_body() const { return surrogate_->side_of_body(); }

void HybridContactModel::record(const Pose& pose, double trust) const {
  const std::lock_guard lock(record_->mutex);
  ++record_->calls;
  if (record_->log.size() < kLogged) record_->log.push_back({pose, trust});
}

Vector6 HybridContactModel::trust_gradient(const Pose& pose) const {
  std::array<Pose, 12> around;
  std::array<ContactLoads, 12> loads;
  around.fill(pose);
  for (int i = 0; i < 6; ++i) {
    const double step = i < 3 ? kStep_m : kStep_rad;
    around[2 * i][i] += step;
    around[2 * i + 1][i] -= step;
  }
  surrogate_->evaluate_batch(around, Derivatives::kNone, 1, loads);
  Vector6 gradient;
  for (int i = 0; i < 6; ++i) {
    const double apart = around[2 * i][i] - around[2 * i + 1][i];
    gradient[i] = (loads[2 * i].trust - loads[2 * i + 1].trust) / apart;
  }
  return gradient;
}

ContactLoads HybridContactModel::with_reference(const Pose& pose, Derivatives derivatives,
                                                const ContactLoads& known) const {
  ContactLoads loads = reference_->evaluate(pose, derivatives);
  const double s = fraction(known.trust);
  if (s == 0.0) return loads;
  const double weight = s * s * (3.0 - 2.0 * s);
  Vector6 weight_gradient = Vector6::Zero();
  if (derivatives == Derivatives::kStiffness) {
    weight_gradient = 6.0 * s * (1.0 - s) / kBand * trust_gradient(pose);
  }
  for (int side = 0; side < kSides; ++side) {
    const Wrench difference = known.wrench[side] - loads.wrench[side];
    loads.wrench[side] += weight * difference;
    loads.stiffness[side] += weight * (known.stiffness[side] - loads.stiffness[side]) +
                             difference * weight_gradient.transpose();
    loads.error[side] += weight * (known.error[side] - loads.error[side]);
  }
  loads.trust += weight * (known.trust - loads.trust);
  loads.implausible_depth = loads.implausible_depth || known.implausible_depth;
  return loads;
}

ContactLoads HybridContactModel::evaluate(const Pose& pose, Derivatives derivatives) const {
  const ContactLoads known = surrogate_->evaluate(pose, derivatives);
  record_->evaluations.fetch_add(1, std::memory_order_relaxed);
  if (stands_alone(known)) return known;
  record(pose, known.trust);
  return with_reference(pose, derivatives, known);
}

void HybridContactModel::evaluate_batch(std::span<const Pose> poses, Derivatives derivatives,
                                        int threads, std::span<ContactLoads> loads) const {
  surrogate_->evaluate_batch(poses, derivatives, threads, loads);
  record_->evaluations.fetch_add(poses.size(), std::memory_order_relaxed);
  std::vector<std::size_t> unsure;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (stands_alone(loads[i])) continue;
    record(poses[i], loads[i].trust);
    unsure.push_back(i);
  }
  const auto body = [&](std::size_t i) {
    const std::size_t row = unsure[i];
    loads[row] = with_reference(poses[row], derivatives, loads[row]);
  };
  parallel_for(unsure.size(), threads, std::cref(body));
}

std::uint64_t HybridContactModel::evaluations() const { return record_->evaluations; }

std::uint64_t HybridContactModel::reference_calls() const {
  const std::lock_guard lock(record_->mutex);
  return record_->calls;
}

std::vector<HybridContactModel::Call> HybridContactModel::log() const {
  const std::lock_guard lock(record_->mutex);
  return record_->log;
}

}  // namespace condyle::surrogate
