// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/json_node.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "condyle/io/near_miss.hpp"

namespace condyle::io {
namespace {

using Json = nlohmann::json;

const Json& as_json(const void* value) { return *static_cast<const Json*>(value); }

/// What a value is, and a short one itself.
std::string described(const Json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "a list";
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= 60 ? text : text.substr(0, 57) + "…";
}

/// "line 3, column 12" of a byte, counted from 1.
std::string place(std::string_view text, std::size_t byte) {
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
    column = text[i] == '\n' ? 1 : column + 1;
    line += text[i] == '\n' ? 1 : 0;
  }
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// The library's message without its own account of the place: "[…101] parse error at line 1, column 8: MESSAGE".
std::string cause(const std::string& message) {
  const auto after_name = message.find("] ");
  const auto colon = message.find(": ", after_name);
  if (colon != std::string::npos) return message.substr(colon + 2);
  return after_name == std::string::npos ? message : message.substr(after_name + 2);
}

/// Notes the first key that an object has twice: the library keeps the last of them without a word.
class TwiceWatch {
 public:
  bool operator()(int /*depth*/, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start) {
      open_.emplace_back();
    } else if (event == Json::parse_event_t::object_end) {
      open_.pop_back();
    } else if (event == Json::parse_event_t::key) {
      const auto& key = parsed.get_ref<const std::string&>();
      if (!open_.back().insert(key).second && twice.empty()) twice = key;
    }
    return true;
  }
  std::string twice;

 private:
  std::vector<std::set<std::string>> open_;
};

}  // namespace

struct JsonNode::Document {
  std::string source;
  Json root;
};

JsonNode::JsonNode(std::shared_ptr<const Document> document, const void* value, std::string path)
    : document_(std::move(document)), value_(value), path_(std::move(path)) {}

JsonNode JsonNode::read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file)) {
    throw std::invalid_argument(file.string() + ": cannot be opened for reading");
  }
  return parse(std::string{std::istreambuf_iterator<char>(stream), {}}, file.string());
}

JsonNode JsonNode::parse(std::string_view text, std::string source) {
  auto document = std::make_shared<Document>();
  document->source = std::move(source);
  TwiceWatch watch;
  try {
    document->root = Json::parse(text.begin(), text.end(), std::ref(watch));
  } catch (const Json::parse_error& error) {
    throw std::invalid_argument(document->source + ": " + place(text, error.byte) + ": " +
                                cause(error.what()));
  } catch (const Json::out_of_range& error) {  // a number such as 1e999
    throw std::invalid_argument(document->source + ": " + cause(error.what()) +
                                ": beyond a double's range");
  }
  if (!watch.twice.empty()) {
    throw std::invalid_argument(document->source + ": an object has the key '" + watch.twice +
                                "' twice");
  }
  const void* root = &document->root;
  return {std::move(document), root, {}};
}

void JsonNode::fail(const std::string& what) const {
  throw std::invalid_argument(document_->source + ": " + (path_.empty() ? "" : path_ + ": ") +
                              what);
}

JsonNode JsonNode::child(std::string_view key, const void* value) const {
  // After a named item the path begins anew, as a sentence does: joints[3] "knee_r": parent.body
  const char* joint = path_.empty() ? "" : path_.ends_with('"') ? ": " : ".";
  return {document_, value, path_ + joint + std::string(key)};
}

JsonNode JsonNode::child(std::size_t index, const void* value) const {
  std::string path = path_ + "[" + std::to_string(index) + "]";
  const Json& item = as_json(value);
  if (item.is_object()) {
    const auto name = item.find("name");
    if (name != item.end() && name->is_string()) {
      path.append(" \"").append(name->get_ref<const std::string&>()).append("\"");
    }
  }
  return {document_, value, std::move(path)};
}

void JsonNode::require_keys(std::initializer_list<std::string_view> known) const {
  const std::vector<std::string> allowed(known.begin(), known.end());
  for (const std::string& key : keys()) {
    if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    fail("unknown key '" + key + "'" + did_you_mean(key, allowed) +
         " (known: " + listed(allowed, allowed.size()) + ")");
  }
}

void JsonNode::require_format(std::string_view format, int version) const {
  const auto found = find("format");
  const std::string wanted =
      "a file with \"format\": \"" + std::string(format) + "\" is needed";
  if (!found) fail("no key 'format': " + wanted);
  if (found->text() != format) found->fail(described(as_json(found->value_)) + ": " + wanted);
  const JsonNode number = at("version");
  if (number.integer(0, 1000000) != version) {
    number.fail(described(as_json(number.value_)) + ": this program reads version " +
                std::to_string(version));
  }
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
  const Json& value = as_json(value_);
  if (!value.is_object()) fail(described(value) + ": must be an object");
  const auto found = value.find(std::string(key));
  if (found == value.end()) return std::nullopt;
  return child(key, &*found);
}

JsonNode JsonNode::at(std::string_view key) const {
  auto found = find(key);
  if (!found) fail("no key '" + std::string(key) + "'");
  return *std::move(found);
}

std::vector<std::string> JsonNode::keys() const {
  const Json& value = as_json(value_);
  if (!value.is_object()) fail(described(value) + ": must be an object");
  std::vector<std::string> result;
  for (const auto& item : value.items()) result.push_back(item.key());
  return result;
}

std::vector<JsonNode> JsonNode::items(std::size_t size) const {
  const Json& value = as_json(value_);
  if (!value.is_array()) fail(described(value) + ": must be a list");
  if (size > 0 && value.size() != size) {
    fail("a list of " + std::to_string(value.size()) + ": must be of " + std::to_string(size));
  }
  std::vector<JsonNode> result;
  result.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) result.push_back(child(i, &value[i]));
  return result;
}

std::vector<JsonNode> JsonNode::named_items() const {
  std::vector<JsonNode> result = items();
  std::set<std::string> names;
  for (const JsonNode& item : result) {
    const JsonNode name = item.at("name");
    if (!names.insert(name.name()).second) {
      name.fail(described(as_json(name.value_)) + " is also the name of an earlier item of " +
                path_ + ": names must differ");
    }
  }
  return result;
}

double JsonNode::number() const {
  const Json& value = as_json(value_);
  if (!value.is_number()) fail(described(value) + ": must be a number");
  return value.get<double>();
}

int JsonNode::integer(int least, int most) const {
  const double value = number();
  if (value != std::floor(value) || value < least || value > most) {
    fail(described(as_json(value_)) + ": must be a whole number from " + std::to_string(least) +
         " to " + std::to_string(most));
  }
  return static_cast<int>(value);
}

bool JsonNode::boolean() const {
  const Json& value = as_json(value_);
  if (!value.is_boolean()) fail(described(value) + ": must be true or false");
  return value.get<bool>();
}

std::string JsonNode::text() const {
  const Json& value = as_json(value_);
  if (!value.is_string()) fail(described(value) + ": must be a text");
  return value.get<std::string>();
}

std::string JsonNode::name() const {
  std::string result = text();
  if (result.empty()) fail("must not be empty");
  return result;
}

std::vector<double> JsonNode::numbers(std::size_t least) const {
  const Json& value = as_json(value_);
  if (!value.is_array()) fail(described(value) + ": must be a list of numbers");
  if (value.size() < least) {
    fail("a list of " + std::to_string(value.size()) + ": must have at least " +
         std::to_string(least));
  }
  std::vector<double> result;
  result.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!value[i].is_number()) child(i, &value[i]).number();
    result.push_back(value[i].get<double>());
  }
  return result;
}

Vector3 JsonNode::vector3() const {
  const Json& value = as_json(value_);
  if (!value.is_array() || value.size() != 3) {
    fail((value.is_array() ? "a list of " + std::to_string(value.size()) : described(value)) +
         ": must be a list of three numbers");
  }
  const std::vector<double> three = numbers();
  return {three[0], three[1], three[2]};
}

std::size_t JsonNode::one_of(std::initializer_list<std::string_view> allowed) const {
  const std::string value = text();
  std::size_t index = 0;
  for (const std::string_view word : allowed) {
    if (value == word) return index;
    ++index;
  }
  const std::vector<std::string> words(allowed.begin(), allowed.end());
  fail(described(as_json(value_)) + did_you_mean(value, words) +
       " (allowed: " + listed(words, words.size()) + ")");
}

}  // namespace condyle::io
