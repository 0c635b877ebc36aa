// SPDX-License-Identifier: Apache-2.0
// A pair of bodies as a contact model: what knows knees takes any pair, such as a patellar button
// on the trochlea.
//
// F is the moving body's frame, T the fixed one's. All compartments of the pair together are given
// as one of the two sides; the other side carries nothing.
#pragma once

#include "condyle/contact/contact_model.hpp"
#include "condyle/contact/contact_pair.hpp"

namespace condyle::contact {

class PairContactModel final : public ContactModel {
 public:
  /// @param plausible_depth beyond which an overlap is flagged [m].
  /// @throws std::invalid_argument for a depth that is not finite and above 0.
  PairContactModel(ContactPair pair, SideOfBody side_of_body, Side side, double plausible_depth);

  SideOfBody side_of_body() const override { return side_of_body_; }
  const ContactPair& pair() const { return pair_; }
  /// The side that carries the loads.
  Side side() const { return side_; }

  ContactLoads evaluate(const Pose& pose, Derivatives derivatives) const override;

 private:
  ContactPair pair_;
  SideOfBody side_of_body_;
  Side side_;
  double plausible_depth_;
};

}  // namespace condyle::contact
