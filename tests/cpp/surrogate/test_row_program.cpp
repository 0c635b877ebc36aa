// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "condyle/surrogate/row_program.hpp"
#include "support/random_pose.hpp"

using namespace condyle::surrogate;
using condyle::test::Draw;

namespace {

using Attributes = std::vector<OnnxAttribute>;

/// A program of some nodes from p (6) and w (2, 3) to one value.
class Program {
 public:
  Program& integers(const std::string& name, std::vector<std::int64_t> values) {
    constants_[name] = {name, "int64", {static_cast<std::int64_t>(values.size())}, {}, values};
    return *this;
  }
  Program& doubles(const std::string& name, std::vector<std::int64_t> shape,
                   std::vector<double> values) {
    constants_[name] = {name, "float64", shape, values, {}};
    return *this;
  }
  Program& node(const std::string& op, std::vector<std::string> inputs, const std::string& output,
                Attributes attributes = {}) {
    nodes_.push_back({op, "", inputs, {output}, attributes});
    return *this;
  }
  /// The value at one row.
  std::vector<double> run(const std::string& output, std::vector<std::int64_t> shape) const {
    std::vector<const OnnxNode*> nodes;
    for (const OnnxNode& node : nodes_) nodes.push_back(&node);
    const RowProgram program(nodes, constants_, {{"p", {6}}, {"w", {2, 3}}}, {{output, shape}});
    std::size_t size = 1;
    for (const auto n : shape) size *= static_cast<std::size_t>(n);
    // Three rows, of which the middle one is looked at: rows must not mix.
    std::vector<double> p3(18, 55.0), w3(18, -66.0), found(3 * size);
    std::copy(p.begin(), p.end(), p3.begin() + 6);
    std::copy(w.begin(), w.end(), w3.begin() + 6);
    const std::array<const double*, 2> in{p3.data(), w3.data()};
    const std::array<double*, 1> out{found.data()};
    program.run(3, in, out);
    return {found.begin() + static_cast<std::ptrdiff_t>(size),
            found.begin() + static_cast<std::ptrdiff_t>(2 * size)};
  }
  std::string refusal(const std::string& output, std::vector<std::int64_t> shape) const {
    try {
      run(output, shape);
    } catch (const UnknownGraph& unknown) {
      return unknown.what();
    }
    return "accepted";
  }

  std::vector<double> p{0.3, -1.1, 2.3, 0.7, -0.9, 1.9};
  std::vector<double> w{4.1, -3.3, 2.7, -5.9, 6.1, 0.4};

 private:
  std::map<std::string, OnnxTensor> constants_;
  std::vector<OnnxNode> nodes_;
};

OnnxAttribute axis(std::int64_t value) { return GraphTemplate::integer_attribute("axis", value); }

}  // namespace

TEST_CASE("broadcasting follows the standard [oracle]") {
  Program program;
  program.doubles("c", {3}, {1.5, 2.5, 3.5}).node("Mul", {"w", "c"}, "y");
  CHECK(program.run("y", {2, 3}) ==
        std::vector<double>{4.1 * 1.5, -3.3 * 2.5, 2.7 * 3.5, -5.9 * 1.5, 6.1 * 2.5, 0.4 * 3.5});
  Program column;
  column.doubles("c", {1, 2, 1}, {10.0, 20.0}).node("Add", {"c", "w"}, "y");
  CHECK(column.run("y", {2, 3})[4] == 20.0 + 6.1);
  Program scalar;
  scalar.doubles("c", {}, {0.5}).node("Sub", {"c", "p"}, "y");
  CHECK(scalar.run("y", {6})[2] == 0.5 - 2.3);
}

TEST_CASE("slices, picks, joins and changes of shape [oracle]") {
  Program program;
  program.integers("one", {1})
      .integers("two", {2})
      .integers("six", {-1, 6})
      .integers("order", {4, 0, -1})
      .node("Slice", {"w", "one", "two", "two"}, "middle")
      .node("Reshape", {"w", "six"}, "flat")
      .node("Gather", {"flat", "order"}, "picked", {axis(1)})
      .node("Concat", {"picked", "p"}, "joined", {axis(-1)})
      .node("Transpose", {"w"}, "turned", {GraphTemplate::integers_attribute("perm", {0, 2, 1})})
      .node("Squeeze", {"middle", "two"}, "squeezed")
      .node("Unsqueeze", {"squeezed", "one"}, "wide");
  CHECK(program.run("middle", {2, 1}) == std::vector<double>{-3.3, 6.1});
  CHECK(program.run("joined", {9}) ==
        std::vector<double>{6.1, 4.1, 0.4, 0.3, -1.1, 2.3, 0.7, -0.9, 1.9});
  CHECK(program.run("turned", {3, 2}) == std::vector<double>{4.1, -5.9, -3.3, 6.1, 2.7, 0.4});
  CHECK(program.run("wide", {1, 2}) == std::vector<double>{-3.3, 6.1});
}

TEST_CASE("reductions, products and clipping [oracle]") {
  Program program;
  program.integers("two", {2})
      .doubles("m", {3, 2}, {1.5, -2.0, 0.5, 3.0, -1.0, 0.25})
      .doubles("b", {2}, {10.0, 20.0})
      .doubles("g", {6, 2}, std::vector<double>(12, 0.5))
      .doubles("low", {}, {-1.0})
      .doubles("high", {1}, {1.0})
      .node("ReduceSum", {"w", "two"}, "sums", {GraphTemplate::integer_attribute("keepdims", 0)})
      .node("ReduceMax", {"w"}, "largest",
            {GraphTemplate::integers_attribute("axes", {1, 2}),
             GraphTemplate::integer_attribute("keepdims", 0)})
      .node("MatMul", {"w", "m"}, "product")
      .node("Gemm", {"p", "g", "b"}, "affine")
      .node("Clip", {"p", "low", "high"}, "clipped");
  const auto sums = program.run("sums", {2});
  CHECK(std::abs(sums[0] - 3.5) <= 1e-15);
  CHECK(program.run("largest", {}) == std::vector<double>{6.1});
  const auto product = program.run("product", {2, 2});
  CHECK(std::abs(product[1] - (4.1 * -2.0 - 3.3 * 3.0 + 2.7 * 0.25)) <= 1e-14);
  CHECK(std::abs(product[2] - (-5.9 * 1.5 + 6.1 * 0.5 - 0.4)) <= 1e-14);
  const auto affine = program.run("affine", {2});
  CHECK(std::abs(affine[1] - (20.0 + 0.5 * 3.2)) <= 1e-14);
  CHECK(program.run("clipped", {6}) == std::vector<double>{0.3, -1.0, 1.0, 0.7, -0.9, 1.0});
}

TEST_CASE("what is not known, or works across poses, is refused [error]") {
  CHECK(Program().node("Softmax", {"p"}, "y").refusal("y", {6}) ==
        "Softmax that makes y: an operator that is not known here");
  CHECK(Program().node("Concat", {"p", "p"}, "y", {axis(0)}).refusal("y", {6}) ==
        "Concat that makes y: works across poses, or out of range");
  CHECK(Program().integers("s", {6, -1}).node("Reshape", {"p", "s"}, "y").refusal("y", {6}) ==
        "Reshape that makes y: does not keep the poses apart");
  CHECK(Program().node("Add", {"p", "net_I.hidden_1"}, "y").refusal("y", {6}) ==
        "Add that makes y: input 2 is no float64 constant");
  CHECK(Program().node("Add", {"p", "w"}, "y").refusal("y", {6}) ==
        "Add that makes y: operands of different rank");
  CHECK(Program().node("Abs", {"p"}, "y").refusal("trust", {}) ==
        "no node makes trust of the contract's shape");
}
