// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "condyle/io/json_node.hpp"
#include "condyle/io/json_text.hpp"
#include "io/scratch_file.hpp"

using condyle::io::json_list;
using condyle::io::json_number;
using condyle::io::json_numbers;
using condyle::io::json_string;
using condyle::io::JsonNode;
using condyle::io::JsonObject;
using condyle::test::message_of;

TEST_CASE("numbers read back to the same doubles [property]") {
  const std::vector<double> hard{
      0.1,  -1.0 / 3.0, 5e-324, std::numeric_limits<double>::max(), -2.2250738585072014e-308,
      1e22, -0.0,       7,      123456789012345680.0};
  const auto back = JsonNode::parse(json_numbers(hard), "numbers").numbers();
  REQUIRE(back.size() == hard.size());
  for (std::size_t i = 0; i < hard.size(); ++i) {
    CHECK(back[i] == hard[i]);
    CHECK(std::signbit(back[i]) == std::signbit(hard[i]));
  }
  CHECK(json_number(0.1) == "0.1");
}

TEST_CASE("texts read back letter by letter [property]") {
  const std::string hard = "a \"quoted\" \\ path\n\ttab, ° and 膝, \x01";
  CHECK(JsonNode::parse(json_string(hard), "text").text() == hard);
}

TEST_CASE("what fits on a line stands on one [property]") {
  JsonObject inner;
  inner.add_string("kind", "linear");
  inner.add_number("slope", 1.5);
  CHECK(inner.text() == R"({"kind": "linear", "slope": 1.5})");
  JsonObject outer;
  outer.add_string("name", std::string(90, 'n'));
  outer.add("function", inner.text());
  outer.add_list("none", {});
  CHECK(outer.text() == "{\n  \"name\": \"" + std::string(90, 'n') +
                            "\",\n  \"function\": {\"kind\": \"linear\", \"slope\": 1.5}\n}");
  CHECK(json_list({}) == "[]");
  CHECK(json_list({"1", "2\n"}) == "[\n  1,\n  2\n  \n]");
}

TEST_CASE("a number that JSON does not have is refused with its key [error]") {
  JsonObject object;
  const auto refusal = [&](double value) {
    return message_of<std::invalid_argument>([&] { object.add_number("mass", value); });
  };
  CHECK(refusal(std::numeric_limits<double>::quiet_NaN()) ==
        "mass: nan cannot be written to JSON");
  CHECK(refusal(-std::numeric_limits<double>::infinity()) ==
        "mass: -inf cannot be written to JSON");
}
