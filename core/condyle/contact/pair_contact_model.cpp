// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/pair_contact_model.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace condyle::contact {

PairContactModel::PairContactModel(ContactPair pair, SideOfBody side_of_body, Side side,
                                   double plausible_depth)
    : pair_(std::move(pair)),
      side_of_body_(side_of_body),
      side_(side),
      plausible_depth_(plausible_depth) {
  if (std::isfinite(plausible_depth) && plausible_depth > 0.0) return;
  throw std::invalid_argument("pair contact model: plausible_depth is " +
                              std::to_string(plausible_depth) + " m: must be finite and above 0");
}

ContactLoads PairContactModel::evaluate(const Pose& pose, Derivatives derivatives) const {
  require_finite(pose);
  ContactLoads loads;
  for (std::size_t c = 0; c < pair_.compartments(); ++c) {
    const CompartmentLoads one = pair_.evaluate(pose, c, derivatives);
    loads.wrench[side_] += one.wrench;
    loads.stiffness[side_] += one.stiffness;
    loads.implausible_depth |= one.max_depth > plausible_depth_ || one.back_face;
  }
  return loads;
}

}  // namespace condyle::contact
