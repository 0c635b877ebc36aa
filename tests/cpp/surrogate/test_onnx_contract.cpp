// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "condyle/surrogate/onnx_contract.hpp"

using condyle::SideOfBody;
using condyle::surrogate::check_contract;
using condyle::surrogate::Contract;
using condyle::surrogate::FileSignature;

namespace {

FileSignature full_file() {
  FileSignature file;
  file.inputs = {{"pose", "float64", {-1, 6}}};
  // Not the order of the contract's page: outputs go by name.
  file.outputs = {{"trust", "float64", {-1}},
                  {"stiffness", "float64", {-1, 2, 6, 6}},
                  {"wrench", "float64", {-1, 2, 6}},
                  {"error", "float64", {-1, 2, 6}}};
  file.metadata = {{"condyle.contract_version", "1"},
                   {"condyle.pose_columns", "x,y,z,theta_x,theta_y,theta_z"},
                   {"condyle.load_columns", "Fx,Fy,Fz,Mx,My,Mz"},
                   {"condyle.sides", "medial,lateral"},
                   {"condyle.units", "m,rad,N,Nm"},
                   {"condyle.side_of_body", "left"},
                   {"condyle.frames", "{}"},
                   {"condyle.implant", "{}"},
                   {"condyle.contact_law", "{}"},
                   {"condyle.domain_bounds", "{}"},
                   {"condyle.error_table", "{}"},
                   {"condyle.training", "{}"},
                   {"condyle.architecture", "two_stage"}};
  return file;
}

std::string refusal(const FileSignature& file) {
  try {
    check_contract(file, "knee.onnx");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a full file is accepted, its outputs found by name [property]") {
  const Contract contract = check_contract(full_file(), "knee.onnx");
  CHECK(contract.side_of_body == SideOfBody::kLeft);
  CHECK(contract.wrench == 2);
  CHECK(contract.stiffness == 1);
  CHECK(contract.error == 3);
  CHECK(contract.trust == 0);
}

TEST_CASE("a wrench-only file is accepted and has nothing else [property]") {
  FileSignature file = full_file();
  file.outputs = {{"wrench", "float64", {-1, 2, 6}}};
  file.metadata["condyle.side_of_body"] = "right";
  const Contract contract = check_contract(file, "knee.onnx");
  CHECK(contract.side_of_body == SideOfBody::kRight);
  CHECK(contract.wrench == 0);
  CHECK_FALSE(contract.stiffness.has_value());
  CHECK_FALSE(contract.error.has_value());
  CHECK_FALSE(contract.trust.has_value());
}

TEST_CASE("every metadata key is required, by name [error]") {
  for (const auto& [key, value] : full_file().metadata) {
    FileSignature file = full_file();
    file.metadata.erase(key);
    CHECK(refusal(file) == "knee.onnx: metadata " + key +
                               " is missing: not a Condyle surrogate of contract version 1");
  }
}

TEST_CASE("a fixed metadata value that differs is refused with both values [error]") {
  FileSignature file = full_file();
  file.metadata["condyle.contract_version"] = std::string("2");
  CHECK(refusal(file) == "knee.onnx: metadata condyle.contract_version is '2': must be '1'");

  file = full_file();
  file.metadata["condyle.pose_columns"] = "x,y,z,theta_z,theta_y,theta_x";
  CHECK(refusal(file) ==
        "knee.onnx: metadata condyle.pose_columns is 'x,y,z,theta_z,theta_y,theta_x': must be "
        "'x,y,z,theta_x,theta_y,theta_z'");

  file = full_file();
  file.metadata["condyle.load_columns"] = "Fx,Fy,Fz";
  CHECK(refusal(file).starts_with("knee.onnx: metadata condyle.load_columns is 'Fx,Fy,Fz'"));

  file = full_file();
  file.metadata["condyle.sides"] = "lateral,medial";
  CHECK(refusal(file) ==
        "knee.onnx: metadata condyle.sides is 'lateral,medial': must be 'medial,lateral'");

  file = full_file();
  file.metadata["condyle.units"] = "mm,deg,N,Nmm";
  CHECK(refusal(file) ==
        "knee.onnx: metadata condyle.units is 'mm,deg,N,Nmm': must be 'm,rad,N,Nm'");

  file = full_file();
  file.metadata["condyle.side_of_body"] = "Left";
  CHECK(refusal(file) ==
        "knee.onnx: metadata condyle.side_of_body is 'Left': must be 'left' or 'right'");
}

TEST_CASE("inputs must be one float64 pose [N, 6] [error]") {
  FileSignature file = full_file();
  file.inputs.front() = {"x", "float64", {-1, 6}};
  CHECK(refusal(file) == "knee.onnx: inputs are x: must be pose alone");
  file = full_file();
  file.inputs.push_back({"load", "float64", {-1, 6}});
  CHECK(refusal(file) == "knee.onnx: inputs are pose, load: must be pose alone");
  file = full_file();
  file.inputs.clear();
  CHECK(refusal(file) == "knee.onnx: inputs are none: must be pose alone");
  file = full_file();
  file.inputs.front().type = "float32";
  CHECK(refusal(file) == "knee.onnx: input pose is float32 [N, 6]: must be float64 [N, 6]");
  file = full_file();
  file.inputs.front().shape = {1, 6};
  CHECK(refusal(file) == "knee.onnx: input pose is float64 [1, 6]: must be float64 [N, 6]");
}

TEST_CASE("each output's type and shape are checked, by name [error]") {
  const std::pair<const char*, const char*> wanted[] = {{"trust", "[N]"},
                                                        {"stiffness", "[N, 2, 6, 6]"},
                                                        {"wrench", "[N, 2, 6]"},
                                                        {"error", "[N, 2, 6]"}};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string name = wanted[i].first;
    const std::string shape = wanted[i].second;
    FileSignature file = full_file();
    file.outputs[i].type = "float32";
    CHECK(refusal(file) ==
          "knee.onnx: output " + name + " is float32 " + shape + ": must be float64 " + shape);
    file = full_file();
    file.outputs[i].shape = {-1, 5};
    CHECK(refusal(file) ==
          "knee.onnx: output " + name + " is float64 [N, 5]: must be float64 " + shape);
  }
}

TEST_CASE("outputs are all four or wrench alone [error]") {
  for (std::size_t missing = 0; missing < 4; ++missing) {
    FileSignature file = full_file();
    file.outputs.erase(file.outputs.begin() + static_cast<std::ptrdiff_t>(missing));
    CHECK(refusal(file).ends_with(": must be wrench, stiffness, error and trust, or wrench alone"));
  }
  FileSignature file = full_file();
  file.outputs.push_back({"energy", "float64", {-1, 2}});
  CHECK(refusal(file) ==
        "knee.onnx: outputs are trust, stiffness, wrench, error, energy: must be wrench, "
        "stiffness, error and trust, or wrench alone");
}
