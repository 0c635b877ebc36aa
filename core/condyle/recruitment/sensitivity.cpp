// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/sensitivity.hpp"

namespace condyle::recruitment {
namespace {

// In a usual curvature: far below what a muscle between its bounds gives, far above rounding.
constexpr double kLeastShift = 1e-14;
// Where the muscles that are free do not span all coordinates.
constexpr double kSingularShift = 1e-8;

}  // namespace

Sensitivity::Sensitivity(int n, int m, bool graded)
    : n_(n),
      m_(m),
      direction_(n, m, graded ? NewtonDirection::Method::kGraded : NewtonDirection::Method::kNormal),
      usual_(n),
      rows_(n),
      dlambda_(n),
      dy_(n),
      fixed_(m),
      dz_(m),
      dx_(m),
      own_(m),
      dA_(n, m) {}

void Sensitivity::at_power(const ScaledProblem& problem, const Vector& x, const Vector& multipliers,
                           const Vector& slope, const Vector& reserve_slope) {
  problem_ = &problem;
  x_ = &x;
  multipliers_ = &multipliers;
  slope_ = &slope;
  reserve_slope_ = &reserve_slope;
  system_ = nullptr;
  // Of a row whose muscles were all free, with the mean slope of those that are.
  double mean = slope.sum() / static_cast<double>(m_);
  if (!(mean > 0.0)) mean = 1.0;
  for (int j = 0; j < n_; ++j) {
    usual_[j] = mean * problem.A.row(j).squaredNorm();
    if (!(usual_[j] > 0.0)) usual_[j] = mean;
  }
  regular_ = direction_.factorise(problem, slope, reserve_slope, usual_, kLeastShift) &&
             direction_.regular(usual_, kLeastShift);
  if (!regular_) direction_.factorise(problem, slope, reserve_slope, usual_, kSingularShift);
}

void Sensitivity::at_linear(const ScaledProblem& problem, const Vector& x, ActiveSystem& system) {
  problem_ = &problem;
  x_ = &x;
  system_ = &system;
  regular_ = system.determined() && system.unknowns() == n_;
}

// dA = s (dR N + R dN), and what becomes of x where the force is held at a passive minimum: f stays, x = f/N does not.
void Sensitivity::changed_columns(const Eigen::Ref<const RowMatrix>& moment_arms,
                                  const Eigen::Ref<const Vector>& strengths) {
  const ScaledProblem& s = *problem_;
  for (int i = 0; i < m_; ++i) {
    const bool grows = strengths.size() > 0 && s.strengths[i] > 0.0;
    own_[i] = grows ? strengths[i] / s.strengths[i] : 0.0;
    fixed_[i] = (*x_)[i] > 0.0 && (*x_)[i] == s.lower[i] ? -(*x_)[i] * own_[i] : 0.0;
  }
  for (int j = 0; j < n_; ++j) {
    dA_.row(j) = s.A.row(j).cwiseProduct(own_.transpose());
    if (moment_arms.rows() > 0) {
      dA_.row(j) += s.row_scale[j] * moment_arms.row(j).cwiseProduct(s.strengths.transpose());
    }
  }
}

// dx and dy of p > 1 for the right-hand side in rows_.
void Sensitivity::answer_power() {
  const ScaledProblem& s = *problem_;
  dx_.setZero();
  for (int j = 0; j < n_; ++j) dx_ += (*multipliers_)[j] * dA_.row(j).transpose();
  dx_.array() *= slope_->array();
  for (int j = 0; j < n_; ++j) rows_[j] -= s.A.row(j).dot(dx_);
  direction_.solve(rows_, dlambda_, dz_);
  dx_.array() += slope_->array() * dz_.array();
  dy_ = s.reserve.cwiseProduct(*reserve_slope_).cwiseProduct(dlambda_);
}

void Sensitivity::along(const Eigen::Ref<const Vector>& loads,
                        const Eigen::Ref<const RowMatrix>& moment_arms,
                        const Eigen::Ref<const Vector>& strengths, Eigen::Ref<Vector> forces,
                        Eigen::Ref<Vector> reserves) {
  const ScaledProblem& s = *problem_;
  const bool moved = moment_arms.rows() > 0 || strengths.size() > 0;
  for (int j = 0; j < n_; ++j) rows_[j] = s.row_scale[j] * loads[j] / s.load_scale;
  if (moved) {
    changed_columns(moment_arms, strengths);
    for (int j = 0; j < n_; ++j) {
      rows_[j] -= dA_.row(j).dot(*x_) + s.A.row(j).dot(fixed_);
    }
  } else {
    dA_.setZero();
    own_.setZero();
    fixed_.setZero();
  }
  if (system_ != nullptr) {
    system_->solve(rows_, dx_, dy_);
  } else {
    answer_power();
  }
  dx_ += fixed_ + x_->cwiseProduct(own_);
  forces = s.load_scale * s.strengths.cwiseProduct(dx_);
  for (int j = 0; j < n_; ++j) {
    reserves[j] = s.load_scale / s.row_scale[j] * s.reserve[j] * dy_[j];
  }
}

}  // namespace condyle::recruitment
