// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/surrogate/potential.hpp"
#include "support/random_pose.hpp"

using namespace condyle::surrogate;
using namespace condyle;
using condyle::test::Draw;

namespace {

DenseLayer layer(Draw& draw, int inputs, int outputs, double range) {
  DenseLayer made{inputs, outputs, {}, {}};
  for (int i = 0; i < inputs * outputs; ++i) made.weight.push_back(draw(-range, range));
  for (int i = 0; i < outputs; ++i) made.bias.push_back(draw(-range, range));
  return made;
}

PotentialSide side(Draw& draw, const std::vector<int>& hidden, double scale, double power) {
  PotentialSide made;
  int inputs = 6;
  for (const int width : hidden) {
    made.layers.push_back(layer(draw, inputs, width, 0.7));
    inputs = width;
  }
  made.layers.push_back(layer(draw, inputs, 1, 0.9));
  for (std::size_t i = 0; i < 6; ++i) {
    made.steepness[i] = draw(-0.5, 0.5);
    for (std::size_t j = i; j < 6; ++j) {
      made.curvature[6 * i + j] = made.curvature[6 * j + i] = draw(-0.3, 0.3);
    }
  }
  made.exponent = power - 2.0;
  made.force_factor = -scale * power;
  made.curve_factor = made.force_factor * (power - 1.0);
  return made;
}

/// N, written out in full.
double depth_of(const PotentialSide& side, const Pose& pose) {
  std::vector<double> x(pose.begin(), pose.end());
  for (const DenseLayer& one : side.layers) {
    std::vector<double> y = one.bias;
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < y.size(); ++j) y[j] += x[i] * one.weight[i * y.size() + j];
    }
    if (&one != &side.layers.back()) {
      for (double& value : y) value = std::tanh(value);
    }
    x = y;
  }
  double depth = x[0];
  for (Eigen::Index i = 0; i < 6; ++i) {
    depth += side.steepness[static_cast<std::size_t>(i)] * pose[i];
    for (Eigen::Index j = 0; j < 6; ++j) {
      depth += 0.5 * side.curvature[static_cast<std::size_t>(6 * i + j)] * pose[i] * pose[j];
    }
  }
  return depth;
}

double energy_of(const PotentialSide& side, const Pose& pose) {
  const double power = side.exponent + 2.0;
  return -side.force_factor / power * std::pow(std::max(depth_of(side, pose), 0.0), power);
}

Pose random_pose(Draw& draw) {
  Pose pose;
  for (int i = 0; i < 6; ++i) pose[i] = draw(-1.2, 1.2);
  return pose;
}

struct Loads {
  Vector6 wrench;
  Matrix6 stiffness;
};

Loads loads_of(const Potential& potential, const Pose& pose, Side side) {
  DenseWorkspace workspace;
  std::array<double, 12> wrench;
  std::array<double, 72> stiffness;
  potential.evaluate({&pose, 1}, workspace, wrench.data(), stiffness.data());
  using RowMajor = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  return {Eigen::Map<const Vector6>(&wrench[6 * static_cast<std::size_t>(side)]),
          Eigen::Map<const RowMajor>(&stiffness[36 * static_cast<std::size_t>(side)])};
}

}  // namespace

TEST_CASE("the generalised force is the energy's gradient, in every power and depth [derivative]") {
  Draw draw(21);
  for (const std::vector<int>& hidden :
       {std::vector{9}, std::vector{9, 5}, std::vector{9, 12, 7}}) {
    const std::array sides{side(draw, hidden, 3.5, 3.0), side(draw, hidden, 2.5, 2.7)};
    const Potential potential(sides);
    int loaded = 0, lifted = 0;
    for (int n = 0; n < 40; ++n) {
      const Pose pose = random_pose(draw);
      for (const Side which : {kMedial, kLateral}) {
        const Loads loads = loads_of(potential, pose, which);
        if (depth_of(sides[which], pose) <= 0.0) {
          CHECK(loads.wrench == Vector6::Zero());
          CHECK(loads.stiffness == Matrix6::Zero());
          ++lifted;
          continue;
        }
        ++loaded;
        const Vector6 force = generalised_force(pose, loads.wrench);
        const Matrix6 matrix = generalised_stiffness(pose, loads.wrench, loads.stiffness);
        // Symmetric to rounding: R and its inverse, entries to 8, come and go.
        CHECK((matrix - matrix.transpose()).cwiseAbs().maxCoeff() <=
              1e-12 * matrix.cwiseAbs().maxCoeff());
        for (int j = 0; j < 6; ++j) {
          Pose after = pose, before = pose;
          after[j] += 1e-5;
          before[j] -= 1e-5;
          const double slope =
              (energy_of(sides[which], after) - energy_of(sides[which], before)) / 2e-5;
          // Rounding ε·100/1e-5, truncation 1e-10/6 of third derivatives of some hundreds.
          CHECK(std::abs(force[j] + slope) <= 1e-7);
          if (depth_of(sides[which], pose) < 0.01) continue;
          const Vector6 difference = (loads_of(potential, after, which).wrench -
                                      loads_of(potential, before, which).wrench) /
                                     2e-5;
          CHECK((loads.stiffness.col(j) - difference).norm() <= 1e-6 * (1.0 + difference.norm()));
        }
      }
    }
    CHECK(loaded > 8);
    CHECK(lifted > 3);
  }
}

TEST_CASE("no work is done around a closed path, through lift-off too [property]") {
  Draw draw(33);
  const std::array sides{side(draw, {11, 6}, 3.5, 2.5), side(draw, {11, 6}, 2.5, 3.0)};
  const Potential potential(sides);
  // A circle through the six coordinates; the trapezoid rule on n points of a smooth loop is exact
  // but for the kink in the second derivative at lift-off: O(1/n³).
  constexpr int kPoints = 4000;
  double work = 0.0, path = 0.0;
  int changes = 0;
  bool was_loaded = false;
  for (int n = 0; n < kPoints; ++n) {
    const double t = 2.0 * 3.14159265358979323846 * n / kPoints;
    Pose pose, velocity;
    for (int i = 0; i < 6; ++i) {
      const int harmonic = 1 + i % 2;
      pose[i] = (0.9 - 0.1 * i) * std::sin(harmonic * t + 0.7 * i) + 0.05 * i;
      velocity[i] = (0.9 - 0.1 * i) * harmonic * std::cos(harmonic * t + 0.7 * i);
    }
    const Vector6 force = generalised_force(pose, loads_of(potential, pose, kMedial).wrench);
    work += force.dot(velocity) / kPoints;
    path += std::abs(force.dot(velocity)) / kPoints;
    const bool loaded = force.norm() > 0.0;
    changes += n > 0 && loaded != was_loaded;
    was_loaded = loaded;
  }
  CHECK(changes >= 2);
  CHECK(path > 0.1);
  CHECK(std::abs(work) <= 1e-8 * path);
}

TEST_CASE("a pose is the same bytes alone, in a batch, with stiffness and without [property]") {
  Draw draw(8);
  const std::array sides{side(draw, {30, 30, 30}, 3.5, 3.0), side(draw, {17, 9, 25}, 2.5, 2.5)};
  std::vector<double> of_best;
  for (const DenseKernels& kernels : all_dense_kernels()) {
    const Potential potential(sides, kernels);
    const std::size_t n = potential.max_poses(true);
    CHECK(n == potential.max_poses(false));
    std::vector<Pose> poses(n);
    for (Pose& pose : poses) pose = random_pose(draw);
    DenseWorkspace workspace;
    std::vector<double> wrench(12 * n), stiffness(72 * n), alone(12 * n);
    potential.evaluate(poses, workspace, wrench.data(), stiffness.data());
    potential.evaluate(poses, workspace, alone.data(), nullptr);
    CHECK(wrench == alone);
    int differing = 0;
    for (std::size_t i = 0; i < n; ++i) {
      std::array<double, 12> one;
      std::array<double, 72> matrix;
      potential.evaluate({&poses[i], 1}, workspace, one.data(), matrix.data());
      differing += std::memcmp(one.data(), &wrench[12 * i], sizeof one) != 0;
      differing += std::memcmp(matrix.data(), &stiffness[72 * i], sizeof matrix) != 0;
    }
    CHECK(differing == 0);
  }
}

TEST_CASE("the instruction sets agree [property]") {
  Draw draw(9);
  const std::array sides{side(draw, {30, 30, 30}, 3.5, 3.0), side(draw, {30, 30, 30}, 2.5, 2.5)};
  std::vector<Pose> poses(20);
  for (Pose& pose : poses) pose = random_pose(draw);
  std::vector<double> first;
  for (const DenseKernels& kernels : all_dense_kernels()) {
    const Potential potential(sides, kernels);
    DenseWorkspace workspace;
    std::vector<double> values(84 * poses.size());
    potential.evaluate(poses, workspace, values.data(), values.data() + 12 * poses.size());
    if (first.empty()) first = values;
    double worst = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      worst = std::max(worst, std::abs(values[i] - first[i]));
      largest = std::max(largest, std::abs(first[i]));
    }
    CHECK(largest > 1.0);
    CHECK(worst <= 1e-12 * largest);
  }
}

TEST_CASE("what is not a number is never taken for no contact [property]") {
  Draw draw(10);
  const std::array sides{side(draw, {9, 5}, 3.5, 3.0), side(draw, {9, 5}, 2.5, 2.7)};
  Pose pose = random_pose(draw);
  pose[2] = std::nan("");
  const Loads loads = loads_of(Potential(sides), pose, kMedial);
  CHECK(loads.wrench.array().isNaN().all());
}

TEST_CASE("energies of other sizes and powers are refused [error]") {
  Draw draw(4);
  const PotentialSide good = side(draw, {9, 5}, 3.5, 3.0);
  CHECK_NOTHROW(Potential({good, good}));
  PotentialSide bad = good;
  bad.exponent = 0.0;
  CHECK_THROWS_WITH_AS(Potential({good, bad}),
                       "potential surrogate: exponent 0.000000 must be positive",
                       std::invalid_argument);
  bad = good;
  bad.layers.pop_back();
  CHECK_THROWS_WITH_AS(Potential({good, bad}),
                       "potential surrogate: a network must be 6 to 1, with a hidden layer",
                       std::invalid_argument);
  bad = side(draw, std::vector<int>(20, 128), 3.5, 3.0);
  CHECK_THROWS_WITH_AS(Potential({good, bad}),
                       "potential surrogate: 20 hidden layers of 128 neurons are more than the "
                       "fused runtime has memory for",
                       std::invalid_argument);
}
