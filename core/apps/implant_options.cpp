// SPDX-License-Identifier: Apache-2.0
#include "implant_options.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "condyle/contact/compartments.hpp"
#include "condyle/contact/implant_check.hpp"
#include "condyle/geometry/mesh_repair.hpp"

namespace condyle::apps {
namespace {

void require(const std::string& value, const char* option) {
  if (value.empty()) {
    throw std::invalid_argument(std::string(option) +
                                " is missing (or give --surrogate FILE.onnx)");
  }
}

/// The checks of a mesh contact speak of parts; a user has files.
template <typename Check>
void check_naming(const std::string& files, const Check& check) {
  try {
    check();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(files + ": " + error.what());
  }
}

contact::InsertMeshes read_insert(const ImplantOptions& options, geometry::LengthUnit unit,
                                  SideOfBody side) {
  const bool halves = !options.insert_medial.empty() || !options.insert_lateral.empty();
  if (options.insert.empty()) {
    if (!halves) require(options.insert, "--insert, or --insert-medial with --insert-lateral,");
    require(options.insert_medial, "--insert-medial");
    require(options.insert_lateral, "--insert-lateral");
    return {read_component(options.insert_medial, unit),
            read_component(options.insert_lateral, unit)};
  }
  if (halves) {
    throw std::invalid_argument(
        "--insert goes without --insert-medial and --insert-lateral: it is split by the program");
  }
  contact::InsertMeshes insert;
  check_naming(options.insert,
               [&] { insert = contact::split_insert(read_component(options.insert, unit), side); });
  return insert;
}

}  // namespace

void add_implant_options(CLI::App& command, ImplantOptions& options, const char* evaluation) {
  options.evaluation = evaluation;
  const std::string meshes = "Implant as meshes (STL, OBJ, PLY, OFF)";
  command.add_option("--femur", options.femur, "Femoral component, in the femoral frame")
      ->group(meshes);
  command.add_option("--insert", options.insert, "Insert, in the tibial frame; split at z = 0")
      ->group(meshes);
  command.add_option("--insert-medial", options.insert_medial, "Medial compartment")->group(meshes);
  command.add_option("--insert-lateral", options.insert_lateral, "Lateral compartment")
      ->group(meshes);
  command.add_option("--side-of-body", options.side_of_body, "left or right")->group(meshes);
  command.add_option("--units", options.units, "Unit of the mesh files: m or mm")->group(meshes);
  command
      .add_option("--evaluation", options.evaluation, "exact (triangles) or fast (smooth field)")
      ->group(meshes)
      ->capture_default_str();
  add_law_options(command, options.law, "Contact law");
  command
      .add_option("--integration", options.integration,
                  "Whose faces are integrated: insert, femur, or both for their mean")
      ->group(meshes)
      ->capture_default_str();
  command.add_option("--cache", options.cache, "Folder that keeps what fast builds between runs")
      ->group(meshes);
  command.add_option("--surrogate", options.surrogate, "Surrogate file (.onnx), instead of meshes")
      ->group("Implant as surrogate");
  command
      .add_option("--runtime", options.runtime,
                  "What evaluates the surrogate: fused, onnxruntime, or auto (fused where it knows "
                  "the file's network)")
      ->check(CLI::IsMember({"auto", "fused", "onnxruntime"}))
      ->capture_default_str()
      ->group("Implant as surrogate");
}

geometry::TriangleMesh read_component(const std::string& file, geometry::LengthUnit unit) {
  const geometry::TriangleMesh mesh = geometry::read_mesh(file, unit);
  try {
    // An inverted solid stays inverted: whoever built it should know, and the checks below say so.
    return geometry::repair_mesh(mesh, {.turn_closed_outward = false}).mesh;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(file + ": " + error.what());
  }
}

contact::PairSettings pair_settings(const ImplantOptions& options) {
  contact::PairSettings settings;
  settings.evaluation = contact::evaluation_from_name(options.evaluation);
  settings.integration = contact::integration_from_name(options.integration);
  settings.cache_directory = options.cache;
  return settings;
}

std::unique_ptr<contact::MeshContact> read_mesh_contact(const ImplantOptions& options) {
  require(options.femur, "--femur");
  require(options.side_of_body, "--side-of-body");
  require(options.units, "--units");
  const SideOfBody side = side_of_body_from_name(options.side_of_body);
  const geometry::LengthUnit unit = geometry::length_unit_from_name(options.units);
  contact::MeshContactSettings settings;
  settings.pair = pair_settings(options);
  settings.plausible_depth = options.plausible_depth;
  const contact::ContactLaw law = read_law(options.law);

  const geometry::TriangleMesh femur = read_component(options.femur, unit);
  const contact::InsertMeshes insert = read_insert(options, unit, side);
  const std::string insert_files = options.insert.empty()
                                       ? options.insert_medial + ", " + options.insert_lateral
                                       : options.insert;
  check_naming(options.femur, [&] { contact::require_femur(femur); });
  check_naming(insert_files, [&] { contact::require_insert(insert, side); });
  check_naming(options.femur + ", " + insert_files,
               [&] { contact::require_unswapped(femur, insert); });
  return std::make_unique<contact::MeshContact>(femur, insert, side, law, settings);
}

void require_no_meshes(const ImplantOptions& options) {
  const std::array<std::pair<const char*, const std::string*>, 6> given{
      {{"--femur", &options.femur},
       {"--insert", &options.insert},
       {"--insert-medial", &options.insert_medial},
       {"--insert-lateral", &options.insert_lateral},
       {"--side-of-body", &options.side_of_body},
       {"--units", &options.units}}};
  for (const auto& [option, value] : given) {
    if (value->empty()) continue;
    throw std::invalid_argument(std::string(option) +
                                " does not go with --surrogate, whose file knows its implant");
  }
  if (const auto option = first_given(options.law)) {
    throw std::invalid_argument(*option +
                                " does not go with --surrogate, whose file knows its law");
  }
}

}  // namespace condyle::apps
