// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/motion_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "condyle/io/near_miss.hpp"
#include "condyle/io/table.hpp"

namespace condyle::io {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& letter : result) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return result;
}

/// Words apart by blanks. Between tabs alone a label may hold spaces.
void split(std::string_view line, std::string_view apart_by, std::vector<std::string_view>& words) {
  words.clear();
  for (std::size_t at = line.find_first_not_of(apart_by); at < line.size();) {
    const auto end = std::min(line.find_first_of(apart_by, at), line.size());
    const auto word = trimmed(line.substr(at, end - at));
    if (!word.empty()) words.push_back(word);
    at = line.find_first_not_of(apart_by, end);
  }
}

/// Reads one file, line by line.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const MotionReading& reading)
      : stream_(file), reading_(reading) {
    motion_.source = file.string();
    if (!stream_ || std::filesystem::is_directory(file)) fail("cannot be opened for reading");
  }

  Motion read() {
    read_header();
    read_labels();
    while (next_line()) {
      if (!line_.empty()) read_row();
    }
    if (motion_.times.empty()) fail("no rows below the labels");
    check_count({"nrows", "datarows"}, motion_.times.size(), "rows");
    check_count({"ncolumns", "datacolumns"}, motion_.names.size() + 1, "columns");
    return std::move(motion_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(motion_.source + ": " + what);
  }
  [[noreturn]] void fail_here(const std::string& what) const {
    throw std::invalid_argument(motion_.source + ", line " + std::to_string(number_) + ": " + what);
  }

  bool next_line() {
    if (!std::getline(stream_, text_)) return false;
    ++number_;
    line_ = trimmed(text_);
    if (number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_ = trimmed(line_.substr(3));
    return true;
  }

  void read_header() {
    while (next_line()) {
      if (lower(line_) == "endheader") return read_degrees();
      const auto equals = line_.find('=');
      if (equals != std::string_view::npos) {
        header_[lower(trimmed(line_.substr(0, equals)))] = trimmed(line_.substr(equals + 1));
        continue;
      }
      std::vector<std::string_view> words;  // SIMM: "datarows 381", "name walk"
      split(line_, kBlanks, words);
      if (words.size() == 2 && lower(words[0]).starts_with("data")) header_[lower(words[0])] = words[1];
      if (number_ == 1) {
        motion_.name = words.size() == 2 && lower(words[0]) == "name" ? words[1] : line_;
      }
    }
    fail("no line 'endheader': is it an OpenSim table (STO, MOT)?");
  }

  void read_degrees() {
    const auto type = header_.find("datatype");
    if (type != header_.end() && lower(type->second) != "double") {
      fail("the header says DataType=" + type->second + ": only tables of numbers (double) are read");
    }
    const auto told = header_.find("indegrees");
    if (told == header_.end()) return;
    const std::string answer = lower(told->second);
    if (answer != "yes" && answer != "no") {
      fail("the header says inDegrees=" + told->second + ": must be yes or no");
    }
    motion_.in_degrees = answer == "yes";
  }

  void read_labels() {
    do {
      if (!next_line()) fail("no line of column labels below 'endheader'");
    } while (line_.empty());
    split(line_, line_.find('\t') == std::string_view::npos ? kBlanks : "\t", words_);
    if (lower(words_.front()) != "time") {
      fail_here("the first column is '" + std::string(words_.front()) + "': must be 'time'");
    }
    for (std::size_t c = 1; c < words_.size(); ++c) {
      const std::string label(words_[c]);
      if (motion_.find(label) || lower(label) == "time") {
        fail_here("column '" + label + "' is there twice");
      }
      motion_.names.push_back(label);
    }
    motion_.columns.resize(motion_.names.size());
  }

  void read_row() {
    split(line_, kBlanks, words_);
    if (words_.size() != motion_.names.size() + 1) {
      fail_here(std::to_string(words_.size()) + " values where " +
                std::to_string(motion_.names.size() + 1) + " columns are labelled");
    }
    const double time = value(0, "time", false);
    if (!motion_.times.empty() && time <= motion_.times.back()) {
      fail_here("column 'time': " + std::string(words_[0]) + " does not come after " +
                std::to_string(motion_.times.back()) + ": times must ascend");
    }
    motion_.times.push_back(time);
    for (std::size_t c = 0; c < motion_.names.size(); ++c) {
      motion_.columns[c].push_back(value(c + 1, motion_.names[c], reading_.allow_nan));
    }
    motion_.lines.push_back(number_);
  }

  double value(std::size_t index, const std::string& column, bool allow_nan) const {
    std::string_view word = words_[index];
    if (word.starts_with('+')) word.remove_prefix(1);
    double result = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), result);
    const std::string where = "column '" + column + "': '" + std::string(words_[index]) + "'";
    if (error != std::errc() || end != word.data() + word.size()) {
      fail_here(where + " is not a number");
    }
    if (!std::isfinite(result) && !(allow_nan && std::isnan(result))) {
      fail_here(where + ": must be finite");
    }
    return result;
  }

  /// A header that counts otherwise than the table is a table cut off, or put together by hand.
  void check_count(std::initializer_list<const char*> keys, std::size_t found, const char* what) {
    for (const char* key : keys) {
      const auto told = header_.find(key);
      if (told == header_.end() || told->second == std::to_string(found)) continue;
      fail("the header says " + std::string(key) + "=" + told->second + "; the table has " +
           std::to_string(found) + " " + what);
    }
  }

  std::ifstream stream_;
  MotionReading reading_;
  Motion motion_;
  std::map<std::string, std::string> header_;  ///< keys in lower case
  std::size_t number_ = 0;                     ///< of the line, from 1
  std::string text_;
  std::string_view line_;  ///< trimmed
  std::vector<std::string_view> words_;
};

void append_number(std::string& text, double value) {
  char digits[32];
  text.append(digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr);
}

void require_writable(const Motion& motion) {
  if (motion.names.size() != motion.columns.size()) {
    throw std::invalid_argument("motion: " + std::to_string(motion.columns.size()) +
                                " columns have " + std::to_string(motion.names.size()) + " names");
  }
  for (std::size_t c = 0; c < motion.names.size(); ++c) {
    const std::string column = "motion: column '" + motion.names[c] + "'";
    if (motion.names[c].empty() || motion.names[c].find_first_of(" \t\r\n") != std::string::npos) {
      throw std::invalid_argument(column + ": a label must not be empty or hold a space");
    }
    if (motion.columns[c].size() != motion.times.size()) {
      throw std::invalid_argument(column + " has " + std::to_string(motion.columns[c].size()) +
                                  " rows where time has " + std::to_string(motion.times.size()));
    }
  }
}

}  // namespace

std::optional<std::size_t> Motion::find(std::string_view column) const {
  const auto found = std::find(names.begin(), names.end(), column);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

const std::vector<double>& Motion::column(std::string_view column) const {
  if (const auto index = find(column)) return columns[*index];
  throw std::invalid_argument(source + ": no column '" + std::string(column) + "'" +
                              did_you_mean(column, names) + " (columns: " + listed(names) + ")");
}

Motion read_motion(const std::filesystem::path& file, const MotionReading& reading) {
  return Reader(file, reading).read();
}

void convert_to_radians(Motion& motion, const std::function<bool(std::string_view)>& rotational) {
  for (std::size_t c = 0; c < motion.names.size(); ++c) {
    if (!rotational(motion.names[c])) continue;
    if (!motion.in_degrees) {
      throw std::invalid_argument(motion.source + ": column '" + motion.names[c] +
                                  "' is an angle, and the header does not say inDegrees=yes or no");
    }
    if (!*motion.in_degrees) continue;
    for (double& value : motion.columns[c]) value *= std::numbers::pi / 180.0;
  }
  if (motion.in_degrees) motion.in_degrees = false;
}

std::string motion_text(const Motion& motion) {
  require_writable(motion);
  std::string text = motion.name.empty() ? "Motion" : motion.name;
  text += "\nversion=1\nnRows=" + std::to_string(motion.times.size());
  text += "\nnColumns=" + std::to_string(motion.names.size() + 1);
  if (motion.in_degrees) text += *motion.in_degrees ? "\ninDegrees=yes" : "\ninDegrees=no";
  text += "\nendheader\ntime";
  for (const std::string& name : motion.names) text += '\t' + name;
  text += '\n';
  for (std::size_t row = 0; row < motion.times.size(); ++row) {
    append_number(text, motion.times[row]);
    for (const auto& column : motion.columns) {
      text += '\t';
      append_number(text, column[row]);
    }
    text += '\n';
  }
  return text;
}

void write_motion(const Motion& motion, const std::filesystem::path& file) {
  write_whole(file, motion_text(motion));
}

numerics::NaturalSpline motion_spline(const Motion& motion) {
  numerics::NaturalSpline::Samples samples(static_cast<Eigen::Index>(motion.times.size()),
                                           static_cast<Eigen::Index>(motion.columns.size()));
  for (std::size_t c = 0; c < motion.columns.size(); ++c) {
    for (std::size_t row = 0; row < motion.times.size(); ++row) {
      samples(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) = motion.columns[c][row];
    }
  }
  try {
    return {numerics::SplineDegree::kQuintic, motion.times, samples};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(motion.source + ": " + error.what());
  }
}

}  // namespace condyle::io
