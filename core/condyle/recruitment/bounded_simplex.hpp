// SPDX-License-Identifier: Apache-2.0
// Linear programs with few equations and bounds on all variables, by the primal simplex method.
//
//   min cᵀv   subject to   G v = b,   l ≤ v ≤ u
//
// Each equation has a logical variable with bounds [0, 0]; from them, or from the basis of a problem like it, the sum of
// violated bounds is made small first. Where it stays positive there is no solution, and the multipliers π prove it:
//
//   πᵀb − Σ_j max(l_j, u_j by sign) (Gᵀπ)_j = the sum of violations > 0
//
// From logicals that sum is Σ_j |b − G v|_j, so violations gather in as few equations as can be.
// Largest reduced cost, Bland's rule while steps are degenerate: deterministic, and it ends. The basis's inverse is dense and
// made afresh now and then. No allocation after construction.
#pragma once

#include <cstdint>
#include <vector>

#include "condyle/recruitment/problem.hpp"

namespace condyle::recruitment {

/// n equations, k variables.
struct LinearProgram {
  LinearProgram(int n, int k);
  RowMatrix G;          ///< (n, k), entries of order one
  Vector b;             ///< (n), of order one
  Vector cost;          ///< (k)
  Vector lower, upper;  ///< (k); upper may be infinite
};

class BoundedSimplex {
 public:
  BoundedSimplex(int n, int k);

  enum class Outcome { kOptimal, kInfeasible, kUnbounded, kMaxIterations };

  /// Forgets the basis: the next call starts from the logicals.
  void forget();
  /// Starts from the basis of the last call where it still is one.
  Outcome solve(const LinearProgram& program);
  /// As solve, without the cost: kOptimal is feasible.
  Outcome find_feasible(const LinearProgram& program);

  Vector values;         ///< (k) v
  Vector multipliers;    ///< (n) π; the proof where infeasible
  double infeasibility = 0;  ///< sum of violated bounds
  int iterations = 0;        ///< of the last call
  /// (n) variables that are not at a bound; k + j is the logical of equation j.
  std::vector<int> basis;
  std::vector<std::uint8_t> at_upper;  ///< (k) of the others: 1 at their upper bound

 private:
  Outcome run(const LinearProgram& program, bool with_cost);
  bool invert();
  void basic_values();
  bool set_costs(bool with_cost);
  int entering(bool with_cost, bool bland, double& direction) const;
  void column(int j);
  int leaving(double direction, bool bland, double& length, bool& to_upper) const;
  void pivot(int row, int entering_column, bool to_upper);
  void finish();
  double lower(int j) const { return j < k_ ? program_->lower[j] : 0.0; }
  double upper(int j) const { return j < k_ ? program_->upper[j] : 0.0; }

  const LinearProgram* program_ = nullptr;
  int n_, k_;
  bool violated_ = false;
  std::vector<std::uint8_t> is_basic_;
  Eigen::MatrixXd matrix_, inverse_;
  Vector basic_, cost_, column_, rows_, reduced_;
};

}  // namespace condyle::recruitment
