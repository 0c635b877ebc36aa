// SPDX-License-Identifier: Apache-2.0
// OpenSim's external-loads XML: which columns of a storage table are the force, its point and the free moment on a body.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace condyle::io {

/// One <ExternalForce>. An identifier is what the labels of three columns begin with.
struct ExternalForceSpec {
  std::string name;
  std::string applied_to_body;
  std::string force_expressed_in_body = "ground";  ///< also of the moment
  std::string point_expressed_in_body = "ground";
  std::string force_identifier;   ///< empty: a moment only
  std::string point_identifier;   ///< empty: at the body's origin
  std::string torque_identifier;  ///< empty: no moment
};

struct ExternalLoadsSpec {
  std::vector<ExternalForceSpec> forces;
  std::filesystem::path data_file;  ///< of the table; a relative one was found beside the XML file
  std::string source;               ///< the file read, for messages
};

/// Reads an external-loads file. Forces that are switched off (isDisabled, appliesForce) are left out. Deprecated kinematics
/// of the loads (external_loads_model_kinematics_file) are passed over: they say where points in ground would be on their
/// bodies, which the motion itself says.
/// @throws std::invalid_argument naming the file, and line and column of a syntax error, the force and the element of what
/// is missing or unknown (with the near miss), or the data file that is not there.
ExternalLoadsSpec read_external_loads_file(const std::filesystem::path& file);

}  // namespace condyle::io
