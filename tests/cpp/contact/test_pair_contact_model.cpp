// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/pair_contact_model.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "contact/pair_fixtures.hpp"

using namespace condyle;
using namespace condyle::contact;

TEST_CASE("a pair as a contact model: its total on one side, nothing on the other") {
  const test::PairCase scene = test::ellipsoid_in_dish(3, 20);
  const ContactPair pair = make_contact_pair(scene.moving, scene.fixed);
  const PairContactModel model(pair, SideOfBody::kLeft, kLateral, 2e-3);
  CHECK(model.side_of_body() == SideOfBody::kLeft);
  const CompartmentLoads one = pair.evaluate(scene.pose(), 0, Derivatives::kStiffness);
  REQUIRE(one.wrench.norm() > 1.0);
  const ContactLoads loads = model.evaluate(scene.pose(), Derivatives::kStiffness);
  CHECK(loads.wrench[kLateral] == one.wrench);
  CHECK(loads.stiffness[kLateral] == one.stiffness);
  CHECK(loads.wrench[kMedial].isZero(0.0));
  CHECK_FALSE(loads.implausible_depth);
  const PairContactModel strict(pair, SideOfBody::kLeft, kMedial, 0.5 * one.max_depth);
  CHECK(strict.evaluate(scene.pose(), Derivatives::kNone).implausible_depth);
  CHECK(strict.evaluate(scene.pose(), Derivatives::kNone).wrench[kMedial] == one.wrench);
  CHECK_THROWS_WITH_AS(PairContactModel(pair, SideOfBody::kLeft, kMedial, 0.0),
                       "pair contact model: plausible_depth is 0.000000 m: must be finite and above 0",
                       std::invalid_argument);
  Pose nowhere = scene.pose();
  nowhere[kZ] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(model.evaluate(nowhere, Derivatives::kNone), std::invalid_argument);
}
