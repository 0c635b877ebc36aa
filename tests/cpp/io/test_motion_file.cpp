// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "condyle/io/motion_file.hpp"
#include "io/scratch_file.hpp"
#include "support/shared_data.hpp"

using condyle::io::convert_to_radians;
using condyle::io::Motion;
using condyle::io::motion_spline;
using condyle::io::motion_text;
using condyle::io::read_motion;
using condyle::io::write_motion;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

/// Text of the refusal, without the file's name before it.
std::string refusal(const std::string& text, bool allow_nan = false) {
  const ScratchFile file("motion.sto", text);
  const std::string message = message_of<std::invalid_argument>(
      [&] { read_motion(file.path(), {.allow_nan = allow_nan}); });
  return message.starts_with(file.name()) ? message.substr(file.name().size()) : message;
}

}  // namespace

TEST_CASE("header, labels and rows are read past blanks and comments [property]") {
  const ScratchFile file("walk.mot",
                         "Coordinates\r\nversion=1\r\nnRows=2\r\nnColumns=3\r\ninDegrees=yes\r\n\r\n"
                         "Units are S.I. units (second, meters, Newtons, ...)\r\n"
                         "If the header has 'inDegrees', this says if values are in degrees (yes).\r\n\r\n"
                         "endheader\r\ntime\tknee\tpelvis_tx\r\n"
                         "      0.50\t     90.0\t  -1.5e-1\r\n  0.75 +45\t0.25\r\n\r\n");
  const Motion motion = read_motion(file.path());
  CHECK(motion.name == "Coordinates");
  CHECK(motion.names == std::vector<std::string>{"knee", "pelvis_tx"});
  CHECK(motion.times == std::vector<double>{0.5, 0.75});
  CHECK(motion.column("knee") == std::vector<double>{90, 45});
  CHECK(motion.column("pelvis_tx") == std::vector<double>{-0.15, 0.25});
  CHECK(motion.in_degrees == true);
  CHECK(motion.source == file.name());
  CHECK(motion.lines == std::vector<std::size_t>{12, 13});
}

TEST_CASE("the older header of SIMM is read, and one without a word on degrees [property]") {
  const ScratchFile file("old.mot",
                         "name walk\ndatacolumns 2\ndatarows 1\nrange 0 1\nendheader\ntime ground_force_vx\n0 3\n");
  const Motion motion = read_motion(file.path());
  CHECK(motion.name == "walk");
  CHECK(!motion.in_degrees.has_value());
  CHECK(motion.column("ground_force_vx")[0] == 3);
}

TEST_CASE("only rotational columns become radians, once [property]") {
  Motion motion;
  motion.names = {"knee", "pelvis_tx"};
  motion.times = {0.5};
  motion.columns = {{90}, {2}};
  motion.in_degrees = true;
  const auto is_knee = [](std::string_view name) { return name == "knee"; };
  convert_to_radians(motion, is_knee);
  convert_to_radians(motion, is_knee);
  CHECK(motion.columns[0][0] == doctest::Approx(std::numbers::pi / 2).epsilon(1e-15));
  CHECK(motion.columns[1][0] == 2);
  CHECK(motion.in_degrees == false);
  motion.in_degrees.reset();
  motion.source = "f.mot";
  CHECK(message_of<std::invalid_argument>([&] { convert_to_radians(motion, is_knee); }) ==
        "f.mot: column 'knee' is an angle, and the header does not say inDegrees=yes or no");
  CHECK_NOTHROW(convert_to_radians(motion, [](std::string_view) { return false; }));
}

TEST_CASE("what is written reads back to the same doubles [property]") {
  Motion motion;
  motion.name = "forces";
  motion.names = {"a", "b|c"};
  motion.times = {-1.0 / 3.0, 0.1};
  motion.columns = {{5e-324, std::numeric_limits<double>::max()}, {1e22, -0.0}};
  motion.in_degrees = false;
  const ScratchFile file("round_trip.sto");
  write_motion(motion, file.path());
  const Motion back = read_motion(file.path());
  CHECK(back.name == motion.name);
  CHECK(back.names == motion.names);
  CHECK(back.times == motion.times);
  CHECK(back.columns == motion.columns);
  CHECK(std::signbit(back.columns[1][1]));
  CHECK(back.in_degrees == false);
  motion.columns[1].pop_back();
  CHECK(message_of<std::invalid_argument>([&] { motion_text(motion); }) ==
        "motion: column 'b|c' has 1 rows where time has 2");
  motion.names[1] = "b c";
  CHECK(message_of<std::invalid_argument>([&] { motion_text(motion); }) ==
        "motion: column 'b c': a label must not be empty or hold a space");
  motion.names.pop_back();
  CHECK(message_of<std::invalid_argument>([&] { motion_text(motion); }) ==
        "motion: 2 columns have 1 names");
}

TEST_CASE("what cannot be read is named by line and column [error]") {
  const std::string head = "n\nendheader\ntime\tknee\n";
  CHECK(refusal(head + "0 1\n1 2\n") == "nothing thrown");
  CHECK(refusal("time\tknee\n0\t1\n") == ": no line 'endheader': is it an OpenSim table (STO, MOT)?");
  CHECK(refusal("n\nendheader\n") == ": no line of column labels below 'endheader'");
  CHECK(refusal("n\nendheader\nknee\ttime\n1\t0\n") ==
        ", line 3: the first column is 'knee': must be 'time'");
  CHECK(refusal("n\nendheader\ntime\tknee\tknee\n1\t0\t0\n") == ", line 3: column 'knee' is there twice");
  CHECK(refusal(head + "0\t1\t2\n") == ", line 4: 3 values where 2 columns are labelled");
  CHECK(refusal(head + "0\t1e\n") == ", line 4: column 'knee': '1e' is not a number");
  CHECK(refusal(head + "0\t1\n\n0.5\tNaN\n") == ", line 6: column 'knee': 'NaN': must be finite");
  CHECK(refusal(head + "0\tnan\n", true) == "nothing thrown");
  CHECK(refusal(head + "0\tinf\n", true) == ", line 4: column 'knee': 'inf': must be finite");
  CHECK(refusal(head + "nan\t0\n", true) == ", line 4: column 'time': 'nan': must be finite");
  CHECK(refusal(head + "0.5\t1\n0.5\t2\n") ==
        ", line 5: column 'time': 0.5 does not come after 0.500000: times must ascend");
  CHECK(refusal(head) == ": no rows below the labels");
  CHECK(refusal("n\nnRows=3\nendheader\ntime\tknee\n0\t1\n1\t2\n") ==
        ": the header says nrows=3; the table has 2 rows");
  CHECK(refusal("n\nnColumns=3\nendheader\ntime\tknee\n0\t1\n") ==
        ": the header says ncolumns=3; the table has 2 columns");
  CHECK(refusal("n\ninDegrees=maybe\nendheader\ntime\tknee\n0\t1\n") ==
        ": the header says inDegrees=maybe: must be yes or no");
  CHECK(refusal("n\nDataType=Vec3\nendheader\ntime\tknee\n0\t1\n") ==
        ": the header says DataType=Vec3: only tables of numbers (double) are read");
}

TEST_CASE("a column that is not there is named with its near miss [error]") {
  const ScratchFile file("columns.sto", "n\nendheader\ntime\tknee_flex_r\thip_flex_r\n0\t1\t2\n");
  const Motion motion = read_motion(file.path());
  CHECK(!motion.find("knee_flex_l").has_value());
  CHECK(message_of<std::invalid_argument>([&] { motion.column("knee_flx_r"); }) ==
        file.name() + ": no column 'knee_flx_r', did you mean 'knee_flex_r'? (columns: knee_flex_r, hip_flex_r)");
  const ScratchFile absent("absent.sto");
  CHECK(message_of<std::invalid_argument>([&] { read_motion(absent.path()); }) ==
        absent.name() + ": cannot be opened for reading");
}

TEST_CASE("a motion's spline has its columns and differentiates them [property]") {
  Motion motion;
  motion.source = "walk.mot";
  motion.names = {"a", "b"};
  motion.columns.resize(2);
  for (int i = 0; i < 20; ++i) {
    const double t = 0.3 + 0.01 * i;
    motion.times.push_back(t);
    motion.columns[0].push_back(0.4 - 1.5 * t + 2.25 * t * t);
    motion.columns[1].push_back(7 * t);
  }
  const auto spline = motion_spline(motion);
  // Rounding, 2e-16, over the step of 0.01 s for each derivative, and ten times that.
  CHECK(std::abs(spline(0.3777, 1)[0] - (-1.5 + 4.5 * 0.3777)) < 1e-12);
  CHECK(std::abs(spline(0.3777, 2)[0] - 4.5) < 1e-9);
  CHECK(std::abs(spline(0.3777, 1)[1] - 7) < 1e-12);
  motion.times.resize(2);
  CHECK(message_of<std::invalid_argument>([&] { motion_spline(motion); }).starts_with("walk.mot: spline: "));
}

TEST_CASE("rates of a real trial are those that OpenSim differentiates [oracle]") {
  CONDYLE_REQUIRE_DATA(data);
  const auto subject = data / "subjects" / "dm";
  if (!std::filesystem::exists(subject / "trials")) {
    MESSAGE("skipped: no trials of a subject in the data");
    return;
  }
  const Motion motion = read_motion(subject / "trials" / "DM_ngait_og1" / "coordinates.sto");
  const auto spline = motion_spline(motion);
  REQUIRE(motion.row_count() == 381);
  const auto compare = [&](const char* table, int derivative) {
    std::ifstream stream(subject / "oracles" / "DM_ngait_og1" / table);
    std::string line, cell;
    std::getline(stream, line);  // the columns are the motion's
    double worst = 0.0;
    std::size_t rows = 0;
    for (; std::getline(stream, line); ++rows) {
      std::istringstream cells(line);
      std::getline(cells, cell, ',');
      const Eigen::VectorXd ours = spline(std::stod(cell), derivative);
      for (Eigen::Index c = 0; std::getline(cells, cell, ','); ++c) {
        const double theirs = std::stod(cell);
        worst = std::max(worst, std::abs(ours[c] - theirs) / std::max(1.0, std::abs(theirs)));
      }
    }
    CHECK(rows == 381);
    return worst;
  };
  // The oracle's eight digits: half of the last is 5e-9 of a number between 1 and 10, and rounding of the splines
  // themselves, 2e-16 over (8 ms)², is below that.
  CHECK(compare("qd.csv", 1) < 1e-8);
  CHECK(compare("qdd.csv", 2) < 1e-8);
}
