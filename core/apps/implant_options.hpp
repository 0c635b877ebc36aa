// SPDX-License-Identifier: Apache-2.0
// The contact model that a user names on the command line: meshes, or a surrogate file.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "condyle/contact/contact_model.hpp"
#include "condyle/contact/mesh_contact.hpp"
#include "condyle/geometry/mesh_file.hpp"
#include "law_options.hpp"

namespace condyle::apps {

/// What the options of a subcommand were set to; texts as typed.
struct ImplantOptions {
  std::string femur;
  std::string insert;
  std::string insert_medial;
  std::string insert_lateral;
  std::string side_of_body;
  std::string units;
  std::string evaluation;
  std::string integration = "insert";
  double plausible_depth = contact::MeshContactSettings{}.plausible_depth;  // [m]
  std::string cache;                                                        // folder; none if empty
  LawOptions law;
  std::string surrogate;
  std::string runtime = "auto";
};

/// Adds --femur, --insert, --insert-medial, --insert-lateral, --side-of-body, --units,
/// --evaluation, --integration, --cache, the options of a contact law, and --surrogate.
/// @param evaluation the default of --evaluation.
void add_implant_options(CLI::App& command, ImplantOptions& options, const char* evaluation);

/// The mesh contact of the options: files read, welded, windings made to agree, the insert split if
/// it is one.
/// @throws std::invalid_argument naming the option that is missing or one too many, or the file and
/// what is wrong with it.
std::unique_ptr<contact::MeshContact> read_mesh_contact(const ImplantOptions& options);

/// Contact between surfaces as the options say: evaluation, integration, cache.
contact::PairSettings pair_settings(const ImplantOptions& options);

/// A mesh file, welded, windings made to agree.
/// @throws std::invalid_argument naming the file and what is wrong with it.
geometry::TriangleMesh read_component(const std::string& file, geometry::LengthUnit unit);

/// Throws std::invalid_argument if options of meshes were given beside --surrogate.
void require_no_meshes(const ImplantOptions& options);

}  // namespace condyle::apps
