// SPDX-License-Identifier: Apache-2.0
// Continuation from an equilibrium that is known to one that is not: in substeps of what changes
// between them, which halve where one fails and double where one is found.
#pragma once

#include <algorithm>

namespace condyle::fdk {

struct Substeps {
  int taken = 0;         ///< equilibria found on the way, the goal's included
  bool reached = false;  ///< the goal
};

/// @param max_substeps the smallest substep is 1/max_substeps of the way; at least 1.
/// @param solve_at bool(double t), 0 < t ≤ 1: the equilibrium at t, from the last one found; t is 1
/// exactly at the goal.
template <typename SolveAt>
Substeps go_in_substeps(int max_substeps, SolveAt&& solve_at) {
  Substeps done;
  double here = 0.0, step = 0.5;
  while (here < 1.0) {
    const double t = std::min(1.0, here + step);
    if (solve_at(t)) {
      here = t;
      step *= 2.0;
      ++done.taken;
    } else if ((step = 0.5 * (t - here)) * max_substeps < 1.0) {
      return done;
    }
  }
  done.reached = true;
  return done;
}

}  // namespace condyle::fdk
