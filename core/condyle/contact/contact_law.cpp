// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_law.hpp"

#include <cmath>
#include <stdexcept>

namespace condyle::contact {
namespace {

void require_valid(const LinearVolumeLaw& law) {
  if (!std::isfinite(law.modulus) || law.modulus <= 0.0) {
    throw std::invalid_argument("contact law linear_volume: modulus is " +
                                std::to_string(law.modulus) +
                                " N/m^3: must be finite and greater than 0");
  }
}

LawDescription describe_law(const LinearVolumeLaw& law) {
  return {"linear_volume", {{"modulus_N_per_m3", law.modulus}}};
}

}  // namespace

ContactLaw::ContactLaw(const Variant& law) : law_(law) {
  std::visit([](const auto& any) { require_valid(any); }, law_);
}

LawDescription ContactLaw::describe() const {
  return std::visit([](const auto& any) { return describe_law(any); }, law_);
}

}  // namespace condyle::contact
