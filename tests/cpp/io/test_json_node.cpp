// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <functional>
#include <stdexcept>

#include "condyle/io/json_node.hpp"
#include "io/scratch_file.hpp"

using condyle::io::JsonNode;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

std::string refusal(const std::string& text, const std::function<void(const JsonNode&)>& read) {
  return message_of<std::invalid_argument>([&] { read(JsonNode::parse(text, "f.json")); });
}

std::string syntax(const std::string& text) {
  return refusal(text, [](const JsonNode&) {});
}

}  // namespace

TEST_CASE("values of each type are read [property]") {
  const ScratchFile file("node.json",
                         R"({"n": -2.5, "i": 3, "b": true, "t": "text", "v": [1, 2, 3], "l": [{"name": "a"}]})");
  const JsonNode root = JsonNode::read(file.path());
  CHECK(root.keys() == std::vector<std::string>{"b", "i", "l", "n", "t", "v"});
  CHECK(root.at("n").number() == -2.5);
  CHECK(root.at("i").integer(-1, 3) == 3);
  CHECK(root.at("b").boolean());
  CHECK(root.at("t").text() == "text");
  CHECK(root.at("t").one_of({"other", "text"}) == 1);
  CHECK(root.at("v").vector3() == condyle::Vector3(1, 2, 3));
  CHECK(root.at("l").named_items().size() == 1);
  CHECK(!root.find("absent").has_value());
  // A node outlives the one it was taken from.
  CHECK([&] { return JsonNode::parse("[[7]]", "s").items()[0].items()[0]; }().number() == 7);
}

TEST_CASE("a syntax error gives line and column [error]") {
  CHECK(syntax("{\n  \"a\": 1,\n  \"b\" 2\n}").starts_with("f.json: line 3, column 7: "));
  CHECK(syntax("[1, NaN]").starts_with("f.json: line 1, column 5: "));
  CHECK(syntax("").starts_with("f.json: line 1, column 1: "));
  CHECK(syntax("[1, 1e999]") == "f.json: number overflow parsing '1e999': beyond a double's range");
  CHECK(syntax(R"({"a": [{"m": 1, "k": 2, "m": 3}]})") ==
        "f.json: an object has the key 'm' twice");
  CHECK(syntax(R"([{"m": 1}, {"m": {"m": 2}}])") == "nothing thrown");
  const ScratchFile absent("absent.json");
  CHECK(message_of<std::invalid_argument>([&] { JsonNode::read(absent.path()); }) ==
        absent.name() + ": cannot be opened for reading");
}

TEST_CASE("a message says where a value is [error]") {
  const std::string text = R"({"joints": [{}, {"name": "knee", "axes": [{"terms": [1, "two"]}]}]})";
  CHECK(refusal(text, [](const JsonNode& root) {
          root.at("joints").items()[1].at("axes").items()[0].at("terms").items()[1].number();
        }) == R"(f.json: joints[1] "knee": axes[0].terms[1]: "two": must be a number)");
  CHECK(refusal(text, [](const JsonNode& root) { root.at("joints").items()[1].at("parent"); }) ==
        R"(f.json: joints[1] "knee": no key 'parent')");
}

TEST_CASE("what is of another type, length or choice is refused [error]") {
  const auto message = [](const std::string& value, void (*read)(const JsonNode&)) {
    return refusal("{\"v\": " + value + "}", [&](const JsonNode& root) { read(root.at("v")); });
  };
  CHECK(message("null", [](const JsonNode& v) { v.number(); }) == "f.json: v: null: must be a number");
  CHECK(message("1.5", [](const JsonNode& v) { v.integer(0, 9); }) ==
        "f.json: v: 1.5: must be a whole number from 0 to 9");
  CHECK(message("10", [](const JsonNode& v) { v.integer(0, 9); }) ==
        "f.json: v: 10: must be a whole number from 0 to 9");
  CHECK(message("1", [](const JsonNode& v) { v.boolean(); }) == "f.json: v: 1: must be true or false");
  CHECK(message("{}", [](const JsonNode& v) { v.text(); }) == "f.json: v: an object: must be a text");
  CHECK(message("\"\"", [](const JsonNode& v) { v.name(); }) == "f.json: v: must not be empty");
  CHECK(message("[1, 2]", [](const JsonNode& v) { v.vector3(); }) ==
        "f.json: v: a list of 2: must be a list of three numbers");
  CHECK(message("[1, [], 2]", [](const JsonNode& v) { v.vector3(); }) ==
        "f.json: v[1]: a list: must be a number");
  CHECK(message("[1]", [](const JsonNode& v) { v.numbers(2); }) ==
        "f.json: v: a list of 1: must have at least 2");
  CHECK(message("[1]", [](const JsonNode& v) { v.items(3); }) ==
        "f.json: v: a list of 1: must be of 3");
  CHECK(message("2", [](const JsonNode& v) { v.items(); }) == "f.json: v: 2: must be a list");
  CHECK(message("2", [](const JsonNode& v) { v.find("x"); }) == "f.json: v: 2: must be an object");
  CHECK(message("\"Sphere\"", [](const JsonNode& v) { v.one_of({"cylinder", "sphere"}); }) ==
        "f.json: v: \"Sphere\", did you mean 'sphere'? (allowed: cylinder, sphere)");
}

TEST_CASE("unknown keys and names that are there twice are refused [error]") {
  CHECK(refusal(R"({"mass": 1, "mass_center": 2})",
                [](const JsonNode& root) { root.require_keys({"mass", "mass_centre"}); }) ==
        "f.json: unknown key 'mass_center', did you mean 'mass_centre'? (known: mass, mass_centre)");
  CHECK(refusal(R"({"bodies": [{"name": "a"}, {"name": "b"}, {"name": "a"}]})",
                [](const JsonNode& root) { root.at("bodies").named_items(); }) ==
        R"(f.json: bodies[2] "a": name: "a" is also the name of an earlier item of bodies: names must differ)");
}

TEST_CASE("a file of another format or version says what it is [error]") {
  const auto message = [](const std::string& text) {
    return refusal(text, [](const JsonNode& root) { root.require_format("wanted", 2); });
  };
  CHECK(message(R"({"format": "wanted", "version": 2})") == "nothing thrown");
  CHECK(message("{}") == "f.json: no key 'format': a file with \"format\": \"wanted\" is needed");
  CHECK(message(R"({"format": "else", "version": 2})") ==
        "f.json: format: \"else\": a file with \"format\": \"wanted\" is needed");
  CHECK(message(R"({"format": "wanted", "version": 3})") ==
        "f.json: version: 3: this program reads version 2");
  CHECK(message(R"({"format": "wanted"})") == "f.json: no key 'version'");
}
