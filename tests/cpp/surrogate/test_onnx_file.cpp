// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <fstream>
#include <random>
#include <stdexcept>
#include <vector>

#include "condyle/surrogate/onnx_file.hpp"
#include "surrogate/tiny_surrogate.hpp"

using condyle::surrogate::OnnxFile;
using condyle::surrogate::parse_onnx;
using condyle::surrogate::read_bytes;
using condyle::surrogate::read_onnx;
using namespace condyle::test;

TEST_CASE("graph, constants, signature and metadata are read [oracle]") {
  const OnnxFile file = read_onnx(kTestData / "tiny_surrogate.onnx");
  CHECK(file.beyond.empty());
  REQUIRE(file.signature.inputs.size() == 1);
  CHECK(file.signature.inputs[0].name == "pose");
  CHECK(file.signature.inputs[0].type == "float64");
  CHECK(file.signature.inputs[0].shape == std::vector<std::int64_t>{-1, 6});
  REQUIRE(file.signature.outputs.size() == 4);
  CHECK(file.signature.metadata.at("condyle.units") == "m,rad,N,Nm");
  CHECK(file.signature.metadata.at("condyle.side_of_body") == "left");
  // The medial side's Fy scale stands among the constants.
  bool found = false;
  for (const auto& [name, tensor] : file.initialisers) {
    std::size_t count = 1;
    for (const auto size : tensor.shape) count *= static_cast<std::size_t>(size);
    if (tensor.type == "float64") CHECK(tensor.doubles.size() == count);
    if (tensor.type == "int64") CHECK(tensor.integers.size() == count);
    for (const double value : tensor.doubles) found = found || value == kScale[0][1];
  }
  CHECK(found);
  CHECK(file.nodes.size() > 5);
}

TEST_CASE("a file cut anywhere is refused or lacks what was cut off [property]") {
  const auto whole = read_bytes(kTestData / "tiny_surrogate.onnx");
  const std::size_t all = read_onnx(kTestData / "tiny_surrogate.onnx").signature.metadata.size();
  std::size_t refused = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    try {
      const OnnxFile file = parse_onnx(std::span(whole).first(size), "cut.onnx");
      // Between two fields of the model itself a cut does not show; the contract's metadata stand
      // last.
      CHECK(file.signature.metadata.size() < all);
    } catch (const std::invalid_argument& error) {
      ++refused;
      CHECK(std::string(error.what()).starts_with("cut.onnx: not an ONNX model (truncated?): "));
    }
  }
  CHECK(refused > whole.size() * 9 / 10);
}

TEST_CASE("bytes changed at random are read or refused, never worse [property]") {
  const auto whole = read_bytes(kTestData / "tiny_surrogate.onnx");
  std::mt19937_64 generator(71);
  std::size_t refused = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto changed = whole;
    for (int n = 0; n < 1 + trial % 5; ++n) {
      changed[generator() % changed.size()] = static_cast<char>(generator());
    }
    try {
      parse_onnx(changed, "changed.onnx");
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  MESSAGE(refused << " of " << kTrials << " refused");
  CHECK(refused > 100);
  CHECK(refused < kTrials);
}

TEST_CASE("text and noise are no model [error]") {
  const std::string text = "solid femur\n  facet normal 0 0 1\n";
  CHECK_THROWS_AS(parse_onnx(text, "a.onnx"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(read_onnx("/nowhere/knee.onnx"),
                       "/nowhere/knee.onnx: cannot be opened for reading", std::invalid_argument);
  CHECK_THROWS_WITH_AS(parse_onnx({}, "a.onnx"),
                       "a.onnx: not an ONNX model (truncated?): it has no graph",
                       std::invalid_argument);
}
