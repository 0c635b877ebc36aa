// SPDX-License-Identifier: Apache-2.0
// A value in a JSON file that knows where it is, so that whoever reads it can say what is wrong with it.
//
// Every message is std::invalid_argument of the form   FILE: PATH: what is wrong, and what is allowed
// where PATH names items of a list by index and, where they have one, name: joints[3] "knee_r": rotations[1].axis[2].
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/common/types.hpp"

namespace condyle::io {

class JsonNode {
 public:
  /// The whole of a file. @throws std::invalid_argument for a file that cannot be read, a syntax error (with its line and
  /// column; NaN and Infinity are no JSON), a number beyond a double's range, a key that an object has twice.
  static JsonNode read(const std::filesystem::path& file);
  /// Likewise from a text; `source` stands for the file in messages.
  static JsonNode parse(std::string_view text, std::string source);

  /// This is an object that has no other keys. An unknown one is named with the known ones, and with the near miss.
  void require_keys(std::initializer_list<std::string_view> known) const;
  /// This is an object whose `format` and `version` are these; else the message says what the file is.
  void require_format(std::string_view format, int version) const;

  /// The value of a key. @throws if it is missing, or this is no object.
  JsonNode at(std::string_view key) const;
  /// The value of a key, if it is there.
  std::optional<JsonNode> find(std::string_view key) const;
  /// Keys of an object, ascending.
  std::vector<std::string> keys() const;
  /// Items of a list. @throws if this is none, or (size > 0) has another number of items.
  std::vector<JsonNode> items(std::size_t size = 0) const;
  /// This list's items, each an object with a `name`. @throws if a name is empty or appears twice.
  std::vector<JsonNode> named_items() const;

  double number() const;
  /// A whole number within limits.
  int integer(int least, int most) const;
  bool boolean() const;
  std::string text() const;
  /// A text that is not empty.
  std::string name() const;
  /// A list of numbers. @throws likewise, or if it has fewer than `least`.
  std::vector<double> numbers(std::size_t least = 0) const;
  Vector3 vector3() const;
  /// Index of this text among those allowed.
  std::size_t one_of(std::initializer_list<std::string_view> allowed) const;

  /// Refuses this value. @throws std::invalid_argument, always.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Document;
  JsonNode(std::shared_ptr<const Document> document, const void* value, std::string path);
  JsonNode child(std::string_view key, const void* value) const;
  JsonNode child(std::size_t index, const void* value) const;

  std::shared_ptr<const Document> document_;
  const void* value_ = nullptr;  ///< in the document; its type is the .cpp's own
  std::string path_;
};

}  // namespace condyle::io
