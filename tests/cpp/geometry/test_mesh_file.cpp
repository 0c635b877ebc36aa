// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "condyle/geometry/mesh_file.hpp"
#include "condyle/geometry/mesh_report.hpp"
#include "geometry/shapes.hpp"

using namespace condyle;
using namespace condyle::geometry;
namespace fs = std::filesystem;

namespace {

/// A folder of its own, gone at the end.
struct Scratch {
  Scratch() : folder(fs::temp_directory_path() / "condyle_test_mesh_file") {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~Scratch() { fs::remove_all(folder); }
  fs::path operator()(const char* name) const { return folder / name; }
  fs::path write(const char* name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  fs::path folder;
};

/// What is written to std::cerr and std::cout while it lives.
class Listener {
 public:
  Listener() : err_(std::cerr.rdbuf(text_.rdbuf())), out_(std::cout.rdbuf(text_.rdbuf())) {}
  ~Listener() {
    std::cerr.rdbuf(err_);
    std::cout.rdbuf(out_);
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::streambuf *err_, *out_;
};

TriangleMesh sample() {
  return test::patch(0.0041, -0.0103, 0.0217, 5,
                     [](double x, double z) { return 7.0 * x * z + 0.0031; });
}

/// The one line that reading this file ends in; also checks that nothing was printed.
std::string complaint(const fs::path& file, LengthUnit unit = LengthUnit::kMetre) {
  std::string text = "(read without complaint)", printed;
  {
    const Listener listener;
    try {
      read_mesh(file, unit);
    } catch (const std::invalid_argument& error) {
      text = error.what();
    }
    printed = listener.text();
  }
  CHECK(printed == "");
  CHECK(text.find('\n') == std::string::npos);
  const std::string prefix = file.string() + ": ";
  REQUIRE(text.substr(0, prefix.size()) == prefix);
  return text.substr(prefix.size());
}

std::string binary_stl(const std::string& header, const TriangleMesh& mesh, float scale = 1.0F) {
  std::string text = header;
  text.resize(80, ' ');
  const auto put = [&text](auto value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(static_cast<std::uint32_t>(mesh.face_count()));
  for (Eigen::Index f = 0; f < mesh.face_count(); ++f) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i)
        put(scale * static_cast<float>(mesh.vertices(mesh.faces(f, k), i)));
    }
    put(std::uint16_t{0});
  }
  return text;
}

/// Largest distance between corresponding corners of two meshes' faces.
double face_difference(const TriangleMesh& a, const TriangleMesh& b) {
  REQUIRE(a.face_count() == b.face_count());
  return (test::soup(a).vertices - test::soup(b).vertices).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("every format reads back what was written") {
  const Scratch scratch;
  const auto mesh = sample();
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off", "UPPER.STL"}) {
    CAPTURE(name);
    TriangleMesh back;
    std::string printed;
    {
      const Listener listener;
      write_mesh(scratch(name), mesh);
      back = read_mesh(scratch(name), LengthUnit::kMetre);
      printed = listener.text();
    }
    CHECK(printed == "");
    CHECK(back.vertex_count() == mesh.vertex_count());
    // STL keeps float32, half a unit in 2^-23 of 0.032 at most; the others keep doubles.
    const bool single = scratch(name).extension() == ".stl" || scratch(name).extension() == ".STL";
    CHECK(face_difference(mesh, back) <= (single ? 2e-9 : 0.0));
  }
}

TEST_CASE("millimetres come as metres") {
  const Scratch scratch;
  const auto mesh = sample();
  const auto file = scratch.write("mm.stl", binary_stl("made elsewhere", mesh, 1000.0F));
  CHECK(face_difference(mesh, read_mesh(file, LengthUnit::kMillimetre)) < 4e-9);
}

TEST_CASE("a binary STL whose free text begins with solid is read as binary") {
  const Scratch scratch;
  const auto mesh = sample();
  for (const char* header :
       {"solid ascii facet vertex", "solid\nfacet normal 0 0 1\nendsolid", ""}) {
    CHECK(face_difference(mesh, read_mesh(scratch.write("s.stl", binary_stl(header, mesh)),
                                          LengthUnit::kMetre)) < 2e-9);
  }
}

TEST_CASE("a text STL is read in any case, with any name") {
  const Scratch scratch;
  const auto file =
      scratch.write("t.stl",
                    "  SOLID a facet of endsolid things\r\n FACET normal 0 0 1\r\n  outer loop\r\n"
                    "   vertex 0 0 0\r\n   vertex 3.5E-2 0 0\r\n   vertex 0 0.02 0\r\n"
                    "  endloop\r\n endfacet\r\nENDSOLID x\r\n");
  const auto mesh = read_mesh(file, LengthUnit::kMetre);
  CHECK(mesh.face_count() == 1);
  CHECK(mesh.vertices(1, 0) == 3.5e-2);
}

TEST_CASE("polygons are cut into fans") {
  const Scratch scratch;
  const auto file =
      scratch.write("q.obj", "v 0 0 0\nv 0.03 0 0\nv 0.03 0.02 0\nv 0 0.02 0\nf 1 2 3 4\n");
  const auto mesh = read_mesh(file, LengthUnit::kMetre);
  CHECK(mesh.face_count() == 2);
  CHECK(face_areas(mesh).sum() == doctest::Approx(0.03 * 0.02).epsilon(1e-14));
}

TEST_CASE("what cannot be read ends in one line that names the file and the reason") {
  const Scratch scratch;
  CHECK(complaint(scratch("missing.stl")) == "no such file");
  CHECK(complaint(scratch("no_extension")) ==
        "no extension: a mesh file is .stl, .obj, .ply or .off");
  CHECK(complaint(scratch("x.step")) ==
        "unknown extension '.step': a mesh file is .stl, .obj, .ply or .off");
  fs::create_directory(scratch("folder.stl"));
  CHECK(complaint(scratch("folder.stl")) == "not a file");
  CHECK(complaint(scratch.write("empty.stl", "")) == "the file is empty");
  CHECK(complaint(scratch.write("note.stl", "These are the femoral meshes.\n")) ==
        "not an STL: neither text that begins with 'solid' nor binary (30 bytes)");
  const std::string whole = binary_stl("cut", sample());
  CHECK(complaint(scratch.write("cut.stl", whole.substr(0, whole.size() - 7))) ==
        "not an STL: neither text that begins with 'solid' nor binary (2577 bytes do not hold the "
        "50 faces that "
        "the header says)");
  CHECK(complaint(
            scratch.write("open.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n")) ==
        "not a valid stl file");
  CHECK(complaint(scratch.write("none.stl", binary_stl("", TriangleMesh{}))) ==
        "the mesh has no faces");
  CHECK(complaint(scratch.write("none2.stl", "solid x\nendsolid x\n")) == "the mesh has no faces");
  CHECK(complaint(scratch.write("points.obj", "v 0 0 0\nv 0.1 0 0\n")) != "");
  for (const char* name : {"text.obj", "text.ply", "text.off"}) {
    CAPTURE(name);
    CHECK(complaint(scratch.write(name, "These are the femoral meshes.\n")) != "");
  }
  CHECK(complaint(scratch.write("far.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 9\n")) != "");
}

TEST_CASE("a vertex that is not finite is named") {
  const Scratch scratch;
  std::string bytes = binary_stl("", sample());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bytes.data() + 84 + 3 * 50 + 12 + 4 * 4, &nan, sizeof nan);
  CHECK(complaint(scratch.write("nan.stl", bytes)) == "face 3 has a vertex that is not finite");
}

TEST_CASE(
    "a size that no knee component has names the unit that was assumed, and the other if it would "
    "do") {
  const Scratch scratch;
  const auto knee = test::box({0.0332, 0.027, 0.021});
  CHECK(complaint(scratch.write("femur.stl", binary_stl("", knee, 1000.0F))) ==
        "66.4 m across when read as m: a knee component is 0.01 to 0.5 m; use --units mm");
  CHECK(complaint(scratch.write("femur.stl", binary_stl("", knee)), LengthUnit::kMillimetre) ==
        "6.64e-05 m across when read as mm: a knee component is 0.01 to 0.5 m; use --units m");
  CHECK(complaint(scratch.write("femur.stl", binary_stl("", knee, 30.0F))) ==
        "1.99 m across when read as m: a knee component is 0.01 to 0.5 m");
  CHECK_THROWS_WITH_AS(length_unit_from_name("cm"), "units is 'cm': must be 'm' or 'mm'",
                       std::invalid_argument);
}

TEST_CASE("what cannot be written is said") {
  const Scratch scratch;
  CHECK_THROWS_AS(write_mesh(scratch("a.step"), sample()), std::invalid_argument);
  CHECK_THROWS_AS(write_mesh(scratch("a.stl"), TriangleMesh{}), std::invalid_argument);
  const auto file = scratch("absent/a.stl");
  CHECK_THROWS_WITH_AS(write_mesh(file, sample()), (file.string() + ": cannot be written").c_str(),
                       std::runtime_error);
}
