// SPDX-License-Identifier: Apache-2.0
// What is asked of muscle recruitment: sharing known generalised loads over more muscles than equations.
//
//   min Σ_i w_i (f_i/N_i)^p + Σ_j c_j |e_j/S_j|^p     subject to   R f + e = τ,   l_i ≤ f_i ≤ N_i
//
// | symbol | what | shape, unit |
// |---|---|---|
// | R | moment arms: generalised force on a coordinate per unit of muscle force | n × m [m, or - for a translation] |
// | τ | loads that muscles balance | n [Nm, N] |
// | f, N, l | muscle forces, strengths, passive minima (0 where none) | m [N] |
// | e, S, c | reserve actuators, one a coordinate: generalised force (signed, unbounded), strength, price | n |
// | w | weights | m [-] |
//
// p = 1 is a linear program. p > 1 has one solution. Min–max is the limit p → ∞, taken lexicographically: the largest
// w_i f_i/N_i (and c_j |e_j|/S_j) is made as small as it can be, those that must be that large are held there, the
// largest of the rest is made as small as it can be, and so on. With upper_bounds off, f may exceed N.
//
// A muscle of zero strength carries nothing, whether or not there are upper bounds.
//
// Sources: [Crowninshield & Brand 1981] J Biomech 14:793 (powers); [Rasmussen, Damsgaard & Voigt 2001] J Biomech 34:409
// (min–max and its relation to powers); [Damsgaard et al. 2006] Simul Model Pract Theory 14:1100 (ties).
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::recruitment {

/// Row-major, so that its memory is `moment_arms[coordinate][muscle]` for a NumPy reader.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

/// Most coordinates balanced by muscles: a whole body's fifty joints' worth. Small matrices then need no heap.
inline constexpr int kMaxCoordinates = 64;

/// What is made small. `exponent` is p ≥ 1; it has no meaning where `min_max` is set.
struct Criterion {
  bool min_max = false;
  double exponent = 3.0;  ///< 3: largest endurance after Crowninshield & Brand 1981
};

struct RecruitmentSettings {
  Criterion criterion;
  bool upper_bounds = true;   ///< f ≤ N
  int max_iterations = 200;   ///< Newton steps of p > 1; 5–12 is usual
  double tolerance = 1e-9;    ///< largest scaled KKT residual of a converged result; 1e-14 is usual
};

/// What does not change from time frame to time frame.
struct RecruitmentSetup {
  int coordinates = 0;                        ///< 1 ≤ n ≤ kMaxCoordinates
  int muscles = 0;                            ///< m ≥ 1
  std::vector<std::string> coordinate_names;  ///< n, or empty: "coordinate 3"; for messages
  std::vector<std::string> muscle_names;      ///< m, or empty: "muscle 12"; for messages
  Vector weights;            ///< m > 0 [-], or empty: all 1
  Vector reserve_strengths;  ///< n ≥ 0 [Nm, N], 0: no reserve on that coordinate; or empty: none at all
  Vector reserve_prices;     ///< n > 0 [-], or empty: all 1

  /// Name of coordinate j or muscle i, 0-based, as messages say it.
  std::string coordinate_name(int j) const;
  std::string muscle_name(int i) const;
};

/// One time frame. Views: what they look at must outlive the call they are given to.
struct RecruitmentFrame {
  Eigen::Ref<const RowMatrix> moment_arms;  ///< (n, m)
  Eigen::Ref<const Vector> loads;           ///< (n) [Nm, N]
  Eigen::Ref<const Vector> strengths;       ///< (m) [N]
  Eigen::Ref<const Vector> minima;          ///< (m) [N], or of size 0: all 0
};

enum class RecruitmentStatus {
  kConverged,
  kInfeasible,     ///< no muscle forces within their bounds carry the loads
  kMaxIterations,  ///< not to the tolerance within the iterations allowed
};

std::string_view name(RecruitmentStatus status);
/// One sentence: what happened, and what the user can do next.
std::string_view advice(RecruitmentStatus status);

/// @throws std::invalid_argument naming the field, the muscle or coordinate, the value and the limit.
void require_valid(const RecruitmentSetup& setup, const RecruitmentSettings& settings);

/// @throws std::invalid_argument where shapes do not fit the setup, a value is not finite, a strength or a minimum is
///   negative, or a minimum exceeds the strength that bounds it.
void require_valid(const RecruitmentFrame& frame, const RecruitmentSetup& setup,
                   const RecruitmentSettings& settings);

}  // namespace condyle::recruitment
