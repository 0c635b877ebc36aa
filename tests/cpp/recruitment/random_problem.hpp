// SPDX-License-Identifier: Apache-2.0
// Feasible recruitment problems with a leg's numbers: strengths 50–3 000 N, arms to 60 mm, three coordinates a muscle.
#pragma once

#include <cmath>

#include "condyle/recruitment/recruitment.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

using recruitment::RowMatrix;
using recruitment::Vector;

struct RandomProblem {
  RowMatrix moment_arms;
  Vector loads, strengths, minima;
  recruitment::RecruitmentSetup setup;

  recruitment::RecruitmentFrame frame() const { return {moment_arms, loads, strengths, minima}; }
};

inline RandomProblem random_problem(std::uint64_t seed, bool reserves, bool minima, int n = 7, int m = 43) {
  Draw draw(seed);
  RandomProblem p;
  p.setup.coordinates = n;
  p.setup.muscles = m;
  p.moment_arms = RowMatrix::Zero(n, m);
  p.strengths.resize(m);
  p.minima.resize(minima ? m : 0);
  p.setup.weights.resize(m);
  Vector forces(m);
  for (int i = 0; i < m; ++i) {
    p.strengths[i] = std::exp(draw(std::log(50.0), std::log(3000.0)));
    p.setup.weights[i] = draw(0.6, 1.7);
    forces[i] = p.strengths[i] * std::max(0.0, draw(-0.5, 0.8));
    if (minima) {
      p.minima[i] = i % 4 == 1 ? draw(0.02, 0.08) * p.strengths[i] : 0.0;
      forces[i] = std::max(forces[i], p.minima[i]);
    }
    for (int k = 0; k < 3; ++k) p.moment_arms((i + k) % n, i) = draw(-0.06, 0.06);
  }
  p.loads = p.moment_arms * forces;
  if (reserves) {
    p.setup.reserve_strengths = Vector::Constant(n, 11.0);
    p.setup.reserve_strengths[n / 2] = 0.0;
    p.setup.reserve_prices = Vector::Constant(n, 7.0);
  }
  return p;
}

inline recruitment::RecruitmentSettings settings(double p, bool upper_bounds = true) {
  recruitment::RecruitmentSettings s;
  s.criterion.min_max = std::isinf(p);
  s.criterion.exponent = std::isinf(p) ? 3.0 : p;
  s.upper_bounds = upper_bounds;
  return s;
}

}  // namespace condyle::test
