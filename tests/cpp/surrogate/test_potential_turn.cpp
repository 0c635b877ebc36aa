// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>

#include "condyle/common/pose.hpp"
#include "condyle/surrogate/potential_turn.hpp"
#include "support/random_pose.hpp"

using namespace condyle::surrogate;
using condyle::Matrix6;
using condyle::Pose;
using condyle::Vector6;

namespace {

/// R or a derivative of it at a pose, from the constants.
Matrix6 matrix_at(const TurnMatrix& coefficients, const Pose& pose) {
  const auto multiples = turn_multiples(), phases = turn_phases();
  const double square = std::pow(std::cos(pose[4]), 2);
  Matrix6 matrix;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      double sum = coefficients[i][j][0];
      for (std::size_t s = 0; s < kTurnSines; ++s) {
        double angle = phases[s];
        for (std::size_t k = 0; k < 6; ++k) {
          angle += multiples[k * kTurnSines + s] * pose[static_cast<Eigen::Index>(k)];
        }
        sum += coefficients[i][j][1 + s] * std::sin(angle) / square;
      }
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = sum;
    }
  }
  return matrix;
}

}  // namespace

TEST_CASE("the constants are those of the wrench of a generalised force [oracle]") {
  condyle::test::Draw draw(6);
  const auto matrices = turn_matrices();
  for (int n = 0; n < 20; ++n) {
    Pose pose;
    Vector6 force;
    for (int i = 0; i < 6; ++i) {
      pose[i] = draw(-1.1, 1.1);
      force[i] = draw(-3.0, 3.0);
    }
    const Vector6 expected = condyle::wrench_from_generalised_force(pose, force);
    // Entries up to 1/cos²(1.1) = 5, sums of six with forces of 3.
    CHECK((matrix_at(matrices[0], pose) * force - expected).norm() <= 1e-13);
    for (const int angle : {3, 4}) {
      Pose after = pose, before = pose;
      after[angle] += 1e-5;
      before[angle] -= 1e-5;
      const Matrix6 difference =
          (matrix_at(matrices[0], after) - matrix_at(matrices[0], before)) / 2e-5;
      const Matrix6 derivative = matrix_at(matrices[static_cast<std::size_t>(angle - 2)], pose);
      // Rounding 1e-15/1e-5; truncation h²/6 times third derivatives of up to a few hundred.
      CHECK((derivative - difference).norm() <= 2e-8);
      CHECK(derivative.norm() > 0.1);
    }
  }
}
