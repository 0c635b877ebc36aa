// SPDX-License-Identifier: Apache-2.0
// Meshes of a model's contact surfaces that are made about other axes than the model's, in JSON
// files: `contact_surfaces` as in a model file, in a file of its own.
//
//   {"contact_surfaces": [{"name": "femur_implant", "mesh": "femur.stl",
//     "frame": {"body": "femur_r", "translation": [x, y, z], "orientation_xyz": [a, b, c]}}, ...]}
//
// The frame is that of the mesh's coordinates, on its body [m, rad]; mesh files are relative to the
// JSON file. A knee's femoral mesh so says where F is on the femur, its insert's where T is on the
// tibia. Where a surrogate takes the mesh's place, `mesh` may be left out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "condyle/common/types.hpp"
#include "condyle/model/model.hpp"

namespace condyle::io {

struct SurfaceFile {
  std::string name;            ///< of a contact surface of the model
  std::filesystem::path mesh;  ///< STL, OBJ, PLY or OFF, in m; empty: none is named
  std::string body;            ///< that the mesh is fixed to; "ground" may be one
  RigidTransform X_BS;         ///< the mesh's coordinates in the body's
};

/// Reads the surfaces that a file places; other keys of it are passed over, so that a model file is
/// one, too.
/// @throws std::invalid_argument naming the file, and the key that is missing or of another type, a
/// surface or body that the model lacks (with the near miss), a surface that is there twice, or the
/// mesh that is not there.
std::vector<SurfaceFile> read_surface_file(const std::filesystem::path& file,
                                           const model::Model& model);

/// The surface of a name. @throws std::invalid_argument naming those there are.
const SurfaceFile& find_surface(const std::vector<SurfaceFile>& surfaces, const std::string& name);

}  // namespace condyle::io
