// SPDX-License-Identifier: Apache-2.0
// The contract, version 1, between whoever writes a surrogate's ONNX file and whoever evaluates it.
//
//   input   pose       float64 [N, 6]        x, y, z [m], θx, θy, θz [rad]: common/pose.hpp
//   outputs wrench     float64 [N, 2, 6]     (medial, lateral) × (Fx, Fy, Fz [N], Mx, My, Mz [Nm])
//           stiffness  float64 [N, 2, 6, 6]  ∂wrench_i/∂pose_j
//           error      float64 [N, 2, 6]     calibrated 95 % bound on each load
//           trust      float64 [N]           1 well inside the sampled domains, 0 outside;
//                                            below 0.5 do not use
//
// A file holds all four outputs, in any order, or `wrench` alone (for those who want speed: a whole
// graph always runs). Normalisation and gating are inside the graph. The metadata keys below are
// required; their values are words that must match, or a text for people and for Python (JSON where
// it is structured) that is carried along.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "condyle/common/side.hpp"

namespace condyle::surrogate {

inline constexpr const char* kContractVersion = "1";

/// One input or output as the file declares it.
struct TensorSignature {
  std::string name;
  std::string type;                 ///< "float64", ...; "other" for what is no tensor of numbers
  std::vector<std::int64_t> shape;  ///< -1 where the file leaves it free
};

/// What an ONNX file says of itself.
struct FileSignature {
  std::vector<TensorSignature> inputs;
  std::vector<TensorSignature> outputs;
  std::map<std::string, std::string> metadata;
};

/// What the loader takes from an accepted file: where its outputs are, and for which knee it is.
struct Contract {
  SideOfBody side_of_body = SideOfBody::kRight;
  std::size_t wrench = 0;                ///< position among the file's outputs
  std::optional<std::size_t> stiffness;  ///< absent, with error and trust, in a wrench-only file
  std::optional<std::size_t> error;
  std::optional<std::size_t> trust;
};

/// Compares a file with the contract.
/// @param file names the file in messages.
/// @throws std::invalid_argument in one line: the file, the field (`metadata condyle.units`,
/// `output stiffness`, ...),
///   what it is and what the contract wants.
Contract check_contract(const FileSignature& signature, const std::string& file);

}  // namespace condyle::surrogate
