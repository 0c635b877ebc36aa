// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "condyle/geometry/distance_field_cache.hpp"
#include "condyle/geometry/mesh_distance_field.hpp"

namespace condyle::geometry {
namespace {

// A tetrahedron of about 20 mm, in general position.
TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0.0113, 0.0009, -0.0021, -0.0092, 0.0107, -0.0033, -0.0081, -0.0102, -0.0017,
      0.0006, 0.0011, 0.0125;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
  return mesh;
}

DistanceFieldSettings coarse() {
  DistanceFieldSettings settings;
  settings.spacing = 1.7e-3;
  return settings;
}

// A folder of this test's own, empty at the start and removed at the end.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const char* name)
      : path(std::filesystem::temp_directory_path() / ("condyle-test-" + std::string(name))) {
    std::filesystem::remove_all(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void overwrite(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

bool same(const DistanceField& a, const DistanceField& b) {
  return a.spline().nodes == b.spline().nodes && a.spline().origin == b.spline().origin &&
         a.spline().spacing == b.spline().spacing &&
         a.spline().coefficients == b.spline().coefficients && a.border_nodes() == b.border_nodes();
}

TEST_CASE("[property] a field is built once and read back byte for byte") {
  const Folder folder("cache-once");
  const TriangleMesh mesh = tetrahedron();
  const CachedField first = load_or_build_distance_field(mesh, coarse(), folder.path, 1);
  const CachedField second = load_or_build_distance_field(mesh, coarse(), folder.path, 1);
  CHECK(first.source == FieldSource::kBuilt);
  CHECK(second.source == FieldSource::kCache);
  CHECK(same(*first.field, *second.field));
  CHECK(same(*first.field, build_distance_field(mesh, coarse(), 1)));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) ==
        1);  // nothing partial left
}

TEST_CASE("[error] a damaged file is rebuilt and replaced, never used") {
  const Folder folder("cache-damaged");
  const TriangleMesh mesh = tetrahedron();
  const CachedField truth = load_or_build_distance_field(mesh, coarse(), folder.path, 1);
  const std::filesystem::path file = distance_field_file(mesh, coarse(), folder.path);
  const std::string good = content(file);
  REQUIRE(good.size() > 1000);
  std::vector<std::string> bad = {"", good.substr(0, 40), good.substr(0, good.size() - 1),
                                  good + "x", std::string(good.size(), '\0')};
  // One bit, in the magic, version, node count, hash, settings, origin, data and checksum.
  for (const std::size_t at :
       {std::size_t{3}, std::size_t{8}, std::size_t{13}, std::size_t{30}, std::size_t{95},
        std::size_t{125}, good.size() / 2, good.size() - 3}) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    bad.push_back(flipped);
  }
  for (const std::string& bytes : bad) {
    overwrite(file, bytes);
    const CachedField again = load_or_build_distance_field(mesh, coarse(), folder.path, 1);
    CHECK(again.source == FieldSource::kBuilt);
    CHECK(same(*again.field, *truth.field));
    CHECK(content(file) == good);
  }
}

TEST_CASE(
    "[property] another mesh or setting has another file, and a swapped file is not trusted") {
  const Folder folder("cache-swapped");
  const TriangleMesh mesh = tetrahedron();
  TriangleMesh other = mesh;
  other.vertices(2, 1) += 1e-6;
  DistanceFieldSettings finer = coarse();
  finer.spacing = 1.6e-3;
  const auto file = distance_field_file(mesh, coarse(), folder.path);
  CHECK(file != distance_field_file(other, coarse(), folder.path));
  CHECK(file != distance_field_file(mesh, finer, folder.path));
  load_or_build_distance_field(other, coarse(), folder.path, 1);
  std::filesystem::copy_file(distance_field_file(other, coarse(), folder.path), file);
  CHECK(load_or_build_distance_field(mesh, coarse(), folder.path, 1).source == FieldSource::kBuilt);
}

TEST_CASE("[error] a directory that cannot be written to costs the cache, not the result") {
  const Folder folder("cache-unwritable");
  std::filesystem::create_directories(folder.path);
  overwrite(folder.path / "file", "not a directory");
  const CachedField field =
      load_or_build_distance_field(tetrahedron(), coarse(), folder.path / "file" / "below", 1);
  CHECK(field.source == FieldSource::kBuilt);
  CHECK(field.field->value(Vector3(0.0, 0.0, 0.001)) < 0.0);
  CHECK(load_or_build_distance_field(tetrahedron(), coarse(), {}, 1).source == FieldSource::kBuilt);
}

}  // namespace
}  // namespace condyle::geometry
