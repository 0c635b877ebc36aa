// SPDX-License-Identifier: Apache-2.0
// The constants by which a potential's graph turns a generalised force into a wrench: R = G⁻ᵀ and
// its derivatives by θx and θy, linear in eleven sines over cos²θy. See
// python/condyle/training/onnx_potential.py, whose counterpart this is.
#pragma once

#include <array>
#include <vector>

namespace condyle::surrogate {

/// Sines of θx + k·θy and their cosines, k = −2 ... 2, and the cosine of θy.
inline constexpr int kTurnSines = 11;

/// What the sines are of: (6, 11) multiples of the pose's coordinates, and phases (11).
std::vector<double> turn_multiples();
std::vector<double> turn_phases();

/// A 6 × 6 matrix that is linear in the sines: element (i, j) is the sum of coefficients [i][j][0]
/// and, times the sine s, [i][j][1 + s].
using TurnMatrix = std::array<std::array<std::array<double, 1 + kTurnSines>, 6>, 6>;

/// R, ∂R/∂θx, ∂R/∂θy.
std::array<TurnMatrix, 3> turn_matrices();

}  // namespace condyle::surrogate
