// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>

#include "condyle/io/path_snapshot_file.hpp"
#include "io/scratch_file.hpp"

using condyle::Vector3;
using condyle::io::parse_path_snapshots;
using condyle::io::path_snapshots_text;
using condyle::io::read_path_snapshots;
using condyle::model::ModelDescription;
using condyle::model::PathSnapshots;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

ModelDescription model() {
  ModelDescription model;
  model.name = "leg";
  model.bodies.resize(2);
  model.bodies[0].name = "femur";
  model.bodies[1].name = "tibia";
  model.muscles.resize(1);
  model.muscles[0].name = "vas";
  model.ligaments.resize(1);
  model.ligaments[0].name = "mcl";
  return model;
}

std::string file(const std::string& paths, const std::string& times = "[0.5, 0.75]") {
  return R"({"format": "condyle-path-snapshots", "version": 1, "bodies": ["tibia", "ground"], "times": )" +
         times + R"(, "paths": {)" + paths + "}}";
}

std::string refusal(const std::string& text) {
  return message_of<std::invalid_argument>([&] { parse_path_snapshots(text, "s.json", model()); });
}

}  // namespace

TEST_CASE("bodies become the model's, ground −1 [property]") {
  const ScratchFile written("snapshots.json",
                            file(R"("vas": [{"points": [[0, 0.1, 0.2, 0.3], [1, 4, 5, 6], [0, 7, 8, 9]],
                                     "arc_excess": 1e-4}], "mcl": [{"points": [[1, 1, 2, 3], [0, 3, 2, 1]]}])",
                                 "[0.5]"));
  const PathSnapshots snapshots = read_path_snapshots(written.path(), model());
  CHECK(snapshots.source == written.name());
  CHECK(snapshots.times == std::vector<double>{0.5});
  const auto* vas = snapshots.find("vas", 0);
  REQUIRE(vas != nullptr);
  REQUIRE(vas->points.size() == 3);
  CHECK(vas->points[0].body == 1);
  CHECK(vas->points[0].location == Vector3(0.1, 0.2, 0.3));
  CHECK(vas->points[1].body == -1);
  CHECK(vas->arc_excess == 1e-4);
  CHECK(snapshots.find("mcl", 0)->arc_excess == 0.0);
}

TEST_CASE("snapshots read back number for number [property]") {
  PathSnapshots snapshots;
  snapshots.times = {0.1, 1.0 / 3.0};
  snapshots.paths["mcl"] = {{{{1, {0.1, -1e-19, 0.3}}, {-1, {1, 2, 3}}}, 1.0 / 7.0},
                            {{{0, {4, 5, 6}}, {1, {7, 8, 9}}, {0, {0.7, 0.9, 1.1}}}, 0.0}};
  const std::string text = path_snapshots_text(snapshots, model(), "a test");
  const PathSnapshots back = parse_path_snapshots(text, "text", model());
  CHECK(back.times == snapshots.times);
  REQUIRE(back.paths.size() == 1);
  for (std::size_t t = 0; t < 2; ++t) {
    const auto& expected = snapshots.paths["mcl"][t];
    const auto& found = *back.find("mcl", t);
    CHECK(found.arc_excess == expected.arc_excess);
    REQUIRE(found.points.size() == expected.points.size());
    for (std::size_t p = 0; p < found.points.size(); ++p) {
      CHECK(found.points[p].body == expected.points[p].body);
      CHECK(found.points[p].location == expected.points[p].location);
    }
  }
  snapshots.paths["mcl"][1].points[0].body = 2;
  CHECK(message_of<std::invalid_argument>([&] { path_snapshots_text(snapshots, model(), ""); }) ==
        "path snapshots: 'mcl', time frame 1: body 2: the model has 2");
}

TEST_CASE("what does not fit the model or the times is refused with its place [error]") {
  const std::string ok = R"({"points": [[0, 1, 2, 3], [1, 1, 2, 3]]})";
  CHECK(refusal(file("\"vas\": [" + ok + ", " + ok + "]")) == "nothing thrown");
  CHECK(refusal(file("\"vas\": [" + ok + "]")) ==
        "s.json: paths.vas: 1 snapshots: must be one for each of the 2 times");
  CHECK(refusal(file("\"vaz\": [" + ok + ", " + ok + "]")) ==
        "s.json: paths.vaz: model 'leg' has no muscle or ligament 'vaz', did you mean 'vas'?");
  CHECK(refusal(file("", "[1, 1]")) == "s.json: times[1]: 1 s after 1 s: times must ascend");
  CHECK(refusal(file("\"vas\": [" + ok + R"(, {"points": [[2, 1, 2, 3], [1, 1, 2, 3]]}])")) ==
        "s.json: paths.vas[1].points[0]: body 2: must be an index into the file's 2 bodies, from 0");
  CHECK(refusal(file("\"vas\": [" + ok + R"(, {"points": [[0, 1, 2], [1, 1, 2, 3]]}])")) ==
        "s.json: paths.vas[1].points[0]: a list of 3: must be of 4: the body's index, x, y, z");
  CHECK(refusal(file("\"vas\": [" + ok + R"(, {"points": [[0, 1, 2, 3]]}])")) ==
        "s.json: paths.vas[1].points: a list of 1: a path has at least 2 points");
  std::string other = file("");
  other.replace(other.find("tibia"), 5, "Tibia");
  CHECK(refusal(other) == "s.json: bodies[0]: model 'leg' has no body 'Tibia', did you mean 'tibia'?");
}
