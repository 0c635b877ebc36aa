// SPDX-License-Identifier: Apache-2.0
// Tables in CSV files: named columns, one row a line, '#' comment lines above the header.
// Numbers are read; numbers, and after them columns of words, are written.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::io {

/// A column of words, written after the columns of numbers (a status per row, say).
struct TextColumn {
  std::string name;
  std::vector<std::string> values;
};

/// A table read from or written to a CSV file. Columns are stored whole; all have the same length.
struct Table {
  std::vector<std::string> comments;         ///< '#' lines, without their leading "# "
  std::vector<std::string> names;            ///< names of the columns of numbers, in file order
  std::vector<std::vector<double>> columns;  ///< columns[c][row]
  std::vector<TextColumn> text_columns;      ///< for writing; a table read has none
  std::string source;                        ///< the file read, for messages
  std::vector<std::size_t> lines;            ///< line of each row in the file read, for messages

  std::size_t row_count() const { return columns.empty() ? 0 : columns.front().size(); }

  /// The column of that name. @throws std::invalid_argument naming the file, the column and those
  /// present.
  const std::vector<double>& column(std::string_view name) const;

  /// Adds a column of numbers at the end.
  void add_column(std::string name, std::vector<double> values);
};

/// Reads a CSV file of numbers.
/// @throws std::invalid_argument naming the file, line, column and text of what cannot be read: no
/// such file, no
///   header, no rows, a name that is missing or appears twice, a row of another length, a text that
// is no number. NaN and /   infinity are read as such: whether they are allowed is for the
// capability to say.
Table read_table(const std::filesystem::path& file);

/// Text of a table as CSV: shortest decimals that read back to the same doubles.
/// @throws std::invalid_argument if columns differ in length or a word holds a comma or the end of
/// a line.
std::string to_csv(const Table& table);

/// Writes `text` to `file` whole or not at all (a temporary file beside it, then a rename).
/// @throws std::runtime_error naming the file when it cannot be written.
void write_whole(const std::filesystem::path& file, const std::string& text);

}  // namespace condyle::io
