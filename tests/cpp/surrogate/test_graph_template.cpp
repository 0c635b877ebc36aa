// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/surrogate/graph_template.hpp"

using namespace condyle::surrogate;

namespace {

/// sum = x + shift, twice = Mul(sum, factor)
OnnxFile small_file() {
  OnnxFile file;
  file.opsets[""] = 17;
  file.signature.inputs = {{"x", "float64", {-1, 3}}};
  file.initialisers["shift"] = {"shift", "float64", {3}, {0.3, -1.7, 2.9}, {}};
  file.initialisers["factor"] = {"factor", "float64", {}, {2.5}, {}};
  file.initialisers["order"] = {"order", "int64", {2}, {}, {2, 0}};
  file.nodes.push_back({"Add", "", {"x", "shift"}, {"sum"}, {}});
  file.nodes.push_back({"Mul", "", {"sum", "factor"}, {"scaled"}, {}});
  file.nodes.push_back({"Gather",
                        "",
                        {"scaled", "order"},
                        {"picked"},
                        {GraphTemplate::integer_attribute("axis", 1)}});
  return file;
}

template <typename Body>
std::string refusal(const OnnxFile& file, const Body& body) {
  try {
    GraphTemplate graph(file);
    body(graph);
  } catch (const UnknownGraph& unknown) {
    return unknown.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("what is expected is matched, the rest is left [property]") {
  const OnnxFile file = small_file();
  GraphTemplate graph(file);
  CHECK(graph.rest().size() == 3);
  graph.expect("Add", {"x", "shift"}, "sum");
  graph.expect("Gather", {"scaled", "order"}, "picked",
               {GraphTemplate::integer_attribute("axis", 1)});
  REQUIRE(graph.rest().size() == 1);
  CHECK(graph.rest()[0]->op_type == "Mul");
  graph.expect_doubles("shift", {3}, {0.3, -1.7, 2.9});
  graph.expect_number("factor", 2.5);
  graph.expect_integers("order", {2, 0});
  CHECK(graph.has_constant("order"));
  CHECK_FALSE(graph.has_constant("x"));
}

TEST_CASE("each departure is named [error]") {
  const OnnxFile file = small_file();
  using Graph = GraphTemplate;
  CHECK(refusal(file, [](Graph& g) {
          g.expect("Sub", {"x", "shift"}, "sum");
        }) == "sum is made by Add, not Sub");
  CHECK(refusal(file, [](Graph& g) {
          g.expect("Add", {"shift", "x"}, "sum");
        }) == "the inputs of sum are others");
  CHECK(refusal(file, [](Graph& g) {
          g.expect("Gather", {"scaled", "order"}, "picked");
        }) == "the attributes of picked are others");
  CHECK(refusal(file, [](Graph& g) {
          g.expect("Add", {"x", "shift"}, "total");
        }) == "no node makes total");
  CHECK(refusal(file, [](Graph& g) { g.expect_number("factor", 2.5000001); }) ==
        "constant factor is not what it has to be");
  CHECK(refusal(file, [](Graph& g) { g.doubles("order"); }) ==
        "there is no float64 constant order");
  CHECK(refusal(file, [](Graph& g) { g.integers("shift"); }) == "there is no int64 constant shift");
  OnnxFile twice = small_file();
  twice.nodes.push_back({"Neg", "", {"x"}, {"factor"}, {}});
  CHECK(refusal(twice, [](Graph&) {}) == "value factor is made twice");
  OnnxFile old = small_file();
  old.opsets[""] = 16;
  CHECK(refusal(old, [](Graph&) {}) == "its operators are not those of opset 17");
}
