// SPDX-License-Identifier: Apache-2.0
// Numbers of fields are those of onnx/onnx.proto, IR version 8 and later; unknown ones are skipped,
// as protobuf's rules ask, except where they would change what the graph computes.
#include "condyle/surrogate/onnx_file.hpp"

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "condyle/surrogate/protobuf_reader.hpp"

namespace condyle::surrogate {
namespace {

using Bytes = std::span<const char>;

enum ElementType : std::int64_t { kFloat32 = 1, kInt32 = 6, kInt64 = 7, kBool = 9, kFloat64 = 11 };

const char* type_name(std::int64_t type) {
  switch (type) {
    case kFloat64:
      return "float64";
    case kFloat32:
      return "float32";
    case kInt64:
      return "int64";
    case kInt32:
      return "int32";
    case kBool:
      return "bool";
    default:
      return "other";
  }
}

/// Repeated integers stand one a field, or packed into one.
void add_integers(const ProtobufField& field, std::vector<std::int64_t>& to) {
  if (!field.is_bytes) {
    to.push_back(field.integer());
    return;
  }
  ProtobufReader packed(field.bytes);
  while (!packed.at_end()) to.push_back(static_cast<std::int64_t>(packed.varint()));
}

template <typename Number>
std::vector<Number> numbers(Bytes bytes, const std::string& name) {
  static_assert(std::endian::native == std::endian::little, "ONNX stores little-endian numbers");
  if (bytes.size() % sizeof(Number) != 0) throw DamagedMessage(name + ": its values end early");
  std::vector<Number> values(bytes.size() / sizeof(Number));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

void require_count(const OnnxTensor& tensor, std::size_t count) {
  // No constant of a surrogate is near 2^32 values; the bound keeps the product from wrapping.
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t expected = 1;
  for (const std::int64_t size : tensor.shape) {
    const bool possible = size >= 0 && static_cast<std::uint64_t>(size) <= kMost;
    if (possible) expected *= static_cast<std::uint64_t>(size);
    if (!possible || expected > kMost) {
      throw DamagedMessage(tensor.name + ": its shape is out of range");
    }
  }
  if (expected != count) {
    throw DamagedMessage(tensor.name + ": it has " + std::to_string(count) + " values: its shape " +
                         "says " + std::to_string(expected));
  }
}

OnnxTensor read_tensor(Bytes message, std::string& beyond) {
  OnnxTensor tensor;
  std::int64_t type = 0;
  Bytes raw;
  bool has_raw = false, elsewhere = false;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    switch (field.number) {
      case 1:
        add_integers(field, tensor.shape);
        break;
      case 2:
        type = field.integer();
        break;
      case 7:
        add_integers(field, tensor.integers);
        break;
      case 8:
        tensor.name = field.text();
        break;
      case 9:
        raw = field.message();
        has_raw = true;
        break;
      case 10:
        if (field.is_bytes) {
          for (const double x : numbers<double>(field.bytes, "double_data")) {
            tensor.doubles.push_back(x);
          }
        } else {
          tensor.doubles.push_back(std::bit_cast<double>(field.value));
        }
        break;
      case 13:  // external_data
        elsewhere = true;
        break;
      case 14:  // data_location: 1 is another file
        elsewhere = elsewhere || field.integer() != 0;
        break;
      default:
        break;
    }
  }
  tensor.type = type_name(type);
  if (elsewhere) {
    beyond = "constant " + tensor.name + " lies in another file";
    return tensor;
  }
  if (has_raw && type == kFloat64) tensor.doubles = numbers<double>(raw, tensor.name);
  if (has_raw && type == kInt64) tensor.integers = numbers<std::int64_t>(raw, tensor.name);
  if (type == kFloat64) require_count(tensor, tensor.doubles.size());
  if (type == kInt64) require_count(tensor, tensor.integers.size());
  return tensor;
}

OnnxAttribute read_attribute(Bytes message) {
  OnnxAttribute attribute;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number == 1) attribute.name = field.text();
    if (field.number == 2) attribute.number = field.real();
    if (field.number == 3) attribute.integer = field.integer();
    if (field.number == 8) add_integers(field, attribute.integers);
    if (field.number == 20) attribute.kind = static_cast<int>(field.integer());
  }
  return attribute;
}

OnnxNode read_node(Bytes message) {
  OnnxNode node;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number == 1) node.inputs.push_back(field.text());
    if (field.number == 2) node.outputs.push_back(field.text());
    if (field.number == 4) node.op_type = field.text();
    if (field.number == 5) node.attributes.push_back(read_attribute(field.message()));
    if (field.number == 7) node.domain = field.text();
  }
  return node;
}

/// TensorShapeProto: a dimension without dim_value (1) is free.
std::vector<std::int64_t> read_shape(Bytes message) {
  std::vector<std::int64_t> shape;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number != 1) continue;
    shape.push_back(-1);
    ProtobufReader dimension(field.message());
    for (ProtobufField part; dimension.next(part);) {
      if (part.number == 1) shape.back() = part.integer();
    }
  }
  return shape;
}

/// ValueInfoProto: name (1), type (2) of TypeProto, tensor (1) of that.
TensorSignature read_value(Bytes message) {
  TensorSignature value{"", "other", {}};
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number == 1) value.name = field.text();
    if (field.number != 2) continue;
    ProtobufReader type(field.message());
    for (ProtobufField kind; type.next(kind);) {
      if (kind.number != 1) continue;
      ProtobufReader tensor(kind.message());
      for (ProtobufField part; tensor.next(part);) {
        if (part.number == 1) value.type = type_name(part.integer());
        if (part.number == 2) value.shape = read_shape(part.message());
      }
    }
  }
  return value;
}

void read_graph(Bytes message, OnnxFile& file) {
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    switch (field.number) {
      case 1:
        file.nodes.push_back(read_node(field.message()));
        break;
      case 5: {
        OnnxTensor tensor = read_tensor(field.message(), file.beyond);
        const std::string name = tensor.name;
        if (!file.initialisers.emplace(name, std::move(tensor)).second) {
          throw DamagedMessage("constant " + name + " stands there twice");
        }
        break;
      }
      case 11:
        file.signature.inputs.push_back(read_value(field.message()));
        break;
      case 12:
        file.signature.outputs.push_back(read_value(field.message()));
        break;
      case 14:
        file.beyond = "quantisation annotations";
        break;
      case 15:
        file.beyond = "sparse constants";
        break;
      default:
        break;
    }
  }
}

/// OperatorSetIdProto and StringStringEntryProto: two fields.
void read_opset(Bytes message, OnnxFile& file) {
  std::string domain;
  std::int64_t version = 0;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number == 1) domain = field.text();
    if (field.number == 2) version = field.integer();
  }
  file.opsets[domain == "ai.onnx" ? "" : domain] = version;
}

void read_metadata(Bytes message, OnnxFile& file) {
  std::string key, value;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number == 1) key = field.text();
    if (field.number == 2) value = field.text();
  }
  file.signature.metadata[key] = value;
}

OnnxFile read_model(Bytes message) {
  OnnxFile file;
  bool has_graph = false;
  ProtobufReader reader(message);
  for (ProtobufField field; reader.next(field);) {
    if (field.number == 2) file.producer = field.text();
    if (field.number == 7) {
      if (has_graph) throw DamagedMessage("it has two graphs");
      has_graph = true;
      read_graph(field.message(), file);
    }
    if (field.number == 8) read_opset(field.message(), file);
    if (field.number == 14) read_metadata(field.message(), file);
    if (field.number == 20 || field.number == 25) file.beyond = "functions of its own";
  }
  if (!has_graph) throw DamagedMessage("it has no graph");
  // Files of old IR versions list constants among the inputs; they are not.
  std::erase_if(file.signature.inputs,
                [&](const auto& input) { return file.initialisers.contains(input.name); });
  return file;
}

}  // namespace

OnnxFile parse_onnx(std::span<const char> bytes, const std::string& file) {
  try {
    return read_model(bytes);
  } catch (const DamagedMessage& error) {
    throw std::invalid_argument(file + ": not an ONNX model (truncated?): " + error.what());
  }
}

std::vector<char> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file)) {
    throw std::invalid_argument(file.string() + ": cannot be opened for reading");
  }
  std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.empty()) throw std::invalid_argument(file.string() + ": is empty, not an ONNX model");
  return bytes;
}

OnnxFile read_onnx(const std::filesystem::path& file) {
  return parse_onnx(read_bytes(file), file.string());
}

}  // namespace condyle::surrogate
