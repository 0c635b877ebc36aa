// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/mesh_file.hpp"

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace condyle::geometry {
namespace {

using Points = std::vector<CGAL::Simple_cartesian<double>::Point_3>;
using Polygons = std::vector<std::vector<std::size_t>>;

constexpr std::size_t kStlHeader = 80;  // bytes of free text before the face count
constexpr std::size_t kStlFace = 50;    // bytes a face: normal, three vertices, attribute

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& why) {
  throw std::invalid_argument(file.string() + ": " + why);
}

void lower_case(std::string& text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  lower_case(extension);
  for (const char* known : {".stl", ".obj", ".ply", ".off"}) {
    if (extension == known) return extension;
  }
  fail(file,
       (extension.empty() ? std::string("no extension") : "unknown extension '" + extension + "'") +
           ": a mesh file is .stl, .obj, .ply or .off");
}

std::string whole_text(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) fail(file, "no such file");
  if (!std::filesystem::is_regular_file(file, ignored)) fail(file, "not a file");
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) fail(file, "cannot be read");
  if (text.empty()) fail(file, "the file is empty");
  return text;
}

std::string plural(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

template <typename Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

// CGAL keeps vertices in an ordered map, which a NaN would break.
void require_finite_stl(const std::filesystem::path& file, const std::string& bytes,
                        std::size_t faces) {
  for (std::size_t f = 0; f < faces; ++f) {
    for (std::size_t i = 0; i < 9; ++i) {
      const std::size_t offset = kStlHeader + 4 + f * kStlFace + 12 + 4 * i;
      if (!std::isfinite(number_at<float>(bytes, offset))) {
        fail(file, "face " + std::to_string(f) + " has a vertex that is not finite");
      }
    }
  }
}

// Which of the two STLs it is goes by the length, which a binary file's face count fixes: many
// binary files begin with "solid", the mark of a text one. The free texts are blanked, so that no
// word in them can mislead the parser.
bool read_stl(const std::filesystem::path& file, std::string text, Points& points,
              Polygons& polygons) {
  constexpr std::size_t kStart = kStlHeader + 4;
  const std::size_t faces = text.size() < kStart ? 0 : number_at<std::uint32_t>(text, kStlHeader);
  if (text.size() >= kStart && text.size() == kStart + faces * kStlFace) {
    if (faces == 0) fail(file, "the mesh has no faces");
    require_finite_stl(file, text, faces);
    std::fill_n(text.begin(), kStlHeader, '-');
    std::istringstream stream(text);
    return CGAL::IO::read_STL(stream, points, polygons);
  }
  lower_case(text);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool solid = first != std::string::npos && text.compare(first, 5, "solid") == 0;
  if (!solid || text.find('\0') != std::string::npos) {
    fail(file, "not an STL: neither text that begins with 'solid' nor binary (" +
                   plural(text.size(), "byte") +
                   (text.size() < kStart
                        ? ""
                        : " do not hold the " + plural(faces, "face") + " that the header says") +
                   ")");
  }
  const std::size_t line_end = std::min(text.find('\n', first), text.size());
  text.replace(0, line_end, "solid s");
  // CGAL tries a text that it cannot parse as a binary file, and takes a short one for an empty
  // mesh. Spaces read as a face count of 5e8, which no text holds.
  text.append(kStart, ' ');
  std::istringstream stream(text);
  return CGAL::IO::read_STL(stream, points, polygons);
}

bool read_soup(const std::filesystem::path& file, const std::string& extension, std::string text,
               Points& points, Polygons& polygons) {
  if (extension == ".stl") return read_stl(file, std::move(text), points, polygons);
  std::istringstream stream(text);
  const auto silent = CGAL::parameters::verbose(false);  // not the default of every reader
  if (extension == ".obj") return CGAL::IO::read_OBJ(stream, points, polygons, silent);
  if (extension == ".ply") return CGAL::IO::read_PLY(stream, points, polygons, silent);
  return CGAL::IO::read_OFF(stream, points, polygons, silent);
}

TriangleMesh to_mesh(const std::filesystem::path& file, const Points& points,
                     const Polygons& polygons, double scale) {
  constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (points.size() > kMost || polygons.size() > kMost)
    fail(file, "more than 2^31 vertices or faces");
  TriangleMesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Vector3 p(points[v].x(), points[v].y(), points[v].z());
    if (!p.allFinite()) fail(file, "vertex " + std::to_string(v) + " is not finite");
    mesh.vertices.row(static_cast<Eigen::Index>(v)) = scale * p;
  }
  std::vector<std::int32_t> corners;
  for (std::size_t f = 0; f < polygons.size(); ++f) {
    const auto& polygon = polygons[f];
    if (polygon.size() < 3)
      fail(file, "face " + std::to_string(f) + " has " + plural(polygon.size(), "corner"));
    for (const std::size_t v : polygon) {
      if (v >= points.size()) {
        fail(file, "face " + std::to_string(f) + " uses a vertex that does not exist (there are " +
                       std::to_string(points.size()) + ")");
      }
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      for (const std::size_t v : {polygon[0], polygon[k - 1], polygon[k]}) {
        corners.push_back(static_cast<std::int32_t>(v));
      }
    }
  }
  if (corners.empty()) fail(file, "the mesh has no faces");
  mesh.faces =
      Eigen::Map<const FaceArray>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return mesh;
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

bool plausible(double size) { return size >= kSmallestComponent && size <= kLargestComponent; }

void require_plausible_size(const std::filesystem::path& file, const TriangleMesh& mesh,
                            LengthUnit unit) {
  // Only vertices that faces use: a stray one is no part of the component.
  Vector3 low = mesh.vertices.row(mesh.faces(0, 0)), high = low;
  for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) {
    const Vector3 p = mesh.vertices.row(mesh.faces.data()[i]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double size = (high - low).maxCoeff();
  if (plausible(size)) return;
  const LengthUnit other =
      unit == LengthUnit::kMetre ? LengthUnit::kMillimetre : LengthUnit::kMetre;
  const double other_size = unit == LengthUnit::kMetre ? 1e-3 * size : 1e3 * size;
  std::string why = short_number(size) + " m across when read as " + std::string(name(unit)) +
                    ": a knee component is " + short_number(kSmallestComponent) + " to " +
                    short_number(kLargestComponent) + " m";
  if (plausible(other_size)) why += "; use --units " + std::string(name(other));
  fail(file, why);
}

}  // namespace

LengthUnit length_unit_from_name(std::string_view text) {
  if (text == "m") return LengthUnit::kMetre;
  if (text == "mm") return LengthUnit::kMillimetre;
  throw std::invalid_argument("units is '" + std::string(text) + "': must be 'm' or 'mm'");
}

TriangleMesh read_mesh(const std::filesystem::path& file, LengthUnit unit) {
  const std::string extension = extension_of(file);
  Points points;
  Polygons polygons;
  bool read = false;
  std::string text = whole_text(file);
  try {
    read = read_soup(file, extension, std::move(text), points, polygons);
  } catch (const std::invalid_argument&) {
    throw;
  } catch (const std::exception&) {
    read = false;  // CGAL's own complaint says nothing that a user could act on
  }
  if (!read) fail(file, "not a valid " + extension.substr(1) + " file");
  const TriangleMesh mesh =
      to_mesh(file, points, polygons, unit == LengthUnit::kMetre ? 1.0 : 1e-3);
  require_plausible_size(file, mesh, unit);
  return mesh;
}

void write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh) {
  const std::string extension = extension_of(file);
  require_well_formed(mesh, file.string().c_str());
  Points points;
  for (const auto& v : mesh.vertices.rowwise()) points.emplace_back(v.x(), v.y(), v.z());
  Polygons polygons;
  for (const auto& f : mesh.faces.rowwise()) {
    polygons.push_back({static_cast<std::size_t>(f[0]), static_cast<std::size_t>(f[1]),
                        static_cast<std::size_t>(f[2])});
  }
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.precision(std::numeric_limits<double>::max_digits10);
  bool written = stream.good();
  if (extension == ".stl" || extension == ".ply") CGAL::IO::set_binary_mode(stream);
  // CGAL resets the precision to 6 digits unless it is passed.
  const auto precise =
      CGAL::parameters::stream_precision(std::numeric_limits<double>::max_digits10);
  if (extension == ".stl") written = written && CGAL::IO::write_STL(stream, points, polygons);
  if (extension == ".ply") written = written && CGAL::IO::write_PLY(stream, points, polygons);
  if (extension == ".obj")
    written = written && CGAL::IO::write_OBJ(stream, points, polygons, precise);
  if (extension == ".off")
    written = written && CGAL::IO::write_OFF(stream, points, polygons, precise);
  stream.close();
  if (!written || !stream) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace condyle::geometry
