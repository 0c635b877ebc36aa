// SPDX-License-Identifier: Apache-2.0
// Distance fields on disk, so that a mesh's field is sampled once.
#pragma once

#include <filesystem>
#include <memory>

#include "condyle/geometry/distance_field.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// Where a field came from.
enum class FieldSource { kBuilt, kCache };

struct CachedField {
  std::shared_ptr<const DistanceField> field;
  FieldSource source = FieldSource::kBuilt;
};

/// The field of `mesh`: from `directory` if a valid one is there, else built
/// (mesh_distance_field.hpp) and stored there.
///
/// A file is named by the content hash of the mesh, the settings and the version of the format and
/// of the sampling, says all of that again inside, and ends in a checksum of everything before it.
/// One that is short, long, altered, or says anything else is rebuilt and replaced, never used. It
/// is written under another name and then renamed, so that a reader never sees half a file and two
/// writers do not mix. A directory that cannot be written to costs the cache, not the result.
///
/// @param directory created if missing; empty: no cache.
/// @param threads of the build; 0: all.
/// @throws std::invalid_argument as build_distance_field().
CachedField load_or_build_distance_field(const TriangleMesh& mesh,
                                         const DistanceFieldSettings& settings,
                                         const std::filesystem::path& directory, int threads = 0);

/// The file that load_or_build_distance_field() would use.
std::filesystem::path distance_field_file(const TriangleMesh& mesh,
                                          const DistanceFieldSettings& settings,
                                          const std::filesystem::path& directory);

}  // namespace condyle::geometry
