// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "condyle/surrogate/dense_kernels.hpp"

using namespace condyle::surrogate;

namespace {

std::vector<double> draw(std::size_t count, double range, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-range, range);
  std::vector<double> values(count);
  for (double& value : values) value = uniform(generator);
  return values;
}

double tanh_by(const DenseKernels& kernels, double x) {
  std::vector<double> column(kDenseStep, x), bias(kDenseStep, 0.0);
  kernels.tanh(bias.data(), kDenseStep, column.data(), kDenseStep, 1);
  return column[3];
}

}  // namespace

TEST_CASE("the first kernels are the best, the last run everywhere") {
  const auto all = all_dense_kernels();
  REQUIRE(!all.empty());
  CHECK(std::string(all.back().instruction_set) == "baseline");
  CHECK(std::string(dense_kernels().instruction_set) == all.front().instruction_set);
}

TEST_CASE("tanh is within a few units in the last place everywhere [oracle]") {
  constexpr double kEps = std::numeric_limits<double>::epsilon();
  for (const DenseKernels& kernels : all_dense_kernels()) {
    CAPTURE(kernels.instruction_set);
    double worst = 0.0;
    for (int width : {8, 32, 40}) {
      for (const double range : {1e-12, 1e-3, 0.4, 3.0, 25.0}) {
        const auto x = draw(static_cast<std::size_t>(width), range, 5 + width);
        const auto bias = draw(static_cast<std::size_t>(width), range / 3, 9 + width);
        auto column = x;
        kernels.tanh(bias.data(), width, column.data(), width, 1);
        for (std::size_t j = 0; j < x.size(); ++j) {
          const double expected = std::tanh(x[j] + bias[j]);
          worst = std::max(worst, std::abs(column[j] - expected) / std::abs(expected));
        }
      }
    }
    // Eight roundings after the fraction, half a unit each, and those of the fraction itself.
    CHECK(worst <= 8 * kEps);
  }
}

TEST_CASE("tanh at its ends [property]") {
  for (const DenseKernels& kernels : all_dense_kernels()) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    CHECK(tanh_by(kernels, 0.0) == 0.0);
    CHECK(std::abs(tanh_by(kernels, 40.0) - 1.0) <= 1e-15);
    CHECK(std::abs(tanh_by(kernels, kInfinity) - 1.0) <= 1e-15);
    CHECK(std::abs(tanh_by(kernels, -1e300) + 1.0) <= 1e-15);
    CHECK(std::isnan(tanh_by(kernels, std::nan(""))));
  }
}

TEST_CASE("products are the sums they are defined as, in any number of columns [oracle]") {
  for (const DenseKernels& kernels : all_dense_kernels()) {
    for (const int width : {8, 16, 24, 32, 128}) {
      constexpr int kInputs = 13, kIn = 17;
      const int out_stride = width + 8;
      const auto weight = draw(static_cast<std::size_t>(kInputs * width), 1.7, 3);
      const auto in = draw(kIn * kMaxDenseColumns, 2.3, 4);
      std::vector<double> all(static_cast<std::size_t>(out_stride * kMaxDenseColumns));
      kernels.multiply(weight.data(), kInputs, width, in.data(), kIn, kMaxDenseColumns, all.data(),
                       out_stride);
      double worst = 0.0;
      for (int c = 0; c < kMaxDenseColumns; ++c) {
        for (int j = 0; j < width; ++j) {
          long double sum = 0.0L;
          for (int i = 0; i < kInputs; ++i) {
            sum += static_cast<long double>(weight[static_cast<std::size_t>(i * width + j)]) *
                   in[static_cast<std::size_t>(c * kIn + i)];
          }
          const double found = all[static_cast<std::size_t>(c * out_stride + j)];
          worst = std::max(worst, std::abs(found - static_cast<double>(sum)));
        }
      }
      // 13 products of up to 1.7·2.3, each added with one or two roundings.
      CHECK(worst <= 2 * 13 * 13 * 4.0 * 1.2e-16);
      // A column is the same bytes whatever stands beside it.
      for (const int columns : {1, 2, 3, 5, 7, 11}) {
        std::vector<double> few(all.size());
        kernels.multiply(weight.data(), kInputs, width, in.data(), kIn, columns, few.data(),
                         out_stride);
        int differing = 0;
        for (int c = 0; c < columns; ++c) {
          for (int j = 0; j < width; ++j) {
            const auto at = static_cast<std::size_t>(c * out_stride + j);
            differing += few[at] != all[at];
          }
        }
        CHECK(differing == 0);
      }
    }
  }
}

TEST_CASE("derivatives are multiplied by the slope at their value [oracle]") {
  for (const DenseKernels& kernels : all_dense_kernels()) {
    constexpr int kWidth = 24;
    const auto bias = draw(kWidth, 0.5, 6);
    const auto before = draw(kWidth * 2 * kPoseColumns, 1.5, 7);
    auto after = before;
    kernels.tanh_with_derivatives(bias.data(), kWidth, after.data(), kWidth, 2 * kPoseColumns);
    for (int c = 0; c < 2 * kPoseColumns; ++c) {
      for (int j = 0; j < kWidth; ++j) {
        const auto at = static_cast<std::size_t>(c * kWidth + j);
        const auto value = static_cast<std::size_t>(c / kPoseColumns * kPoseColumns * kWidth + j);
        const double h = std::tanh(before[value] + bias[static_cast<std::size_t>(j)]);
        const double expected = c % kPoseColumns == 0 ? h : before[at] * (1.0 - h * h);
        CHECK(std::abs(after[at] - expected) <= 1e-14);
      }
    }
  }
}

TEST_CASE("steps back and forth through tanh are the products they are defined as [oracle]") {
  for (const DenseKernels& kernels : all_dense_kernels()) {
    CAPTURE(kernels.instruction_set);
    constexpr int kWidth = 24, kColumns = 3;
    const auto hidden = draw(kWidth * kColumns, 0.95, 11);
    const auto delta = draw(kWidth * kColumns, 1.5, 12);
    const auto tangent = draw(kWidth * kDenseTangents, 1.3, 13);
    auto values = delta;
    kernels.times_slope(hidden.data(), kWidth, values.data(), kWidth, kColumns);
    double worst = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      worst = std::max(worst, std::abs(values[i] - (1.0 - hidden[i] * hidden[i]) * delta[i]));
    }
    std::vector<double> out(tangent.size());
    kernels.slope_tangents(hidden.data(), kWidth, tangent.data(), kWidth, out.data(), kWidth);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double h = hidden[i % kWidth];
      worst = std::max(worst, std::abs(out[i] - (1.0 - h * h) * tangent[i]));
    }
    // Three roundings of numbers up to 1.5.
    CHECK(worst <= 1e-15);
  }
}

TEST_CASE("curvature is the sum over neurons that it is defined as [oracle]") {
  for (const DenseKernels& kernels : all_dense_kernels()) {
    CAPTURE(kernels.instruction_set);
    constexpr int kWidth = 40;
    const auto hidden = draw(kWidth, 0.95, 14), delta = draw(kWidth, 1.5, 15);
    const auto tangent = draw(kWidth * kDenseTangents, 1.3, 16);
    const auto before = draw(kDensePairs, 2.0, 17);
    auto sums = before;
    kernels.add_curvature(hidden.data(), delta.data(), kWidth, tangent.data(), kWidth, sums.data());
    std::size_t pair = 0;
    for (std::size_t k = 0; k < kDenseTangents; ++k) {
      for (std::size_t m = k; m < kDenseTangents; ++m, ++pair) {
        double expected = before[pair];
        for (std::size_t j = 0; j < kWidth; ++j) {
          expected -=
              2.0 * hidden[j] * delta[j] * tangent[k * kWidth + j] * tangent[m * kWidth + j];
        }
        // 40 terms of up to 5, a few roundings each.
        CHECK(std::abs(sums[pair] - expected) <= 1e-13);
      }
    }
  }
}
