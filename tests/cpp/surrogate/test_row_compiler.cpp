// SPDX-License-Identifier: Apache-2.0
// Meanings of the operators together: test_row_program.cpp.
#include <doctest/doctest.h>

#include "condyle/surrogate/row_compiler.hpp"

using namespace condyle::surrogate;

TEST_CASE("values have a slot, a size and one maker [property]") {
  const std::map<std::string, OnnxTensor> constants{
      {"k", {"k", "float64", {3}, {1.5, 2.5, 3.5}, {}}}};
  RowCompiler compiler(constants);
  CHECK(compiler.add_value("a", {2, 3}) == 0);
  compiler.add_node({"Mul", "", {"a", "k"}, {"b"}, {}});
  CHECK(compiler.slot_of("b", {2, 3}) == 1);
  CHECK(compiler.sizes() == std::vector<std::size_t>{6, 6});
  CHECK(compiler.take_steps().size() == 1);
  CHECK_THROWS_AS(compiler.slot_of("b", {6}), UnknownGraph);
  CHECK_THROWS_WITH_AS(compiler.add_value("b", {1}), "value b is made twice", UnknownGraph);
  CHECK_THROWS_WITH_AS(compiler.add_value("k", {1}), "value k is made twice", UnknownGraph);
  CHECK_THROWS_AS(compiler.add_value("huge", {70000, 70000}), UnknownGraph);
  CHECK(element_count({4, 5, 2}) == 40);
  CHECK(element_count({}) == 1);
}
