// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/json_text.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace condyle::io {
namespace {

constexpr std::size_t kLineLength = 110;

/// "[" or "{" around items: on one line if they fit and are of one line each, else one a line.
std::string enclosed(const std::vector<std::string>& items, char open, char close) {
  std::size_t length = 2;
  bool short_items = true;
  for (const std::string& item : items) {
    length += item.size() + 2;
    short_items = short_items && item.find('\n') == std::string::npos;
  }
  std::string text(1, open);
  const bool one_line = short_items && length <= kLineLength;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += one_line ? ", " : ",";
    if (!one_line) text += "\n  ";
    for (const char letter : items[i]) {
      text += letter;
      if (letter == '\n') text += "  ";
    }
  }
  if (!one_line) text += '\n';
  return text + close;
}

}  // namespace

std::string json_number(double value) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(std::to_string(value) + " cannot be written to JSON");
  }
  // Readers take "-0" for the integer 0.
  if (value == 0.0 && std::signbit(value)) return "-0.0";
  char digits[32];
  return {digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr};
}

std::string json_string(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      result += '\\';
      result += letter;
    } else if (static_cast<unsigned char>(letter) < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(letter));
      result += escape;
    } else {
      result += letter;
    }
  }
  return result + '"';
}

std::string json_numbers(std::span<const double> values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ", ") + json_number(values[i]);
  }
  return text + ']';
}

std::string json_vector(const Vector3& value) { return json_numbers({value.data(), 3}); }

std::string json_list(const std::vector<std::string>& items) { return enclosed(items, '[', ']'); }

void JsonObject::add(std::string_view key, std::string value) {
  members_.emplace_back(key, std::move(value));
}

void JsonObject::add_number(std::string_view key, double value) {
  try {
    add(key, json_number(value));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(key) + ": " + error.what());
  }
}

void JsonObject::add_string(std::string_view key, std::string_view value) {
  add(key, json_string(value));
}

void JsonObject::add_list(std::string_view key, const std::vector<std::string>& items) {
  if (!items.empty()) add(key, json_list(items));
}

std::string JsonObject::text() const {
  std::vector<std::string> items;
  for (const auto& [key, value] : members_) items.push_back(json_string(key) + ": " + value);
  return enclosed(items, '{', '}');
}

}  // namespace condyle::io
