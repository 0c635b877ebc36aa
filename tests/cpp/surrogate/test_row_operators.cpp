// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "condyle/surrogate/row_operators.hpp"

using namespace condyle::surrogate;

namespace {

/// Two rows of three elements, and memory for results.
struct Memory {
  std::vector<double> in{0.7, -1.3, 2.1, -0.4, 3.7, -2.9};
  std::vector<double> out = std::vector<double>(2 * 20, 99.0);
  std::vector<RowSpan> spans{{in.data(), 3}, {out.data(), 20}};
  std::vector<double> row(std::size_t r, std::size_t n) const {
    const auto begin = out.begin() + static_cast<std::ptrdiff_t>(20 * r);
    return {begin, begin + static_cast<std::ptrdiff_t>(n)};
  }
};

using Row = std::vector<double>;

}  // namespace

TEST_CASE("operators work element by element, on each row by itself [oracle]") {
  Memory m;
  unary_step("Abs", {0, {}, {}}, 3, 1)->run(2, m.spans);
  CHECK(m.row(0, 4) == Row{0.7, 1.3, 2.1, 99.0});
  CHECK(m.row(1, 3) == Row{0.4, 3.7, 2.9});
  binary_step("Sub", {-1, {1.5, 2.5, 3.5}, {}}, {0, {}, {}}, 3, 1)->run(2, m.spans);
  CHECK(m.row(1, 3) == Row{1.5 + 0.4, 2.5 - 3.7, 3.5 + 2.9});
  // Element 2 against each: broadcast.
  binary_step("LessOrEqual", {0, {}, {}}, {0, {}, {2, 2, 2}}, 3, 1)->run(2, m.spans);
  CHECK(m.row(0, 3) == Row{1.0, 1.0, 1.0});
  CHECK(m.row(1, 3) == Row{0.0, 0.0, 1.0});
  where_step({-1, {1.0, 0.0, 1.0}, {}}, {0, {}, {}}, {-1, {8.0, 9.0, 10.0}, {}}, 3, 1)
      ->run(2, m.spans);
  CHECK(m.row(1, 3) == Row{-0.4, 9.0, -2.9});
  pick_step({{0, 2}, {0, 0}, {0, 2}}, 1)->run(2, m.spans);
  CHECK(m.row(1, 3) == Row{-2.9, -0.4, -2.9});
  CHECK(unary_step("Erf", {}, 0, 0) == nullptr);
  CHECK(binary_step("Mod", {}, {}, 0, 0) == nullptr);
}

TEST_CASE("reductions run over groups of elements [oracle]") {
  const auto reduced = [](const char* op) {
    Memory m;
    reduce_step(op, 0, {{0, 2}, {1}}, 1)->run(2, m.spans);
    return m.row(1, 2);
  };
  CHECK(reduced("ReduceSum") == Row{-0.4 - 2.9, 3.7});
  CHECK(reduced("ReduceMean") == Row{(-0.4 - 2.9) / 2, 3.7});
  CHECK(reduced("ReduceMax") == Row{-0.4, 3.7});
  CHECK(reduced("ReduceMin") == Row{-2.9, 3.7});
  CHECK(reduced("ReduceSumSquare") == Row{-0.4 * -0.4 + 2.9 * 2.9, 3.7 * 3.7});
  CHECK(reduced("ReduceL2") == Row{std::sqrt(-0.4 * -0.4 + 2.9 * 2.9), std::sqrt(3.7 * 3.7)});
  CHECK(reduce_step("ReduceProd", 0, {}, 1) == nullptr);
}

TEST_CASE("what is not a number is not lost in a largest or smallest [property]") {
  Memory m;
  m.in[1] = std::nan("");
  for (const char* op : {"ReduceMax", "ReduceMin"}) {
    reduce_step(op, 0, {{0, 1, 2}}, 1)->run(1, m.spans);
    CHECK(std::isnan(m.row(0, 1)[0]));
  }
  binary_step("Max", {0, {}, {}}, {-1, {5.0, 5.0, 5.0}, {}}, 3, 1)->run(1, m.spans);
  CHECK(std::isnan(m.row(0, 2)[1]));
}

TEST_CASE("products by a constant matrix, wider than a panel [oracle]") {
  Memory m;
  constexpr std::size_t kOutputs = 19;
  std::vector<double> weight(3 * kOutputs), bias(kOutputs);
  for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = std::sin(1.3 + double(i));
  for (std::size_t j = 0; j < kOutputs; ++j) bias[j] = std::cos(2.7 * double(j));
  multiply_step(0, 1, 3, kOutputs, weight, bias, 1)->run(2, m.spans);
  for (std::size_t r = 0; r < 2; ++r) {
    const Row found = m.row(r, 20);
    for (std::size_t j = 0; j < kOutputs; ++j) {
      double sum = bias[j];
      for (std::size_t k = 0; k < 3; ++k) sum += m.in[3 * r + k] * weight[k * kOutputs + j];
      CHECK(std::abs(found[j] - sum) <= 1e-14);
    }
    CHECK(found[kOutputs] == 99.0);
  }
}
