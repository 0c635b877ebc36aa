// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/scaled_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle::recruitment {

ScaledProblem::ScaledProblem(const RecruitmentSetup& setup, const RecruitmentSettings&)
    : n(setup.coordinates),
      m(setup.muscles),
      A(RowMatrix::Zero(n, m)),
      b(Vector::Zero(n)),
      lower(Vector::Zero(m)),
      upper(Vector::Zero(m)),
      weight(setup.weights.size() ? setup.weights : Vector::Ones(m)),
      reserve(Vector::Zero(n)),
      price(setup.reserve_prices.size() ? setup.reserve_prices : Vector::Ones(n)),
      strengths(Vector::Zero(m)),
      row_scale(Vector::Ones(n)),
      reserve_strengths_(setup.reserve_strengths.size() ? setup.reserve_strengths : Vector::Zero(n)) {
  weight_scale = weight.maxCoeff();
  weight /= weight_scale;
  price /= weight_scale;
  has_reserves = reserve_strengths_.maxCoeff() > 0.0;
}

void ScaledProblem::set_frame(const RecruitmentFrame& frame, bool upper_bounds) {
  strengths = frame.strengths;
  for (int j = 0; j < n; ++j) {
    A.row(j) = frame.moment_arms.row(j).cwiseProduct(strengths.transpose());
    double largest = A.row(j).cwiseAbs().maxCoeff();
    if (!(largest > 0.0)) largest = reserve_strengths_[j];
    row_scale[j] = largest > 0.0 ? 1.0 / largest : 1.0;
    A.row(j) *= row_scale[j];
    b[j] = row_scale[j] * frame.loads[j];
    reserve[j] = row_scale[j] * reserve_strengths_[j];
  }
  load_scale = b.cwiseAbs().maxCoeff();
  lower.setZero();
  if (frame.minima.size() > 0) {
    for (int i = 0; i < m; ++i) {
      if (strengths[i] > 0.0) lower[i] = frame.minima[i] / strengths[i];
    }
    // Passive forces may be all there is to balance.
    for (int j = 0; j < n; ++j) load_scale = std::max(load_scale, std::abs(A.row(j).dot(lower)));
  }
  if (!(load_scale > 0.0)) load_scale = 1.0;
  b /= load_scale;
  lower /= load_scale;
  const double full = upper_bounds ? 1.0 / load_scale : std::numeric_limits<double>::infinity();
  for (int i = 0; i < m; ++i) upper[i] = strengths[i] > 0.0 ? std::max(full, lower[i]) : 0.0;
}

double ScaledProblem::multiplier_scale(int j, double exponent) const {
  return row_scale[j] * weight_scale * std::pow(load_scale, exponent - 1.0);
}

}  // namespace condyle::recruitment
