// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>

#include "condyle/model/model.hpp"
#include "support/random_model.hpp"

using namespace condyle;
using namespace condyle::model;

namespace {

ModelDescription description() {
  ModelDescription d = test::random_model(3);
  d.source = "walker.json";
  return d;
}

JointDescription& joint(ModelDescription& d, const std::string& name) {
  for (JointDescription& j : d.joints) {
    if (j.name == name) return j;
  }
  throw std::logic_error("no joint " + name);
}

}  // namespace

TEST_CASE(
    "parents come before children, and a body's axes are those of its parent and its own "
    "[property]") {
  const Model model(description());
  std::vector<bool> seen(static_cast<std::size_t>(model.n_bodies()), false);
  CHECK(model.order().size() == seen.size());
  for (int b : model.order()) {
    CHECK_FALSE(seen[static_cast<std::size_t>(b)]);
    seen[static_cast<std::size_t>(b)] = true;
    const int parent = model.parent(b);
    if (parent >= 0) CHECK(seen[static_cast<std::size_t>(parent)]);
    const auto own = model.axes_to(b), parents = model.axes_to(parent);
    REQUIRE(own.size() >= parents.size());
    CHECK(std::equal(parents.begin(), parents.end(), own.begin()));
    CHECK(std::is_sorted(own.begin(), own.end()));
    CHECK(model.last_axis(b) == own.back());
  }
  CHECK(model.axes_to(-1).empty());
  CHECK(model.last_axis(-1) == -1);
  CHECK(model.parent(model.body("foot")) == model.body("shank"));
  CHECK(model.parent(model.body("trunk")) == -1);
}

TEST_CASE("what hangs on an axis is one range of axes [property]") {
  const Model model(description());
  for (int a = 0; a < model.n_axes(); ++a) {
    for (int other = 0; other < model.n_axes(); ++other) {
      int up = other;
      while (up > a) up = model.axes()[static_cast<std::size_t>(up)].predecessor;
      const bool hangs = up == a;
      CHECK(hangs == (other >= a && other < model.axes()[static_cast<std::size_t>(a)].subtree_end));
    }
  }
}

TEST_CASE("axes without terms leave no axis; welded bodies add none [property]") {
  const Model model(description());
  int moving = 0;
  for (const JointDescription& j : model.description().joints) {
    for (const auto* axes : {&j.rotations, &j.translations}) {
      for (const AxisDescription& axis : *axes) moving += axis.terms.empty() ? 0 : 1;
    }
  }
  CHECK(model.n_axes() == moving);
  CHECK(model.last_axis(model.body("boot")) == model.last_axis(model.body("foot")));
  for (const ModelAxis& axis : model.axes()) {
    CHECK(axis.direction.norm() == doctest::Approx(1.0).epsilon(1e-15));
    CHECK_FALSE(axis.terms.empty());
  }
}

TEST_CASE("couplings stand in the order in which they can be set [property]") {
  const Model model(description());
  REQUIRE(model.couplings().size() == 2);
  CHECK(model.couplings()[0].dependent == model.coordinate("q9"));
  CHECK(model.couplings()[1].dependent == model.coordinate("q10"));
  CHECK(model.dependent(model.coordinate("q10")));
  CHECK_FALSE(model.dependent(model.coordinate("q3")));
}

TEST_CASE("names are found, and unknown ones named with the model [error]") {
  const Model model(description());
  CHECK(model.body("ground") == -1);
  CHECK(model.description().bodies[static_cast<std::size_t>(model.body("arm"))].name == "arm");
  CHECK_THROWS_WITH_AS(model.body("tibia_r"), "walker.json: no body 'tibia_r'",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(model.coordinate("knee"), "walker.json: no coordinate 'knee'",
                       std::invalid_argument);
  ModelDescription nameless = description();
  nameless.source.clear();
  CHECK_THROWS_WITH_AS(Model(nameless).body("tibia_r"), "model 'random': no body 'tibia_r'",
                       std::invalid_argument);
}

TEST_CASE("what is not a tree from ground is refused by joint and body [error]") {
  ModelDescription d = description();
  joint(d, "to_shank").child.body = "arm";
  CHECK_THROWS_WITH_AS(Model{d},
                       "walker.json: joint 'to_shank': child.body 'arm' already hangs on joint "
                       "'to_arm'; a body has one joint (the model is a tree)",
                       std::invalid_argument);
  d = description();
  d.joints.erase(d.joints.begin());  // the arm's: joints are listed from the last to the first
  CHECK_THROWS_WITH_AS(
      Model{d}, "walker.json: body 'arm': is no joint's child.body; every body needs a joint",
      std::invalid_argument);
  d = description();
  joint(d, "to_thigh").parent.body = "foot";
  CHECK_THROWS_WITH_AS(Model{d},
                       doctest::Contains("hangs on itself through its parents; the tree "
                                         "must begin at 'ground'"),
                       std::invalid_argument);
  d = description();
  d.couplings.push_back({"q3", "q10", Function::linear(0.5)});
  CHECK_THROWS_WITH_AS(Model{d},
                       doctest::Contains("walker.json: couplings: coordinate 'q3' follows itself"),
                       std::invalid_argument);
}
