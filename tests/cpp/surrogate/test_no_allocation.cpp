// SPDX-License-Identifier: Apache-2.0
// What a surrogate allocates does not grow with the poses of a piece. In a program of its own,
// because it counts what operator new is asked for; what onnxruntime asks it for in a run is
// counted with it, and is a number a run.
#include <doctest/doctest.h>

#include <vector>

#include "condyle/surrogate/onnx_contact_model.hpp"
#include "support/count_allocations.hpp"
#include "surrogate/tiny_surrogate.hpp"

namespace condyle::surrogate {
namespace {

TEST_CASE("the counter counts") {
  CHECK(test::count_allocations([] { std::vector<double>(7).front() += 1.0; }) == 1);
}

TEST_CASE("a surrogate allocates a number a run, nothing a pose") {
  const OnnxContactModel model(test::surrogate_file("tiny_surrogate.onnx"));
  const auto poses = test::poses_about_domain(1024, 3);
  std::vector<double> wrench(poses.size() * 12), stiffness(poses.size() * 72);
  const auto evaluate = [&](std::size_t n) {
    model.evaluate_into(std::span(poses).first(n), 1,
                        {.wrench = std::span(wrench).first(12 * n),
                         .stiffness = std::span(stiffness).first(72 * n)});
  };
  const auto allocations = [&](std::size_t n) {
    evaluate(n);  // memory of this size is bound
    return test::count_allocations([&] { evaluate(n); });
  };
  const long of_few = allocations(2);
  MESSAGE("allocations a run: " << of_few);
  CHECK(allocations(1024) == of_few);
  CHECK(allocations(1) <= of_few);
}

void check_no_allocation(const char* file) {
  const OnnxContactModel model(test::surrogate_file(file), Runtime::kFused);
  const auto poses = test::poses_about_domain(1024, 3);
  std::vector<double> wrench(poses.size() * 12), stiffness(poses.size() * 72);
  std::vector<double> error(poses.size() * 12), trust(poses.size());
  double sum = 0.0;
  const auto one = [&] { sum += model.evaluate(poses[7], contact::Derivatives::kStiffness).trust; };
  const auto batch = [&] { model.evaluate_into(poses, 1, {wrench, stiffness, error, trust, {}}); };
  one();  // the thread's memory is there
  CHECK(test::count_allocations(one) == 0);
  CHECK(test::count_allocations(batch) == 0);
}

TEST_CASE("a fused surrogate allocates nothing") {
  check_no_allocation("tiny_two_stage.onnx");
  check_no_allocation("tiny_potential.onnx");
}

}  // namespace
}  // namespace condyle::surrogate
