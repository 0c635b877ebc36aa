// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>

#include "condyle/io/pose_table.hpp"
#include "io/scratch_file.hpp"
#include "support/random_pose.hpp"

using condyle::Pose;
using condyle::io::read_poses;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

std::string refusal(const ScratchFile& file) {
  return message_of<std::invalid_argument>([&] { read_poses(file.path()); });
}

}  // namespace

TEST_CASE("poses written read back the same [property]") {
  condyle::test::Draw draw(5);
  std::vector<Pose> poses;
  for (int i = 0; i < 20; ++i) poses.push_back(condyle::test::general_pose(draw));
  condyle::io::Table table;
  condyle::io::add_poses(table, poses);
  const ScratchFile file("poses.csv", condyle::io::to_csv(table));
  CHECK(read_poses(file.path()) == poses);
}

TEST_CASE("columns go by name, others are passed over [property]") {
  const ScratchFile file("order.csv",
                         "theta_z,time,x,theta_x,z,y,theta_y\n-0.6,99,0.01,0.4,0.03,0.02,0.5\n");
  const auto poses = read_poses(file.path());
  REQUIRE(poses.size() == 1);
  CHECK(poses[0] == (Pose() << 0.01, 0.02, 0.03, 0.4, 0.5, -0.6).finished());
}

TEST_CASE("a missing column is named [error]") {
  const ScratchFile file("missing.csv", "x,y,z,theta_x,theta_y\n0,0,0,0,0\n");
  CHECK(refusal(file) ==
        file.name() + ": no column 'theta_z' (columns: x, y, z, theta_x, theta_y)");
}

TEST_CASE("a value that no pose can have is named by line and column [error]") {
  const std::string header = "# poses\nx,y,z,theta_x,theta_y,theta_z\n0,0.04,0,0,0,0\n";
  const ScratchFile nan("nan.csv", header + "0,0.04,0,0,nan,0\n");
  CHECK(refusal(nan) == nan.name() + ", line 4, column 'theta_y': nan is not finite");
  const ScratchFile infinite("inf.csv", header + "0,0.04,-inf,0,0,0\n");
  CHECK(refusal(infinite) == infinite.name() + ", line 4, column 'z': -inf is not finite");
  const ScratchFile millimetres("mm.csv", header + "6.4,40.6,-0.2,0,0,0\n");
  CHECK(refusal(millimetres) ==
        millimetres.name() +
            ", line 4, column 'x': 6.4 m is no knee's position: poses are in m, at most 1 m");
  const ScratchFile degrees("degrees.csv", header + "0,0.04,0,0,0,-60\n");
  CHECK(refusal(degrees) ==
        degrees.name() +
            ", line 4, column 'theta_z': -60 rad is no knee's angle: poses are in rad, at most 2π");
}
