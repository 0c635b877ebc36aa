// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/protobuf_reader.hpp"

#include <bit>
#include <cstddef>

namespace condyle::surrogate {
namespace {

enum WireType : std::uint64_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

std::uint64_t little_endian(std::span<const char> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  }
  return value;
}

[[noreturn]] void refuse(const ProtobufField& field, const char* wanted) {
  throw DamagedMessage("field " + std::to_string(field.number) + " is not " + wanted);
}

}  // namespace

std::int64_t ProtobufField::integer() const {
  if (is_bytes || width != 0) refuse(*this, "an integer");
  return static_cast<std::int64_t>(value);
}

float ProtobufField::real() const {
  if (is_bytes || width != 4) refuse(*this, "a float");
  return std::bit_cast<float>(static_cast<std::uint32_t>(value));
}

std::string ProtobufField::text() const {
  const auto all = message();
  return {all.begin(), all.end()};
}

std::span<const char> ProtobufField::message() const {
  if (!is_bytes) refuse(*this, "text or a message");
  return bytes;
}

std::span<const char> ProtobufReader::take(std::uint64_t size) {
  if (size > rest_.size()) throw DamagedMessage("it ends early");
  const auto taken = rest_.first(static_cast<std::size_t>(size));
  rest_ = rest_.subspan(taken.size());
  return taken;
}

std::uint64_t ProtobufReader::varint() {
  constexpr int kBits = 7;  // a byte, and one bit that says whether more follow
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += kBits) {
    const auto byte = static_cast<unsigned char>(take(1).front());
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if (byte < 0x80) return value;
  }
  throw DamagedMessage("a number has more than 64 bits");
}

bool ProtobufReader::next(ProtobufField& field) {
  if (rest_.empty()) return false;
  const std::uint64_t tag = varint();
  constexpr std::uint64_t kHighestNumber = (1u << 29) - 1;
  if (tag >> 3 == 0 || tag >> 3 > kHighestNumber) throw DamagedMessage("a field has no number");
  field = {.number = static_cast<std::uint32_t>(tag >> 3), .bytes = {}};
  switch (tag & 7) {
    case kVarint:
      field.value = varint();
      return true;
    case kFixed64:
    case kFixed32:
      field.width = (tag & 7) == kFixed64 ? 8 : 4;
      field.value = little_endian(take(static_cast<std::uint64_t>(field.width)));
      return true;
    case kBytes:
      field.is_bytes = true;
      field.bytes = take(varint());
      return true;
    default:
      throw DamagedMessage("field " + std::to_string(field.number) + " has an unknown wire type");
  }
}

}  // namespace condyle::surrogate
