// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "condyle/io/surface_file.hpp"
#include "io/scratch_file.hpp"
#include "support/forearm_model.hpp"

using condyle::Vector3;
using condyle::io::find_surface;
using condyle::io::read_surface_file;
using condyle::io::SurfaceFile;
using condyle::model::Model;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

Model model() {
  auto d = condyle::test::forearm_model();
  d.name = "arm";
  for (const char* name : {"olecranon", "trochlea"}) {
    d.contact_surfaces.push_back({name, {"forearm", {}, {}}, "bone.stl"});
  }
  return Model(std::move(d));
}

constexpr const char* kFrame =
    R"({"body": "forearm", "translation": [0.1, 0.2, 0.3], "orientation_xyz": [0.4, 0, -0.7]})";

std::string entry(const std::string& name, const std::string& frame,
                  const std::string& mesh = "condyle_io_bone.stl") {
  return R"({"name": ")" + name + R"(", "mesh": ")" + mesh + R"(", "frame": )" + frame + "}";
}

std::string refusal(const std::string& entries) {
  const ScratchFile mesh("bone.stl", "solid"),
      file("surfaces.json", R"({"contact_surfaces": [)" + entries + "]}");
  const std::string said =
      message_of<std::invalid_argument>([&] { read_surface_file(file.path(), model()); });
  REQUIRE(said.starts_with(file.name() + ": "));
  return said.substr(file.name().size() + 2);
}

}  // namespace

TEST_CASE("a surface has a mesh beside the file and a frame on its body") {
  const ScratchFile mesh("bone.stl", "solid"),
      file("surfaces.json", R"({"format": "of any kind", "contact_surfaces": [)" +
                                entry("trochlea", kFrame) + ", " +
                                R"({"name": "olecranon", "frame": {"body": "ground"}}]})");
  const auto surfaces = read_surface_file(file.path(), model());
  REQUIRE(surfaces.size() == 2);
  const SurfaceFile& trochlea = find_surface(surfaces, "trochlea");
  CHECK(trochlea.mesh == mesh.path());
  CHECK(trochlea.body == "forearm");
  CHECK(trochlea.X_BS.p == Vector3(0.1, 0.2, 0.3));
  // R = Rx(0.4)·Rz(−0.7): the mesh's z axis is turned by the first alone, its x axis by both.
  CHECK((trochlea.X_BS.R * Vector3::UnitZ() - Vector3(0, -std::sin(0.4), std::cos(0.4))).norm() <
        1e-15);
  const Vector3 x(std::cos(0.7), -std::sin(0.7) * std::cos(0.4), -std::sin(0.7) * std::sin(0.4));
  CHECK((trochlea.X_BS.R * Vector3::UnitX() - x).norm() < 1e-15);
  CHECK(find_surface(surfaces, "olecranon").body == "ground");
  CHECK(find_surface(surfaces, "olecranon").mesh.empty());
  CHECK(find_surface(surfaces, "olecranon").X_BS.p == Vector3(0, 0, 0));
  CHECK(message_of<std::invalid_argument>([&] { find_surface(surfaces, "trochlear"); }) ==
        "no surface 'trochlear', did you mean 'trochlea'? (surfaces: trochlea, olecranon)");
}

TEST_CASE("what a surface lacks is said by its name [error]") {
  CHECK(refusal(R"({"name": "trochlea", "mesh": "a.stl"})") ==
        "no 'frame'; contact_surfaces is a list of name, mesh and frame (body, translation, "
        "orientation_xyz), as in a model file");
  CHECK(refusal(entry("trochlear", kFrame)) ==
        "model 'arm' has no contact surface 'trochlear'; did you mean 'trochlea'?");
  CHECK(refusal(entry("trochlea", R"({"body": "tibia"})")) ==
        "model 'arm' has no body 'tibia'; it has 1 of them");
  const auto folder = std::filesystem::temp_directory_path();
  CHECK(refusal(entry("trochlea", kFrame, "condyle_no.stl")) ==
        "surface 'trochlea': there is no " + (folder / "condyle_no.stl").string());
  CHECK(refusal(entry("trochlea", kFrame) + ", " + entry("trochlea", kFrame)) ==
        "surface 'trochlea' is there twice");
  CHECK(refusal(entry("trochlea", R"({"body": "forearm", "translation": [1, 2]})")) ==
        "contact_surfaces[0] \"trochlea\": frame.translation: a list of 2: must be a list of three "
        "numbers");
}
