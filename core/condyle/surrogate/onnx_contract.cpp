// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/onnx_contract.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace condyle::surrogate {
namespace {

constexpr std::int64_t kFree = -1;

/// Metadata whose value is fixed by the contract.
struct FixedText {
  const char* key;
  const char* value;
};
constexpr std::array<FixedText, 4> kFixed{{
    {"condyle.pose_columns", "x,y,z,theta_x,theta_y,theta_z"},
    {"condyle.load_columns", "Fx,Fy,Fz,Mx,My,Mz"},
    {"condyle.sides", "medial,lateral"},
    {"condyle.units", "m,rad,N,Nm"},
}};

/// Metadata that must be there, whatever it says: a surrogate of unknown origin is of no use to
/// anyone.
constexpr std::array<const char*, 7> kProvenance{
    "condyle.frames",      "condyle.implant",  "condyle.contact_law", "condyle.domain_bounds",
    "condyle.error_table", "condyle.training", "condyle.architecture"};

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (const auto size : shape) {
    if (text.size() > 1) text += ", ";
    text += size == kFree ? "N" : std::to_string(size);
  }
  return text + "]";
}

const std::string& metadata_value(const FileSignature& signature, const std::string& file,
                                  const char* key) {
  const auto found = signature.metadata.find(key);
  if (found == signature.metadata.end()) {
    throw std::invalid_argument(file + ": metadata " + key +
                                " is missing: not a Condyle surrogate of contract version " +
                                kContractVersion);
  }
  return found->second;
}

void require_text(const FileSignature& signature, const std::string& file, const char* key,
                  const char* expected) {
  const std::string& value = metadata_value(signature, file, key);
  if (value != expected) {
    throw std::invalid_argument(file + ": metadata " + key + " is '" + value + "': must be '" +
                                expected + "'");
  }
}

SideOfBody check_metadata(const FileSignature& signature, const std::string& file) {
  require_text(signature, file, "condyle.contract_version", kContractVersion);
  for (const auto& [key, value] : kFixed) require_text(signature, file, key, value);
  for (const char* key : kProvenance) metadata_value(signature, file, key);
  const std::string& side = metadata_value(signature, file, "condyle.side_of_body");
  if (side != name(SideOfBody::kLeft) && side != name(SideOfBody::kRight)) {
    throw std::invalid_argument(file + ": metadata condyle.side_of_body is '" + side +
                                "': must be 'left' or 'right'");
  }
  return side_of_body_from_name(side);
}

void require_tensor(const TensorSignature& tensor, const std::vector<std::int64_t>& shape,
                    const std::string& file, const std::string& role) {
  if (tensor.type == "float64" && tensor.shape == shape) return;
  throw std::invalid_argument(file + ": " + role + " " + tensor.name + " is " + tensor.type + " " +
                              shape_text(tensor.shape) + ": must be float64 " + shape_text(shape));
}

std::string names_of(const std::vector<TensorSignature>& tensors) {
  std::string names;
  for (const auto& tensor : tensors) names += (names.empty() ? "" : ", ") + tensor.name;
  return names.empty() ? "none" : names;
}

std::optional<std::size_t> find_output(const FileSignature& signature, const std::string& file,
                                       const char* name, const std::vector<std::int64_t>& shape) {
  const auto& outputs = signature.outputs;
  const auto found =
      std::find_if(outputs.begin(), outputs.end(),
                   [&](const TensorSignature& output) { return output.name == name; });
  if (found == outputs.end()) return std::nullopt;
  require_tensor(*found, shape, file, "output");
  return static_cast<std::size_t>(found - outputs.begin());
}

void check_input(const FileSignature& signature, const std::string& file) {
  if (signature.inputs.size() != 1 || signature.inputs.front().name != "pose") {
    throw std::invalid_argument(file + ": inputs are " + names_of(signature.inputs) +
                                ": must be pose alone");
  }
  require_tensor(signature.inputs.front(), {kFree, 6}, file, "input");
}

}  // namespace

Contract check_contract(const FileSignature& signature, const std::string& file) {
  // Metadata first: an ONNX file of another make is best told that it is one.
  Contract contract;
  contract.side_of_body = check_metadata(signature, file);
  check_input(signature, file);

  const auto wrench = find_output(signature, file, "wrench", {kFree, 2, 6});
  contract.stiffness = find_output(signature, file, "stiffness", {kFree, 2, 6, 6});
  contract.error = find_output(signature, file, "error", {kFree, 2, 6});
  contract.trust = find_output(signature, file, "trust", {kFree});
  const bool full = wrench && contract.stiffness && contract.error && contract.trust &&
                    signature.outputs.size() == 4;
  const bool wrench_only = wrench && signature.outputs.size() == 1;
  if (!full && !wrench_only) {
    throw std::invalid_argument(file + ": outputs are " + names_of(signature.outputs) +
                                ": must be wrench, stiffness, error and trust, or wrench alone");
  }
  contract.wrench = *wrench;
  return contract;
}

}  // namespace condyle::surrogate
