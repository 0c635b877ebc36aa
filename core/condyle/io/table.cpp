// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/table.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace condyle::io {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

double parse(std::string_view text, const std::string& where) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(where + ": '" + std::string(text) + "' is not a number");
  }
  return value;
}

void read_header(std::string_view line, Table& table) {
  for (const auto field : split(line)) {
    if (field.empty()) {
      throw std::invalid_argument(table.source + ": column " +
                                  std::to_string(table.names.size() + 1) + " has no name");
    }
    if (std::find(table.names.begin(), table.names.end(), field) != table.names.end()) {
      throw std::invalid_argument(table.source + ": column '" + std::string(field) +
                                  "' appears twice");
    }
    table.names.emplace_back(field);
  }
  table.columns.resize(table.names.size());
}

void require_writable(const Table& table) {
  const auto require_rows = [&](std::size_t rows, const std::string& name) {
    if (rows == table.row_count()) return;
    throw std::invalid_argument("table: column '" + name + "' has " + std::to_string(rows) +
                                " rows where the first has " + std::to_string(table.row_count()));
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    require_rows(table.columns[c].size(), table.names[c]);
  }
  for (const auto& column : table.text_columns) {
    require_rows(column.values.size(), column.name);
    for (const auto& word : column.values) {
      if (word.find_first_of(",\n\r\"") == std::string::npos) continue;
      throw std::invalid_argument("table: column '" + column.name + "': '" + word +
                                  "' holds a comma, a quote or the end of a line");
    }
  }
}

std::string header_line(const Table& table) {
  std::string text;
  for (const auto& name : table.names) text += (text.empty() ? "" : ",") + name;
  for (const auto& column : table.text_columns) text += (text.empty() ? "" : ",") + column.name;
  return text + '\n';
}

void append_row(const Table& table, std::size_t row, std::string& text) {
  char digits[32];  // the longest shortest double, -2.2250738585072014e-308, has 24
  bool first = true;
  for (const auto& column : table.columns) {
    if (!first) text += ',';
    first = false;
    text.append(digits, std::to_chars(std::begin(digits), std::end(digits), column[row]).ptr);
  }
  for (const auto& column : table.text_columns) {
    if (!first) text += ',';
    first = false;
    text += column.values[row];
  }
  text += '\n';
}

}  // namespace

void Table::add_column(std::string name, std::vector<double> values) {
  names.push_back(std::move(name));
  columns.push_back(std::move(values));
}

const std::vector<double>& Table::column(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    std::string present;
    for (const auto& other : names) present += (present.empty() ? "" : ", ") + other;
    throw std::invalid_argument(source + ": no column '" + std::string(name) +
                                "' (columns: " + present + ")");
  }
  return columns[static_cast<std::size_t>(found - names.begin())];
}

Table read_table(const std::filesystem::path& file) {
  Table table;
  table.source = file.string();
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw std::invalid_argument(table.source + ": cannot be opened for reading");
  }
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    std::string_view text = trimmed(line);
    // A spreadsheet's byte-order mark.
    if (number == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (text.empty()) continue;
    if (text.starts_with('#')) {
      table.comments.emplace_back(trimmed(text.substr(1)));
      continue;
    }
    if (table.names.empty()) {
      read_header(text, table);
      continue;
    }
    const auto fields = split(text);
    const std::string where = table.source + ", line " + std::to_string(number);
    if (fields.size() != table.names.size()) {
      throw std::invalid_argument(where + ": " + std::to_string(fields.size()) +
                                  " fields where the header has " +
                                  std::to_string(table.names.size()));
    }
    for (std::size_t c = 0; c < fields.size(); ++c) {
      table.columns[c].push_back(parse(fields[c], where + ", column '" + table.names[c] + "'"));
    }
    table.lines.push_back(number);
  }
  if (table.names.empty()) throw std::invalid_argument(table.source + ": no header line");
  if (table.row_count() == 0) {
    throw std::invalid_argument(table.source + ": no rows below the header");
  }
  return table;
}

std::string to_csv(const Table& table) {
  require_writable(table);
  std::string text;
  for (const auto& comment : table.comments) text += "# " + comment + "\n";
  text += header_line(table);
  for (std::size_t row = 0; row < table.row_count(); ++row) append_row(table, row, text);
  return text;
}

void write_whole(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::path partial = file;
  partial += ".partial";
  {
    std::ofstream stream(partial, std::ios::binary | std::ios::trunc);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.flush();
    if (!stream) {
      stream.close();
      std::error_code ignored;
      std::filesystem::remove(partial, ignored);
      throw std::runtime_error(file.string() + ": cannot be written");
    }
  }
  std::error_code error;
  std::filesystem::rename(partial, file, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw std::runtime_error(file.string() + ": cannot be written: " + error.message());
  }
}

}  // namespace condyle::io
