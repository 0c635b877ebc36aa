// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstdlib>
#include <stdexcept>

#include "condyle/surrogate/onnx_session.hpp"
#include "surrogate/tiny_surrogate.hpp"

using condyle::Pose;
using condyle::surrogate::OnnxSession;
using namespace condyle::test;

namespace {

std::string refusal(const std::filesystem::path& file) {
  try {
    const OnnxSession session(file);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("the signature is what the file declares [property]") {
  const OnnxSession session(surrogate_file("tiny_surrogate.onnx"));
  const auto& signature = session.signature();
  REQUIRE(signature.inputs.size() == 1);
  CHECK(signature.inputs[0].name == "pose");
  CHECK(signature.inputs[0].type == "float64");
  CHECK(signature.inputs[0].shape == std::vector<std::int64_t>{-1, 6});
  REQUIRE(signature.outputs.size() == 4);
  CHECK(signature.outputs[1].name == "stiffness");
  CHECK(signature.outputs[1].shape == std::vector<std::int64_t>{-1, 2, 6, 6});
  CHECK(signature.outputs[3].shape == std::vector<std::int64_t>{-1});
  CHECK(signature.metadata.at("condyle.side_of_body") == "left");
  CHECK(signature.metadata.size() == 13);
}

TEST_CASE("one workspace serves runs of any number of rows [regression]") {
  const OnnxSession session(surrogate_file("tiny_surrogate.onnx"));
  const auto poses = poses_about_domain(OnnxSession::kMaxRows, 7);
  for (const std::size_t rows :
       {OnnxSession::kMaxRows, std::size_t{5}, std::size_t{1}, std::size_t{37}}) {
    session.run(std::span(poses).last(rows), [&](std::span<const double* const> outputs) {
      REQUIRE(outputs.size() == 4);
      for (std::size_t row = 0; row < rows; ++row) {
        const Pose& pose = poses[poses.size() - rows + row];
        const Eigen::Map<const condyle::Vector6> medial(outputs[0] + 12 * row);
        const auto expected = tiny_loads(pose).wrench[condyle::kMedial];
        // A dot product of six terms and two products: a few roundings of the largest term, ~10 in
        // u.
        CHECK((medial - expected).norm() <= 1e-13 * (kScale[0].norm() * 100.0));
      }
    });
  }
}

TEST_CASE("a library that is open stays in use, whatever the environment then says [property]") {
  const OnnxSession session(surrogate_file("tiny_surrogate.onnx"));
  const std::string in_use = condyle::surrogate::onnxruntime_library();
  const char* old = std::getenv("CONDYLE_ONNXRUNTIME");
  const std::string kept = old != nullptr ? old : "";
  setenv("CONDYLE_ONNXRUNTIME", "/nowhere/libonnxruntime.so.1", 1);
  CHECK(condyle::surrogate::onnxruntime_library() == in_use);
  CHECK(condyle::surrogate::onnxruntime_version().starts_with("1."));
  if (old != nullptr) {
    setenv("CONDYLE_ONNXRUNTIME", kept.c_str(), 1);
  } else {
    unsetenv("CONDYLE_ONNXRUNTIME");
  }
}

TEST_CASE("a file that is no ONNX model is refused by name [error]") {
  CHECK(refusal("/nowhere/knee.onnx") == "/nowhere/knee.onnx: cannot be opened for reading");
  CHECK(refusal(kTestData) == kTestData.string() + ": cannot be opened for reading");

  ChangedFile empty(surrogate_file("tiny_surrogate.onnx"), "empty.onnx");
  empty.truncate(0);
  CHECK(refusal(empty.write()) == empty.write().string() + ": is empty, not an ONNX model");

  ChangedFile half(surrogate_file("tiny_surrogate.onnx"), "half.onnx");
  half.truncate(half.size() / 2);
  const std::string message = refusal(half.write());
  CHECK(message.starts_with(half.write().string() + ": not an ONNX model that onnxruntime 1."));
  CHECK(message.find('\n') == std::string::npos);

  const std::string text = refusal(kTestData / "make_tiny_surrogate.py");
  CHECK(text.find("make_tiny_surrogate.py: not an ONNX model") != std::string::npos);
}
