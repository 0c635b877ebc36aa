// SPDX-License-Identifier: Apache-2.0
// OpenSim's storage tables (STO and MOT files): a header to the line "endheader", a line of labels, rows of numbers.
//
//   Coordinates                    name
//   version=1
//   nRows=381                      checked, where they are given; also SIMM's datarows and datacolumns
//   nColumns=53
//   inDegrees=yes                  of rotational columns
//   endheader
//   time	pelvis_tilt	…       labels, and numbers below, apart by tabs or spaces; the first column is time [s]
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/numerics/natural_spline.hpp"

namespace condyle::io {

/// A table over time. Columns are stored whole; units are the file's until convert_to_radians.
struct Motion {
  std::string name;                          ///< the header's first line
  std::vector<std::string> names;            ///< of the columns, without time
  std::vector<double> times;                 ///< ascending [s]
  std::vector<std::vector<double>> columns;  ///< columns[c][row]
  std::optional<bool> in_degrees;            ///< of rotational columns; nothing where the header does not say
  std::string source;                        ///< the file read, for messages
  std::vector<std::size_t> lines;            ///< line of each row in the file read, for messages

  std::size_t row_count() const { return times.size(); }
  /// Index of a column; nothing where there is none.
  std::optional<std::size_t> find(std::string_view column) const;
  /// @throws std::invalid_argument naming file, column, the near miss and the columns there are.
  const std::vector<double>& column(std::string_view column) const;
};

struct MotionReading {
  /// NaN is a gap that whoever reads on copes with (a centre of pressure without a force); infinity is refused always.
  bool allow_nan = false;
};

/// Reads an STO or MOT file.
/// @throws std::invalid_argument naming the file, and the line, column and text of what cannot be read: no "endheader", no
/// `time` as the first column, a label that is there twice, a row of another length, a text that is no number, NaN, times
/// that do not ascend, another number of rows or columns than the header says.
Motion read_motion(const std::filesystem::path& file, const MotionReading& reading = {});

/// Makes the columns for which `rotational` is true radians, if they are degrees.
/// @throws std::invalid_argument naming the file and the first such column where the header does not say which they are.
void convert_to_radians(Motion& motion, const std::function<bool(std::string_view)>& rotational);

/// Text of an STO file, numbers as shortest decimals that read back to the same doubles.
/// @throws std::invalid_argument naming a column of another length or a label that is empty or holds a space.
std::string motion_text(const Motion& motion);
/// Writes it, whole or not at all. @throws std::runtime_error naming the file when it cannot be written.
void write_motion(const Motion& motion, const std::filesystem::path& file);

/// The columns as functions of time with continuous fourth derivative; its columns are the motion's.
/// What OpenSim's inverse dynamics differentiates (numerics/natural_spline.hpp).
/// @throws std::invalid_argument naming the file for fewer than 3 rows or a value that is not finite.
numerics::NaturalSpline motion_spline(const Motion& motion);

}  // namespace condyle::io
