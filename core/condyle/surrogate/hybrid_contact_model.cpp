// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/hybrid_contact_model.hpp"

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

struct HybridContactModel::Record {
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

ContactLoads HybridContactModel::evaluate(const Pose& pose, Derivatives derivatives) const {
  const ContactLoads loads = surrogate_->evaluate(pose, derivatives);
  if (loads.trust >= kTrusted) return loads;
  record(pose, loads.trust);
  return reference_->evaluate(pose, derivatives);
}

void HybridContactModel::evaluate_batch(std::span<const Pose> poses, Derivatives derivatives,
                                        int threads, std::span<ContactLoads> loads) const {
  surrogate_->evaluate_batch(poses, derivatives, threads, loads);
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (loads[i].trust >= kTrusted) continue;
    record(poses[i], loads[i].trust);
    unknown.push_back(i);
  }
  const auto body = [&](std::size_t i) {
    loads[unknown[i]] = reference_->evaluate(poses[unknown[i]], derivatives);
  };
  parallel_for(unknown.size(), threads, std::cref(body));
}

std::uint64_t HybridContactModel::reference_calls() const {
  const std::lock_guard lock(record_->mutex);
  return record_->calls;
}

std::vector<HybridContactModel::Call> HybridContactModel::log() const {
  const std::lock_guard lock(record_->mutex);
  return record_->log;
}

}  // namespace condyle::surrogate
