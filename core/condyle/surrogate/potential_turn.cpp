// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/potential_turn.hpp"

#include <cstddef>
#include <numbers>

namespace condyle::surrogate {
namespace {

constexpr std::size_t kThetaX = 3;
constexpr std::size_t kThetaY = 4;

using Terms = std::array<double, 1 + kTurnSines>;

/// factor·sin(θx + k·θy) + other·sin(θx − k·θy), or of cosines, over cos²θy.
Terms pair(std::size_t first, int k, double factor, double other) {
  Terms terms{};
  terms[first + 2 * static_cast<std::size_t>(k + 2)] += factor;
  terms[first + 2 * static_cast<std::size_t>(2 - k)] += other;
  return terms;
}

Terms sines(int k, double factor, double other) { return pair(1, k, factor, other); }
Terms cosines(int k, double factor, double other) { return pair(2, k, factor, other); }

Terms plus(Terms a, const Terms& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

Terms minus(Terms a) {
  for (double& term : a) term = -term;
  return a;
}

/// Rows My and Mz by Qθx, Qθy, Qθz.
TurnMatrix moments(const std::array<std::array<Terms, 3>, 2>& entries) {
  TurnMatrix matrix{};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 3; ++j) matrix[4 + i][3 + j] = entries[i][j];
  }
  return matrix;
}

}  // namespace

std::vector<double> turn_multiples() {
  std::vector<double> multiples(6 * kTurnSines);
  const auto at = [&](std::size_t coordinate, int sine) -> double& {
    return multiples[coordinate * kTurnSines + static_cast<std::size_t>(sine)];
  };
  for (int sine = 0; sine + 1 < kTurnSines; ++sine) {
    at(kThetaX, sine) = 1.0;
    at(kThetaY, sine) = sine / 2 - 2;
  }
  at(kThetaY, kTurnSines - 1) = 1.0;
  return multiples;
}

std::vector<double> turn_phases() {
  std::vector<double> phases(kTurnSines);
  for (std::size_t sine = 1; sine < kTurnSines; sine += 2) phases[sine] = std::numbers::pi / 2;
  phases.back() = std::numbers::pi / 2;
  return phases;
}

std::array<TurnMatrix, 3> turn_matrices() {
  // sin θx and cos θx, times tan θy, times 1/cos θy (sec), as named.
  const Terms s = plus(sines(0, 0.25, 0.25), sines(2, 0.25, 0.25));
  const Terms c = plus(cosines(0, 0.25, 0.25), cosines(2, 0.25, 0.25));
  const Terms s_tan = cosines(2, -0.25, 0.25), c_tan = sines(2, 0.25, -0.25);
  const Terms s_sec = sines(1, 0.5, 0.5), c_sec = cosines(1, 0.5, 0.5);
  const Terms s_sec_sec = sines(0, 0.5, 0.5), c_sec_sec = cosines(0, 0.5, 0.5);
  const Terms s_tan_sec = cosines(1, -0.5, 0.5), c_tan_sec = sines(1, 0.5, -0.5);
  TurnMatrix turn =
      moments({{{minus(s_tan), minus(c), minus(s_sec)}, {minus(c_tan), s, minus(c_sec)}}});
  for (std::size_t i = 0; i < 3; ++i) turn[i][i][0] = 1.0;
  turn[3][3][0] = -1.0;
  return {turn, moments({{{minus(c_tan), s, minus(c_sec)}, {s_tan, c, s_sec}}}),
          moments({{{minus(s_sec_sec), Terms{}, minus(s_tan_sec)},
                    {minus(c_sec_sec), Terms{}, minus(c_tan_sec)}}})};
}

}  // namespace condyle::surrogate
