// SPDX-License-Identifier: Apache-2.0
// The fields of one protobuf message, one after the other
// (protobuf.dev/programming-guides/encoding).
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace condyle::surrogate {

/// The bytes are no protobuf message, or end early.
class DamagedMessage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One field: a number (varint or fixed width, as it stands) or bytes (text, message, packed).
struct ProtobufField {
  std::uint32_t number = 0;
  bool is_bytes = false;
  int width = 0;  ///< of a fixed width number: 4 or 8 bytes; 0 for a varint
  std::uint64_t value = 0;
  std::span<const char> bytes;

  /// @throws DamagedMessage unless the field is what the name says.
  std::int64_t integer() const;
  float real() const;
  std::string text() const;
  std::span<const char> message() const;
};

/// Walks over a message. Reads nothing outside the span, whatever its bytes say.
class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const char> message) : rest_(message) {}

  /// Reads the next field; false at the end. @throws DamagedMessage
  bool next(ProtobufField& field);

  /// The next varint, for packed numbers. @throws DamagedMessage
  std::uint64_t varint();
  bool at_end() const { return rest_.empty(); }

 private:
  std::span<const char> take(std::uint64_t size);
  std::span<const char> rest_;
};

}  // namespace condyle::surrogate
