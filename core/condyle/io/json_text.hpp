// SPDX-License-Identifier: Apache-2.0
// JSON as text, put together from the inside out: what fits on a line stands on one, the rest is indented.
// Numbers are the shortest decimals that read back to the same doubles.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "condyle/common/types.hpp"

namespace condyle::io {

/// @throws std::invalid_argument for NaN and infinity, which JSON does not have.
std::string json_number(double value);
/// A text in quotes, escaped; UTF-8 passes as it is.
std::string json_string(std::string_view text);
std::string json_numbers(std::span<const double> values);
std::string json_vector(const Vector3& value);
/// A list of items that are JSON already.
std::string json_list(const std::vector<std::string>& items);

/// An object, its keys in the order in which they are added.
class JsonObject {
 public:
  /// @param value JSON.
  void add(std::string_view key, std::string value);
  /// @throws std::invalid_argument as json_number, naming the key.
  void add_number(std::string_view key, double value);
  void add_string(std::string_view key, std::string_view value);
  /// Adds nothing for an empty list.
  void add_list(std::string_view key, const std::vector<std::string>& items);
  std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> members_;
};

}  // namespace condyle::io
