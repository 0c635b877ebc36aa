// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "condyle/surrogate/protobuf_reader.hpp"

using condyle::surrogate::DamagedMessage;
using condyle::surrogate::ProtobufField;
using condyle::surrogate::ProtobufReader;

namespace {

std::vector<char> bytes(std::initializer_list<int> values) {
  std::vector<char> all;
  for (const int value : values) all.push_back(static_cast<char>(value));
  return all;
}

}  // namespace

TEST_CASE("the encoding guide's own examples are read [oracle]") {
  // protobuf.dev/programming-guides/encoding: field 1 = 150; field 2 = "testing".
  const auto message = bytes({0x08, 0x96, 0x01, 0x12, 0x07, 't', 'e', 's', 't', 'i', 'n', 'g'});
  ProtobufReader reader(message);
  ProtobufField field;
  REQUIRE(reader.next(field));
  CHECK(field.number == 1);
  CHECK(field.integer() == 150);
  CHECK_THROWS_AS(field.text(), DamagedMessage);
  REQUIRE(reader.next(field));
  CHECK(field.number == 2);
  CHECK(field.text() == "testing");
  CHECK_THROWS_AS(field.integer(), DamagedMessage);
  CHECK_FALSE(reader.next(field));
}

TEST_CASE("negative and fixed-width numbers are read [oracle]") {
  // -2 as a varint is ten bytes; -0.15625f is 0xbe200000, little-endian.
  const auto message = bytes({0x18, 0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01,
                              0x25, 0x00, 0x00, 0x20, 0xbe});
  ProtobufReader reader(message);
  ProtobufField field;
  REQUIRE(reader.next(field));
  CHECK(field.integer() == -2);
  REQUIRE(reader.next(field));
  CHECK(field.real() == -0.15625f);
}

TEST_CASE("what ends early or makes no sense is refused [error]") {
  for (const auto& message :
       {bytes({0x08}), bytes({0x08, 0x96}), bytes({0x12, 0x05, 'a'}), bytes({0x25, 0, 0, 0}),
        bytes({0x12, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}),  // length 2^64-1
        bytes({0x00, 0x01}),                                                        // field 0
        bytes({0x0b}),                                                              // a group
        bytes({0x08, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01})}) {
    ProtobufReader reader(message);
    ProtobufField field;
    CHECK_THROWS_AS(reader.next(field), DamagedMessage);
  }
}
