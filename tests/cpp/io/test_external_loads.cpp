// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "condyle/io/external_loads.hpp"
#include "condyle/model/model.hpp"
#include "io/scratch_file.hpp"
#include "support/shared_data.hpp"

using condyle::Vector3;
using condyle::io::BodyLoad;
using condyle::io::ExternalLoads;
using condyle::io::ExternalLoadsSettings;
using condyle::io::ExternalLoadsSpec;
using condyle::io::Motion;
using condyle::test::message_of;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ExternalLoadsSpec spec() {
  ExternalLoadsSpec result;
  result.source = "loads.xml";
  result.forces = {{"plate", "calcn_r", "ground", "ground", "f_v", "f_p", "f_m"}};
  return result;
}

/// Force, point and moment every 10 ms from 1 s; in rows 8 to 14 the force is zero.
Motion table(int rows = 20) {
  Motion motion;
  motion.source = "grf.sto";
  for (const char* quantity : {"f_v", "f_p", "f_m"}) {
    for (const char* component : {"x", "y", "z"}) motion.names.push_back(std::string(quantity) + component);
  }
  motion.columns.resize(9);
  for (int row = 0; row < rows; ++row) {
    motion.times.push_back(1.0 + 0.01 * row);
    const bool loaded = row < 8 || row > 14;
    for (int c = 0; c < 9; ++c) {
      const double value = std::sin(0.1 * row * (c + 1)) + 0.1 * c;
      motion.columns[static_cast<std::size_t>(c)].push_back(loaded || c / 3 == 1 ? value : 0.0);
    }
  }
  return motion;
}

std::string refusal(const Motion& motion, const ExternalLoadsSpec& loads = spec(),
                    const ExternalLoadsSettings& settings = {}) {
  return message_of<std::invalid_argument>([&] { ExternalLoads(loads, motion, settings); });
}

}  // namespace

TEST_CASE("at the table's times the loads are its rows [property]") {
  const Motion motion = table();
  const ExternalLoads loads(spec(), motion);
  for (std::size_t row = 0; row < motion.times.size(); ++row) {
    const BodyLoad load = loads.at(motion.times[row])[0];
    CHECK(load.body == "calcn_r");
    CHECK((load.force_frame == "ground" && load.point_frame == "ground"));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto c = static_cast<Eigen::Index>(i);
      CHECK(std::abs(load.force[c] - motion.columns[i][row]) < 1e-14);  // rounding of numbers about 1
      CHECK(std::abs(load.point[c] - motion.columns[3 + i][row]) < 1e-14);
      CHECK(std::abs(load.moment[c] - motion.columns[6 + i][row]) < 1e-14);
    }
  }
}

TEST_CASE("one step beyond the table is its end, more is refused [error]") {
  const ExternalLoads loads(spec(), table());
  CHECK(loads.at(0.991)[0].force == loads.at(1.0)[0].force);
  CHECK(loads.at(1.199)[0].point == loads.at(loads.last_time())[0].point);
  CHECK(message_of<std::invalid_argument>([&] { loads.at(0.98); }) ==
        "grf.sto: no loads at 0.98 s: the table is from 1 to 1.19 s");
  CHECK(message_of<std::invalid_argument>([&] { loads.at(1.25); }).starts_with("grf.sto: no loads at 1.25 s"));
}

TEST_CASE("without a force, point and moment may be missing [property]") {
  Motion motion = table();
  for (std::size_t row = 8; row <= 14; ++row) {
    for (std::size_t c = 3; c < 9; ++c) motion.columns[c][row] = kNan;
  }
  const ExternalLoads loads(spec(), motion);
  const BodyLoad middle = loads.at(motion.times[11])[0];
  CHECK(middle.force.norm() < 1e-14);
  CHECK(middle.moment.norm() < 1e-14);
  // Row 11 is half way between the neighbours of the gap, rows 7 and 15.
  for (std::size_t i = 0; i < 3; ++i) {
    const double half = 0.5 * (motion.columns[3 + i][7] + motion.columns[3 + i][15]);
    CHECK(std::abs(middle.point[static_cast<Eigen::Index>(i)] - half) < 1e-14);
  }
}

TEST_CASE("a gap is refused with its column and span [error]") {
  Motion motion = table();
  motion.columns[1][3] = motion.columns[1][4] = motion.columns[1][5] = kNan;
  CHECK(refusal(motion) ==
        "grf.sto: column 'f_vy' is NaN from 1.03 to 1.05 s: the force 'plate' has a gap there: fill it, or "
        "leave these times out");
  motion = table();
  for (std::size_t c = 0; c < 3; ++c) motion.columns[c][3] = c == 1 ? 7.25 : 0.0;
  motion.columns[3][2] = motion.columns[3][3] = kNan;
  motion.columns[0][2] = motion.columns[1][2] = motion.columns[2][2] = 0.0;
  CHECK(refusal(motion) ==
        "grf.sto: column 'f_px' is NaN from 1.02 to 1.03 s, while the force 'plate' is 7.25 N at 1.03 s (up to 0 N "
        "it may be: negligible_force)");
  // Below the laboratory's threshold it is no load at all.
  const ExternalLoads loads(spec(), motion, {.negligible_force = 10.0});
  CHECK(loads.at(motion.times[3])[0].force.norm() < 1e-14);
  CHECK(refusal(motion, spec(), {.negligible_force = -1}) ==
        "external loads: negligible_force is -1.000000 N: must be at least 0");
}

TEST_CASE("missing rows are refused where there is a load [error]") {
  const auto without = [](std::size_t first, std::size_t last) {
    Motion motion = table();
    const auto cut = [&](auto& values) {
      values.erase(values.begin() + static_cast<std::ptrdiff_t>(first),
                   values.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    };
    cut(motion.times);
    for (auto& column : motion.columns) cut(column);
    return refusal(motion);
  };
  CHECK(without(9, 13) == "nothing thrown");
  const std::string message = without(3, 4);
  CHECK(message.starts_with("grf.sto: no rows from 1.02 to 1.05 s, where rows are 0.01"));
  CHECK(message.ends_with(" s apart, while 'plate' acts: fill the gap, or leave these times out"));
}

TEST_CASE("an identifier without three columns is named with its near miss [error]") {
  ExternalLoadsSpec loads = spec();
  loads.forces[0].force_identifier = "g_v";
  CHECK(refusal(table(), loads) ==
        "grf.sto: force 'plate' of loads.xml: 0 columns begin with 'g_v': must be three, did you mean 'f_v'? "
        "(columns: f_vx, f_vy, f_vz, f_px, f_py, f_pz, f_mx, f_my, f_mz)");
  // Other endings than x, y, z: the three in the table's order.
  Motion motion = table();
  motion.names[0] = "f_v1";
  motion.names[1] = "f_v2";
  motion.names[2] = "f_v3";
  CHECK(ExternalLoads(spec(), motion).at(1.0)[0].force == ExternalLoads(spec(), table()).at(1.0)[0].force);
}

TEST_CASE("loads in other frames come to ground with their bodies [property]") {
  condyle::model::ModelDescription description;
  description.name = "foot";
  description.bodies.resize(1);
  description.bodies[0].name = "calcn_r";
  description.bodies[0].mass = 1.2;
  condyle::model::JointDescription joint;
  joint.name = "free";
  joint.child.body = "calcn_r";
  joint.parent.translation = {0.2, 0.3, -0.4};
  for (int i = 0; i < 3; ++i) {
    joint.rotations[static_cast<std::size_t>(i)].axis = Vector3::Unit(i);
    joint.translations[static_cast<std::size_t>(i)].axis = Vector3::Unit(i);
  }
  joint.rotations[1].axis = Vector3(0.3, 0.5, -0.7);
  joint.rotations[1].terms = {{"turn", condyle::model::Function::linear(1.0)}};
  description.joints = {joint};
  description.coordinates.resize(1);
  description.coordinates[0].name = "turn";
  const condyle::model::Model model(description);
  condyle::model::Kinematics kinematics(model);
  kinematics.set(Eigen::VectorXd::Constant(1, 0.7));
  const condyle::RigidTransform& X_GB = kinematics.X_GB(0);
  REQUIRE((X_GB.R - condyle::Matrix3::Identity()).norm() > 0.1);

  ExternalLoadsSpec loads = spec();
  loads.forces.push_back({"body", "calcn_r", "calcn_r", "calcn_r", "f_v", "f_p", "f_m"});
  loads.forces.push_back({"origin", "calcn_r", "ground", "ground", "f_v", "", ""});
  const ExternalLoads external(loads, table());
  const auto raw = external.at(1.037);
  const auto in_ground = external.in_ground(1.037, kinematics);
  REQUIRE(in_ground.size() == 3);
  const double rounding = 1e-15;  // of numbers about 1, in sums of three
  CHECK(in_ground[0].body == 0);
  CHECK((in_ground[0].force_G - raw[0].force).norm() < rounding);
  CHECK((in_ground[0].point_G - raw[0].point).norm() < rounding);
  CHECK((in_ground[1].force_G - X_GB.R * raw[0].force).norm() < rounding);
  CHECK((in_ground[1].moment_G - X_GB.R * raw[0].moment).norm() < rounding);
  CHECK((in_ground[1].point_G - X_GB * raw[0].point).norm() < rounding);
  CHECK((in_ground[2].point_G - X_GB.p).norm() < rounding);
  CHECK(in_ground[2].moment_G.isZero(0.0));

  CHECK_NOTHROW(external.require_bodies(description));
  description.bodies[0].name = "calcn_l";
  CHECK(message_of<std::invalid_argument>([&] { external.require_bodies(description); }) ==
        "loads.xml: force 'plate': applied_to_body is 'calcn_r': model 'foot' has no such body, did you mean "
        "'calcn_l'? (bodies: ground, calcn_l)");
}

TEST_CASE("forces of a real trial are OpenSim's [oracle]") {
  CONDYLE_REQUIRE_DATA(data);
  const auto subject = data / "subjects" / "dm";
  if (!std::filesystem::exists(subject / "trials")) {
    MESSAGE("skipped: no trials of a subject in the data");
    return;
  }
  const ExternalLoads loads =
      ExternalLoads::read(subject / "trials" / "DM_ngait_og1" / "external_loads.xml");
  std::ifstream stream(subject / "oracles" / "DM_ngait_og1" / "external_forces.csv");
  std::string line, cell;
  std::getline(stream, line);
  double worst = 0.0, largest = 0.0;
  std::size_t rows = 0;
  for (; std::getline(stream, line); ++rows) {
    std::istringstream cells(line);
    std::getline(cells, cell, ',');
    for (const BodyLoad& load : loads.at(std::stod(cell))) {
      for (const Vector3* vector : {&load.force, &load.point, &load.moment}) {
        for (int i = 0; i < 3; ++i) {
          REQUIRE(std::getline(cells, cell, ','));
          const double theirs = std::strtod(cell.c_str(), nullptr);  // some are below the least normal double
          worst = std::max(worst, std::abs((*vector)[i] - theirs) / std::max(1.0, std::abs(theirs)));
          largest = std::max(largest, std::abs(theirs));
        }
      }
    }
  }
  CHECK(rows == 381);
  CHECK(largest > 500);  // N: the foot was on the ground
  CHECK(worst < 5.1e-8);  // the oracle's eight digits: half of the last, of a number that begins with 1
}
