// SPDX-License-Identifier: Apache-2.0
// An arm of three coordinates: elbow (driven, 0 to 2.5 rad), slide (m, −0.1 to 0.1, locked or not)
// and a force-dependent play.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "condyle/io/motion_file.hpp"
#include "condyle/io/trial_file.hpp"
#include "io/scratch_file.hpp"
#include "support/small_models.hpp"

using condyle::Vector3;
using condyle::io::Motion;
using condyle::io::motion_text;
using condyle::io::read_trial;
using condyle::io::Trial;
using condyle::io::TrialReading;
using condyle::model::Model;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Model model(bool slide_is_locked = false) {
  condyle::model::ModelDescription d;
  d.name = "arm";
  condyle::test::add_link(d, "elbow", "ground", {0.1, 0.2, 0.3}, Vector3::UnitZ(), true);
  condyle::test::add_link(d, "slide", "elbow", {0.3, 0, 0}, Vector3::UnitX(), false);
  condyle::test::add_link(d, "play", "slide", {0, 0.1, 0}, Vector3::UnitY(), false);
  for (auto& body : d.bodies) body.mass = 1.5;
  d.coordinates[0].range_max = 2.5;
  d.coordinates[1].range_min = -0.1;
  d.coordinates[1].range_max = 0.1;
  d.coordinates[1].default_value = 0.04;
  d.coordinates[1].locked = slide_is_locked;
  d.coordinates[2].default_value = 0.002;
  d.coordinates[2].role = condyle::model::CoordinateRole::kForceDependent;
  return Model(std::move(d));
}

/// 13 rows from 0.4 s, every 10 ms; elbow on a parabola [°], slide on a line [m].
Motion walk(const std::string& elbow = "elbow") {
  Motion motion;
  motion.name = "walk";
  motion.in_degrees = true;
  motion.names = {"slide", elbow};
  motion.columns.resize(2);
  for (int row = 0; row < 13; ++row) {
    const double t = 0.4 + 0.01 * row;
    motion.times.push_back(t);
    motion.columns[0].push_back(0.02 + 0.3 * t);
    motion.columns[1].push_back(10.0 + 20.0 * t * t);
  }
  return motion;
}

/// What is said about a motion in a file, without the file's name.
std::string refusal(const Motion& motion, const TrialReading& reading = {}) {
  const ScratchFile file("walk.sto", motion_text(motion));
  const std::string said =
      message_of<std::invalid_argument>([&] { read_trial(model(), file.path(), {}, reading); });
  REQUIRE(said.starts_with(file.name() + ": "));
  return said.substr(file.name().size() + 2);
}

}  // namespace

TEST_CASE("coordinates come in the model's order, in radians, with the spline's rates [oracle]") {
  const ScratchFile file("walk.sto", motion_text(walk("/jointset/joint/elbow/value")));
  const Trial trial = read_trial(model(), file.path(), {}, {.start = 0.42, .end = 0.47});
  REQUIRE(trial.times.size() == 6);
  REQUIRE(trial.q.rows() == 6);
  constexpr double kDegree = std::numbers::pi / 180.0;
  for (int row = 0; row < 6; ++row) {
    const double t = trial.times[static_cast<std::size_t>(row)];
    CHECK(t == doctest::Approx(0.42 + 0.01 * row).epsilon(1e-14));
    CHECK(trial.q(row, 0) == doctest::Approx((10.0 + 20.0 * t * t) * kDegree).epsilon(1e-14));
    CHECK(trial.q(row, 1) == doctest::Approx(0.02 + 0.3 * t).epsilon(1e-14));
    // A parabola is its own spline, up to rounding over the step once for each derivative.
    CHECK(trial.qd(row, 0) == doctest::Approx(40.0 * t * kDegree).epsilon(1e-11));
    CHECK(trial.qdd(row, 0) == doctest::Approx(40.0 * kDegree).epsilon(1e-8));
    CHECK(trial.qd(row, 1) == doctest::Approx(0.3).epsilon(1e-11));
    // What the motion says nothing of rests at its default.
    CHECK(trial.q(row, 2) == 0.002);
    CHECK(trial.qd(row, 2) == 0.0);
    CHECK(trial.qdd(row, 2) == 0.0);
  }
  CHECK(trial.at_default == std::vector<std::string>{"play"});
  CHECK(trial.loads.empty());
}

TEST_CASE("rows that are left out shape the rates of those that are taken [property]") {
  Motion motion = walk();
  for (double& value : motion.columns[1]) value += std::sin(value);
  const ScratchFile file("walk.sto", motion_text(motion));
  const Trial all = read_trial(model(), file.path());
  const Trial some = read_trial(model(), file.path(), {}, {.start = 0.43, .end = 0.45});
  REQUIRE(some.times.size() == 3);
  CHECK(some.qdd == all.qdd.middleRows(3, 3));
  CHECK(some.qdd(1, 0) != 0.0);
}

TEST_CASE("loads are put into ground where the bodies are [oracle]") {
  Motion table;
  table.name = "grf";
  for (const char* what : {"f_v", "f_p"}) {
    for (const char* axis : {"x", "y", "z"}) table.names.push_back(std::string(what) + axis);
  }
  const double values[] = {3.0, 50.0, -2.0, 0.2, 0.01, 0.03};
  table.columns.resize(6);
  for (int row = 0; row < 13; ++row) {
    table.times.push_back(0.4 + 0.01 * row);
    for (std::size_t c = 0; c < 6; ++c) table.columns[c].push_back(values[c]);
  }
  const ScratchFile motion("walk.sto", motion_text(walk())), grf("grf.sto", motion_text(table)),
      xml("loads.xml",
          "<OpenSimDocument><ExternalLoads><objects><ExternalForce name=\"plate\">"
          "<applied_to_body>slide</applied_to_body><force_identifier>f_v</force_identifier>"
          "<point_identifier>f_p</point_identifier>"
          "<point_expressed_in_body>elbow</point_expressed_in_body></ExternalForce></objects>"
          "<datafile>condyle_io_grf.sto</datafile></ExternalLoads></OpenSimDocument>");
  const Trial trial = read_trial(model(), motion.path(), xml.path(), {.start = 0.45});
  REQUIRE(trial.loads.size() == trial.times.size());
  REQUIRE(trial.loads.front().size() == 1);
  const auto& load = trial.loads.front().front();
  CHECK(load.body == 1);
  CHECK((load.force_G - Vector3(3.0, 50.0, -2.0)).norm() < 1e-12);
  const double c = std::cos(trial.q(0, 0)), s = std::sin(trial.q(0, 0));
  const Vector3 point(0.1 + 0.2 * c - 0.01 * s, 0.2 + 0.2 * s + 0.01 * c, 0.33);
  CHECK((load.point_G - point).norm() < 1e-12);
}

TEST_CASE("columns that do not match the model are named [error]") {
  CHECK(refusal(walk("elbw")) ==
        "column 'elbw' is no coordinate of model 'arm'; did you mean 'elbow'?");
  Motion motion = walk("zzz");
  motion.names[0] = "yyyyyyy";
  CHECK(refusal(motion) == "column 'yyyyyyy' is no coordinate of model 'arm' (2 such columns)");
  motion = walk();
  motion.names.pop_back();
  motion.columns.pop_back();
  CHECK(refusal(motion) == "no column for elbow; model 'arm' neither locks nor couples them");
  motion = walk("/jointset/joint/slide/value");
  CHECK(refusal(motion) ==
        "columns 'slide' and '/jointset/joint/slide/value' are both of coordinate 'slide'");

  motion = walk();
  motion.names[0] = "play";
  const ScratchFile file("walk.sto", motion_text(motion));
  const Trial trial = read_trial(model(true), file.path());
  CHECK(trial.q(5, 1) == 0.04);
  CHECK(trial.at_default.empty());
}

TEST_CASE("values in other units are refused by column, time and range [error]") {
  Motion motion = walk();
  motion.in_degrees = false;
  CHECK(
      refusal(motion) ==
      "column 'elbow' is 15.41 rad at 0.52 s; its range in model 'arm' is 0 to 2.5 rad: are these "
      "degrees, with inDegrees=no in the header?");
  motion = walk();
  motion.columns[0][4] = -23.5;
  CHECK(refusal(motion) ==
        "column 'slide' is -23.5 m at 0.44 s; its range in model 'arm' is -0.1 to 0.1 m: are these "
        "millimetres?");
  const ScratchFile file("walk.sto", motion_text(motion));
  CHECK(read_trial(model(), file.path(), {}, {.range_factor = kInfinity}).q(4, 1) == -23.5);
  // A row that is not taken is not judged.
  CHECK(read_trial(model(), file.path(), {}, {.start = 0.45}).times.size() == 8);
}

TEST_CASE("times that the motion has not are said with those it has [error]") {
  const std::string has = "; it has 0.4 to 0.52 s";
  CHECK(refusal(walk(), {.start = 3.0}) == "no time frame from 3 s" + has);
  CHECK(refusal(walk(), {.end = 0.1}) == "no time frame to 0.1 s" + has);
  CHECK(refusal(walk(), {.start = 0.5, .end = 0.45}) == "no time frame from 0.5 s to 0.45 s" + has);
  CHECK(refusal(walk(), {.start = std::nan("")}) == "no time frame from nan s" + has);
}
