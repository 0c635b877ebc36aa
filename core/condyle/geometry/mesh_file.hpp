// SPDX-License-Identifier: Apache-2.0
// Triangle surfaces in files: STL (text and binary), OBJ, PLY, OFF.
#pragma once

#include <filesystem>
#include <string_view>

#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// The unit of the numbers in a file. No mesh format states it.
enum class LengthUnit { kMetre, kMillimetre };

/// Reads "m" or "mm". @throws std::invalid_argument for anything else, naming the text.
LengthUnit length_unit_from_name(std::string_view text);
constexpr std::string_view name(LengthUnit unit) { return unit == LengthUnit::kMetre ? "m" : "mm"; }

/// Largest side of the bounding box that a knee component can have [m].
inline constexpr double kSmallestComponent = 0.01;
inline constexpr double kLargestComponent = 0.5;

/// Reads a surface; its vertices come in m whatever the file's unit. The format goes by the
/// extension, in any case.
///
/// An STL's vertices that are exactly the same are one vertex (the format repeats them for every
/// face); polygons of more than three corners are cut into a fan. Nothing else is changed: see
/// mesh_repair.hpp.
/// @throws std::invalid_argument, one line that names the file and the reason: missing, a
/// directory, an unknown extension, empty, not
///   of its format, without faces, a vertex that is not finite, a face that uses a vertex that does
///   not exist, or a size that is not that of a knee component (naming the unit, and the other one
///   where that would do).
TriangleMesh read_mesh(const std::filesystem::path& file, LengthUnit unit);

/// Writes a surface, vertices in m, by extension: binary STL (float32: 4 nm at 50 mm), binary PLY,
/// or OBJ and OFF as text that reads back to the same numbers.
/// @throws std::invalid_argument for an unknown extension or a mesh that is not well formed,
/// std::runtime_error if the file
///   cannot be written; both name the file.
void write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace condyle::geometry
