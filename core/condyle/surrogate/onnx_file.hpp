// SPDX-License-Identifier: Apache-2.0
// An ONNX file read without onnxruntime: its graph, its weights and what it says of itself.
// For those who evaluate a known graph by themselves (fused_surrogate.hpp); nothing is run here.
//
// An ONNX file is one protobuf message (github.com/onnx/onnx, onnx/onnx.proto). The wire format is
// three kinds of value (varint, fixed width, length and bytes), so that a reader is shorter than
// what it would take to depend on one. Every length is checked before it is believed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "condyle/surrogate/onnx_contract.hpp"

namespace condyle::surrogate {

/// A constant of the graph. Values of other types than float64 and int64 are not kept.
struct OnnxTensor {
  std::string name;
  std::string type;                 ///< "float64", "int64", ...; "other"
  std::vector<std::int64_t> shape;  ///< none for a scalar
  std::vector<double> doubles;      ///< row-major, if float64
  std::vector<std::int64_t> integers;
};

/// A number or numbers that go with a node. Text and graphs are not kept, but their kind is.
struct OnnxAttribute {
  std::string name;
  int kind = 0;  ///< AttributeProto.AttributeType: 1 float, 2 integer, 7 integers
  double number = 0.0;
  std::int64_t integer = 0;
  std::vector<std::int64_t> integers;
  bool operator==(const OnnxAttribute&) const = default;
};

/// An operator's call. Its name is a label and is not kept.
struct OnnxNode {
  std::string op_type;
  std::string domain;
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::vector<OnnxAttribute> attributes;
};

struct OnnxFile {
  std::string producer;
  std::map<std::string, std::int64_t> opsets;  ///< version by domain; "" is the standard's own
  std::vector<OnnxNode> nodes;                 ///< in the order of the file: sorted by use
  std::map<std::string, OnnxTensor> initialisers;
  FileSignature signature;
  /// What the file has that is neither kept nor known here (functions, sparse constants, values in
  /// another file): empty if nothing.
  std::string beyond;
};

/// @param bytes the whole file.
/// @param file names it in messages.
/// @throws std::invalid_argument in one line, naming file and part, when the bytes are no ONNX
/// model
///   or end early.
OnnxFile parse_onnx(std::span<const char> bytes, const std::string& file);

/// @throws std::invalid_argument also when the file is missing or empty.
OnnxFile read_onnx(const std::filesystem::path& file);

/// The file's bytes. @throws std::invalid_argument when it is missing or empty.
std::vector<char> read_bytes(const std::filesystem::path& file);

}  // namespace condyle::surrogate
