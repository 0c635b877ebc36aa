// SPDX-License-Identifier: Apache-2.0
#include "condyle/common/pose.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>

#include "support/random_pose.hpp"

using namespace condyle;

namespace {

Matrix3 about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// The axial vector of dR·Rᵀ, by central differences along one coordinate.
Vector3 angular_rate(const Pose& pose, int coordinate, double step) {
  Pose ahead = pose, behind = pose;
  ahead[coordinate] += step;
  behind[coordinate] -= step;
  const Matrix3 W =
      (rotation_TF(ahead) - rotation_TF(behind)) / (2.0 * step) * rotation_TF(pose).transpose();
  return {W(2, 1), W(0, 2), W(1, 0)};
}

}  // namespace

TEST_CASE("the rotation is the intrinsic z-y-x sequence from femur to tibia [oracle]") {
  test::Draw draw(11);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose pose = test::general_pose(draw);
    const Matrix3 R_FT = about(Vector3::UnitZ(), pose[kThetaZ]) *
                         about(Vector3::UnitY(), pose[kThetaY]) *
                         about(Vector3::UnitX(), pose[kThetaX]);
    CHECK((rotation_TF(pose) - R_FT.transpose()).norm() < 1e-14);
  }
}

TEST_CASE("a placement gives back its pose [property]") {
  test::Draw draw(12);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose pose = test::general_pose(draw, 1.5);
    CHECK((pose_from_transform(transform_TF(pose)) - pose).norm() < 1e-12);
  }
}

TEST_CASE("at θy = ±π/2 the pose found still gives the same rotation [property]") {
  test::Draw draw(13);
  for (const double sign : {-1.0, 1.0}) {
    Pose pose = test::general_pose(draw);
    pose[kThetaY] = sign * std::acos(-1.0) / 2.0;
    const RigidTransform X_TF = transform_TF(pose);
    CHECK((rotation_TF(pose_from_transform(X_TF)) - X_TF.R).norm() < 1e-9);
  }
}

TEST_CASE("the twist map's angular columns are the rotation's rates [derivative]") {
  test::Draw draw(14);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose pose = test::general_pose(draw);
    const Matrix6 G = twist_map(pose);
    for (int j = kThetaX; j <= kThetaZ; ++j) {
      // Central differences with h = 1e-5: truncation ~ h²/6 = 2e-11, rounding ~ 1e-16/h = 1e-11.
      CHECK((G.col(j).tail<3>() - angular_rate(pose, j, 1e-5)).norm() < 1e-9);
    }
  }
}

TEST_CASE("the generalised force is the power's gradient, as design's formulas say [oracle]") {
  test::Draw draw(15);
  const Pose pose = test::general_pose(draw);
  const Wrench w = test::general_wrench(draw);
  const double sx = std::sin(pose[3]), cx = std::cos(pose[3]);
  const double sy = std::sin(pose[4]), cy = std::cos(pose[4]);
  Vector6 expected;
  expected << w[0], w[1], w[2], -w[3], -cx * w[4] + sx * w[5],
      sy * w[3] - cy * sx * w[4] - cy * cx * w[5];
  CHECK((generalised_force(pose, w) - expected).norm() < 1e-12 * w.norm());
  CHECK((wrench_from_generalised_force(pose, expected) - w).norm() < 1e-12 * w.norm());
}

TEST_CASE("the generalised stiffness is the derivative of the generalised force [derivative]") {
  test::Draw draw(16);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose pose = test::general_pose(draw);
    const Wrench w0 = test::general_wrench(draw);
    Matrix6 S;
    for (int i = 0; i < 36; ++i) S.data()[i] = draw(-2e3, 2e3);
    const auto force = [&](const Pose& p) { return generalised_force(p, w0 + S * (p - pose)); };
    const Matrix6 K = generalised_stiffness(pose, w0, S);
    Matrix6 K_difference;
    const double h = 1e-5;
    for (int j = 0; j < 6; ++j) {
      Pose ahead = pose, behind = pose;
      ahead[j] += h;
      behind[j] -= h;
      K_difference.col(j) = (force(ahead) - force(behind)) / (2.0 * h);
    }
    // Rounding: |Q| eps / h ~ 1e3·2e-16/1e-5 = 2e-8 per entry, on entries of 1e3.
    CHECK((K - K_difference).norm() < 1e-9 * K.norm());
    CHECK((stiffness_from_generalised(pose, w0, K) - S).norm() < 1e-12 * S.norm());
  }
}
