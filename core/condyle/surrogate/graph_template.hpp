// SPDX-License-Identifier: Apache-2.0
// Comparing a file's graph with a known one, node by node.
//
// A known graph is written down as the calls that make it, in terms of the names of its values;
// a node of the file matches if it makes the same value by the same operator from the same values
// with the same attributes. Nothing is inferred from a name alone: what a graph computes follows
// from its nodes, and all of those that lead to an output have to match.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "condyle/surrogate/onnx_file.hpp"

namespace condyle::surrogate {

/// The graph is not one that is known here; the text says where it departs. Not a fault of the
/// file: onnxruntime may well run it.
class UnknownGraph : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class GraphTemplate {
 public:
  /// @pre the file outlives this object.
  /// @throws UnknownGraph if values are made twice, if the file holds what onnx_file.hpp does not
  ///   know, or if its operators are not those of the standard set, version 17.
  explicit GraphTemplate(const OnnxFile& file);

  /// Matches the node that makes `output`. @throws UnknownGraph
  void expect(const std::string& op_type, const std::vector<std::string>& inputs,
              const std::string& output, const std::vector<OnnxAttribute>& attributes = {});

  /// A float64 constant. @throws UnknownGraph if there is none of the name.
  const OnnxTensor& doubles(const std::string& name) const;
  /// An int64 constant.
  const OnnxTensor& integers(const std::string& name) const;
  bool has_constant(const std::string& name) const;

  /// @throws UnknownGraph unless the constant has the shape and the values, exactly.
  void expect_doubles(const std::string& name, const std::vector<std::int64_t>& shape,
                      const std::vector<double>& values) const;
  /// The same for a single number, as a scalar or as [1].
  void expect_number(const std::string& name, double value) const;
  /// The same for a one-dimensional int64 constant.
  void expect_integers(const std::string& name, const std::vector<std::int64_t>& values) const;

  /// The nodes that nothing matched, in the file's order.
  std::vector<const OnnxNode*> rest() const;

  const OnnxFile& file() const { return file_; }

  static OnnxAttribute integer_attribute(const std::string& name, std::int64_t value);
  static OnnxAttribute integers_attribute(const std::string& name,
                                          const std::vector<std::int64_t>& values);

 private:
  const OnnxFile& file_;
  std::map<std::string, const OnnxNode*> maker_;
  std::set<const OnnxNode*> matched_;
};

}  // namespace condyle::surrogate
