// SPDX-License-Identifier: Apache-2.0
#include <condyle.h>
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

namespace {

const std::string kFull = std::string(CONDYLE_TEST_DATA) + "/tiny_two_stage.onnx";
const std::string kWrenchOnly = std::string(CONDYLE_TEST_DATA) + "/tiny_two_stage_wrench.onnx";
// The middle of the file's domain (tests/data/make_tiny_two_stage.py), and far from it.
constexpr double kInside[6] = {0.0041, 0.0398, 0.0006, -0.013, 0.037, -0.41};
constexpr double kFar[6] = {0.31, 0.43, -0.27, 1.3, -1.1, 2.1};

/// A model that goes at the end of the test.
struct Model {
  explicit Model(const std::string& file) {
    status = condyle_create(file.c_str(), "fused", &model);
  }
  ~Model() { condyle_destroy(model); }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  condyle_model* model = nullptr;
  condyle_status status;
};

std::string last_error() { return condyle_last_error(); }

int constant_reference(void* user_data, const double* pose, double* wrench, double* stiffness) {
  ++*static_cast<int*>(user_data);
  for (int i = 0; i < 12; ++i) wrench[i] = 100.0 * pose[0] + i;
  if (stiffness != nullptr) {
    for (int i = 0; i < 72; ++i) stiffness[i] = 0.5 + i;
  }
  return 0;
}

int failing_reference(void*, const double*, double*, double*) { return 37; }

}  // namespace

TEST_CASE(
    "one pose and a batch give the same, and a stiffness that is the derivative [derivative]") {
  const Model m(kFull);
  REQUIRE(m.status == CONDYLE_OK);
  double wrench[12], stiffness[72], error[12], trust;
  REQUIRE(condyle_evaluate(m.model, kInside, wrench, stiffness, error, &trust) == CONDYLE_OK);
  CHECK(trust > 0.5);
  CHECK(error[1] > 0.0);
  double poses[13 * 6], found[13 * 12], trusts[13];
  constexpr double kStep = 1e-7;
  for (int n = 0; n < 13; ++n) std::memcpy(poses + 6 * n, kInside, sizeof kInside);
  for (int j = 0; j < 6; ++j) {
    poses[6 * (1 + 2 * j) + j] += kStep;
    poses[6 * (2 + 2 * j) + j] -= kStep;
  }
  condyle_batch results{};
  results.wrench = found;
  results.wrench_size = 13 * 12;
  results.trust = trusts;
  results.trust_size = 13;
  REQUIRE(condyle_evaluate_batch(m.model, poses, 13 * 6, 2, &results) == CONDYLE_OK);
  CHECK(std::memcmp(found, wrench, sizeof wrench) == 0);
  CHECK(trusts[0] == trust);
  int moving = 0;
  for (int side = 0; side < 2; ++side) {
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) {
        const int load = 6 * side + i;
        const double difference =
            (found[12 * (1 + 2 * j) + load] - found[12 * (2 + 2 * j) + load]) / (2 * kStep);
        // Rounding: ε·2e3/1e-7 = 5e-6, of derivatives of 1e1 to 1e6; truncation is below it.
        CHECK(std::abs(stiffness[6 * load + j] - difference) <= 1e-4 + 1e-6 * std::abs(difference));
        moving += std::abs(difference) > 1.0;
      }
    }
  }
  CHECK(moving >= 30);
}

TEST_CASE("a model says what it is [property]") {
  const Model m(kFull);
  const std::string text = condyle_describe(m.model);
  CHECK(text.find("\"runtime\": \"fused\"") != std::string::npos);
  CHECK(text.find("\"condyle.units\": \"m,rad,N,Nm\"") != std::string::npos);
  CHECK(text.find("none, seeded weights") != std::string::npos);
  CHECK(condyle_describe(nullptr) == nullptr);
  CHECK(std::string(condyle_version()).find('.') != std::string::npos);
}

TEST_CASE("a hybrid calls the reference where the surrogate is not to be trusted [property]") {
  int called = 0;
  condyle_model* model = nullptr;
  REQUIRE(condyle_create_hybrid(kFull.c_str(), nullptr, constant_reference, &called, &model) ==
          CONDYLE_OK);
  double wrench[12], stiffness[72], error[12], trust;
  REQUIRE(condyle_evaluate(model, kInside, wrench, nullptr, nullptr, &trust) == CONDYLE_OK);
  CHECK(called == 0);
  REQUIRE(condyle_evaluate(model, kFar, wrench, stiffness, error, &trust) == CONDYLE_OK);
  CHECK(called == 1);
  CHECK(wrench[7] == 100.0 * kFar[0] + 7);
  CHECK(stiffness[40] == 40.5);
  CHECK(trust == 1.0);
  CHECK(error[3] == 0.0);
  double poses[18], found[36];
  std::memcpy(poses, kFar, sizeof kFar);
  std::memcpy(poses + 6, kInside, sizeof kInside);
  std::memcpy(poses + 12, kFar, sizeof kFar);
  condyle_batch results{};
  results.wrench = found;
  results.wrench_size = 36;
  REQUIRE(condyle_evaluate_batch(model, poses, 18, 4, &results) == CONDYLE_OK);
  CHECK(called == 3);
  CHECK(found[12 * 2 + 5] == 100.0 * kFar[0] + 5);
  CHECK(found[12 + 5] != 100.0 * kInside[0] + 5);
  std::uint64_t calls = 0;
  REQUIRE(condyle_reference_calls(model, &calls) == CONDYLE_OK);
  CHECK(calls == 3);
  condyle_destroy(model);

  REQUIRE(condyle_create_hybrid(kFull.c_str(), nullptr, failing_reference, nullptr, &model) ==
          CONDYLE_OK);
  CHECK(condyle_evaluate(model, kFar, wrench, nullptr, nullptr, nullptr) ==
        CONDYLE_REFERENCE_FAILED);
  CHECK(last_error() == "the reference returned 37: must be 0 for success");
  condyle_destroy(model);
  CHECK(condyle_create_hybrid(kWrenchOnly.c_str(), nullptr, constant_reference, &called, &model) ==
        CONDYLE_INVALID_ARGUMENT);
  CHECK(model == nullptr);
  CHECK(condyle_create_hybrid(kFull.c_str(), nullptr, nullptr, nullptr, &model) ==
        CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "reference is null");
}

TEST_CASE("where trust is between the levels a hybrid blends both loads [property]") {
  const Model surrogate(kFull);
  double pose[6], known[12], trust = 0.0, low = 0.0, high = 1.0;
  // On the way from the domain's middle outwards trust falls from 1 to 0.
  for (int bisections = 0; bisections < 60 && std::abs(trust - 0.62) > 0.05; ++bisections) {
    const double way = (low + high) / 2.0;
    for (int i = 0; i < 6; ++i) pose[i] = (1.0 - way) * kInside[i] + way * kFar[i];
    REQUIRE(condyle_evaluate(surrogate.model, pose, known, nullptr, nullptr, &trust) == CONDYLE_OK);
    (trust > 0.62 ? low : high) = way;
  }
  REQUIRE(trust > 0.55);
  REQUIRE(trust < 0.7);
  int called = 0;
  condyle_model* hybrid = nullptr;
  REQUIRE(condyle_create_hybrid(kFull.c_str(), nullptr, constant_reference, &called, &hybrid) ==
          CONDYLE_OK);
  double found[12], error[12], blended = 0.0;
  REQUIRE(condyle_evaluate(hybrid, pose, found, nullptr, error, &blended) == CONDYLE_OK);
  CHECK(called == 1);
  const double s = 4.0 * trust - 2.0, weight = s * s * (3.0 - 2.0 * s);
  for (int i = 0; i < 12; ++i) {
    const double reference = 100.0 * pose[0] + i;
    CHECK(found[i] ==
          doctest::Approx(reference + weight * (known[i] - reference)).epsilon(1e-12));
    CHECK(error[i] > 0.0);
  }
  CHECK(blended == doctest::Approx(1.0 - weight * (1.0 - trust)).epsilon(1e-12));
  condyle_destroy(hybrid);
}

TEST_CASE("a caller's mistakes are statuses, each with its reason [error]") {
  const Model m(kFull);
  double wrench[12], stiffness[72];
  CHECK(condyle_evaluate(nullptr, kInside, wrench, nullptr, nullptr, nullptr) ==
        CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "model is null");
  CHECK(condyle_evaluate(m.model, nullptr, wrench, nullptr, nullptr, nullptr) ==
        CONDYLE_INVALID_ARGUMENT);
  CHECK(condyle_evaluate(m.model, kInside, nullptr, nullptr, nullptr, nullptr) ==
        CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "wrench is null");
  double pose[6];
  std::memcpy(pose, kInside, sizeof pose);
  pose[4] = std::nan("");
  CHECK(condyle_evaluate(m.model, pose, wrench, nullptr, nullptr, nullptr) ==
        CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "pose: theta_y is nan: must be finite");

  condyle_batch results{};
  results.wrench = wrench;
  results.wrench_size = 12;
  CHECK(condyle_evaluate_batch(m.model, kInside, 5, 1, &results) == CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "poses_size is 5: must be a multiple of 6");
  CHECK(condyle_evaluate_batch(m.model, kInside, 6, 1, nullptr) == CONDYLE_INVALID_ARGUMENT);
  results.stiffness = stiffness;
  results.stiffness_size = 36;
  CHECK(condyle_evaluate_batch(m.model, kInside, 6, 1, &results) == CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "evaluate_into: stiffness has 36 values: 1 poses need 72");
  results.stiffness_size = 72;
  CHECK(condyle_evaluate_batch(m.model, kInside, 6, -2, &results) == CONDYLE_INVALID_ARGUMENT);
  CHECK(condyle_evaluate_batch(m.model, nullptr, 0, 1, &results) == CONDYLE_OK);
  CHECK(condyle_reference_calls(m.model, nullptr) == CONDYLE_INVALID_ARGUMENT);
  condyle_destroy(nullptr);
}

TEST_CASE("files and runtimes that cannot be used are refused [error]") {
  condyle_model* model = nullptr;
  CHECK(condyle_create("/nowhere/knee.onnx", nullptr, &model) == CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "/nowhere/knee.onnx: cannot be opened for reading");
  CHECK(model == nullptr);
  CHECK(condyle_create(nullptr, nullptr, &model) == CONDYLE_INVALID_ARGUMENT);
  CHECK(condyle_create(kFull.c_str(), nullptr, nullptr) == CONDYLE_INVALID_ARGUMENT);
  CHECK(condyle_create(kFull.c_str(), "gpu", &model) == CONDYLE_INVALID_ARGUMENT);
  CHECK(last_error() == "runtime is 'gpu': must be auto, fused or onnxruntime");
  const Model alone(kWrenchOnly);
  REQUIRE(alone.status == CONDYLE_OK);
  double wrench[12], stiffness[72], trust;
  CHECK(condyle_evaluate(alone.model, kInside, wrench, nullptr, nullptr, &trust) == CONDYLE_OK);
  CHECK(std::isnan(trust));
  CHECK(condyle_evaluate(alone.model, kInside, wrench, stiffness, nullptr, nullptr) ==
        CONDYLE_INVALID_ARGUMENT);
}

TEST_CASE("each thread has an error of its own, and one model serves them all [property]") {
  const Model m(kFull);
  double wrench[12];
  CHECK(condyle_evaluate(nullptr, kInside, wrench, nullptr, nullptr, nullptr) != CONDYLE_OK);
  REQUIRE(condyle_evaluate(m.model, kInside, wrench, nullptr, nullptr, nullptr) == CONDYLE_OK);
  std::vector<std::string> said(4);
  std::vector<int> differing(4, 0);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < said.size(); ++t) {
      threads.emplace_back([&, t] {
        said[t] = condyle_last_error();
        double mine[12];
        for (int n = 0; n < 500; ++n) {
          condyle_evaluate(m.model, kInside, mine, nullptr, nullptr, nullptr);
          differing[t] += std::memcmp(mine, wrench, sizeof mine) != 0;
        }
      });
    }
  }
  for (const auto& text : said) CHECK(text.empty());
  for (const int count : differing) CHECK(count == 0);
  CHECK(last_error() == "model is null");
}
