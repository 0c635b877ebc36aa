// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/distance_field_cache.hpp"

#include <unistd.h>

#include <atomic>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "condyle/geometry/mesh_distance_field.hpp"
#include "condyle/geometry/mesh_hash.hpp"

namespace condyle::geometry {
namespace {

static_assert(std::endian::native == std::endian::little, "cache files are little-endian");

// Raise when the format, the sampling or the spline changes: files of other versions are then not
// found.
constexpr std::uint32_t kVersion = 1;

// What a file holds, and of what; compared byte by byte. No padding: every byte is defined.
struct Header {
  char magic[8] = {'C', 'o', 'n', 'd', 'y', 'l', 'e', 'F'};
  std::uint32_t version = kVersion;
  std::int32_t nodes[3] = {0, 0, 0};
  char mesh[64] = {};  // content hash
  double settings[4] = {0.0, 0.0, 0.0, 0.0};
  double origin[3] = {0.0, 0.0, 0.0};
  double spacing = 0.0;
};
static_assert(sizeof(Header) == 8 + 4 + 12 + 64 + 32 + 24 + 8, "padding would be undefined bytes");

Header header_of(const std::string& mesh_hash, const DistanceFieldSettings& settings) {
  Header header;
  std::memcpy(header.mesh, mesh_hash.data(), sizeof header.mesh);
  header.settings[0] = settings.spacing;
  header.settings[1] = settings.margin;
  header.settings[2] = settings.band_outside;
  header.settings[3] = settings.band_inside;
  return header;
}

// Detects damage, not malice: FNV-1a over 8-byte words, with the length mixed in by the caller's
// fixed order of parts.
class Checksum {
 public:
  void update(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (; size >= 8; bytes += 8, size -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    for (; size > 0; ++bytes, --size) mix(*bytes);
  }
  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x100000001b3u;
    hash_ ^= hash_ >> 29;  // so that high bits reach low ones between multiplications
  }
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

std::filesystem::path file_for(const Header& header, const std::filesystem::path& directory) {
  Checksum key;
  key.update(&header, sizeof header);
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string name(header.mesh, 16);
  name += '-';
  for (int shift = 60; shift >= 0; shift -= 4) name += kDigits[(key.value() >> shift) & 15];
  return directory / (name + ".field");
}

// Nothing unless the file is whole, undamaged and of exactly what `expected` asks for.
std::shared_ptr<const DistanceField> read_field(const std::filesystem::path& file,
                                                const Header& expected) {
  std::ifstream in(file, std::ios::binary);
  Header header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return nullptr;
  Header known = expected;  // all but the grid is known beforehand
  std::memcpy(known.nodes, header.nodes, sizeof known.nodes);
  std::memcpy(known.origin, header.origin, sizeof known.origin);
  known.spacing = header.spacing;
  if (std::memcmp(&known, &header, sizeof header) != 0) return nullptr;

  CubicSplineGrid spline;
  double count = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (header.nodes[a] < 4) return nullptr;
    spline.nodes[a] = header.nodes[a];
    spline.origin[static_cast<Eigen::Index>(a)] = header.origin[a];
    count *= header.nodes[a];
  }
  spline.spacing = header.spacing;
  // The size is checked before anything of that size is allocated.
  std::error_code error;
  const auto size = static_cast<double>(std::filesystem::file_size(file, error));
  if (error || size != sizeof header + count * (sizeof(float) + 1) + sizeof(std::uint64_t)) {
    return nullptr;
  }
  const std::size_t nodes = spline.count();
  spline.coefficients.resize(nodes);
  std::vector<std::uint8_t> border(nodes);
  std::uint64_t stored = 0;
  in.read(reinterpret_cast<char*>(spline.coefficients.data()),
          static_cast<std::streamsize>(nodes * sizeof(float)));
  in.read(reinterpret_cast<char*>(border.data()), static_cast<std::streamsize>(nodes));
  if (!in.read(reinterpret_cast<char*>(&stored), sizeof stored)) return nullptr;
  Checksum checksum;
  checksum.update(&header, sizeof header);
  checksum.update(spline.coefficients.data(), nodes * sizeof(float));
  checksum.update(border.data(), nodes);
  if (checksum.value() != stored) return nullptr;
  return std::make_shared<const DistanceField>(std::move(spline), std::move(border));
}

// A failure to write costs the cache only; what was begun is removed.
void write_field(const std::filesystem::path& file, Header header, const DistanceField& field) {
  const CubicSplineGrid& spline = field.spline();
  for (std::size_t a = 0; a < 3; ++a) {
    header.nodes[a] = spline.nodes[a];
    header.origin[a] = spline.origin[static_cast<Eigen::Index>(a)];
  }
  header.spacing = spline.spacing;
  static std::atomic<unsigned> serial{0};
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  std::filesystem::path partial = file;
  partial += ".partial-" + std::to_string(getpid()) + "-" + std::to_string(serial++);
  std::ofstream out(partial, std::ios::binary);
  Checksum checksum;
  const auto put = [&](const void* data, std::size_t size) {
    checksum.update(data, size);
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  };
  put(&header, sizeof header);
  put(spline.coefficients.data(), spline.count() * sizeof(float));
  put(field.border_nodes().data(), spline.count());
  const std::uint64_t sum = checksum.value();
  out.write(reinterpret_cast<const char*>(&sum), sizeof sum);
  out.close();
  if (out) std::filesystem::rename(partial, file, error);
  if (!out || error) std::filesystem::remove(partial, error);
}

}  // namespace

CachedField load_or_build_distance_field(const TriangleMesh& mesh,
                                         const DistanceFieldSettings& settings,
                                         const std::filesystem::path& directory, int threads) {
  const auto build = [&] {
    return std::make_shared<const DistanceField>(build_distance_field(mesh, settings, threads));
  };
  if (directory.empty()) return {build(), FieldSource::kBuilt};
  const Header header = header_of(content_hash(mesh), settings);
  const std::filesystem::path file = file_for(header, directory);
  if (auto field = read_field(file, header)) return {std::move(field), FieldSource::kCache};
  auto field = build();
  write_field(file, header, *field);
  return {std::move(field), FieldSource::kBuilt};
}

std::filesystem::path distance_field_file(const TriangleMesh& mesh,
                                          const DistanceFieldSettings& settings,
                                          const std::filesystem::path& directory) {
  return file_for(header_of(content_hash(mesh), settings), directory);
}

}  // namespace condyle::geometry
