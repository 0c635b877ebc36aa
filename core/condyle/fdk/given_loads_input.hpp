// SPDX-License-Identifier: Apache-2.0
// What a knee's equilibrium is found from when a simulator of one's own has done the rest: loads, moment arms and strengths
// of a time frame. No body model is needed.
//
// | symbol | what | shape, unit |
// |---|---|---|
// | α | secondary coordinates of the pose: x, y, z, θx, θy (kSecondary) | 5 [m, rad] |
// | τ | loads that muscles balance, a coordinate each: what joints must give, as inverse dynamics says it | n [Nm, N] |
// | τ_s | the same on α: the intersegmental load, muscles, ligaments and contact NOT taken off | 5 [N, Nm] |
// | W | an intersegmental wrench on the femur, at Fo, in T, that joins τ_s as Gᵀ W; one of both is enough | 6 [N, Nm] |
// | R, R_s | moment arms r = −∂L/∂q about the n coordinates and about α, the others of them held | n × m, 5 × m |
// | N, l | strengths and passive minima | m [N] |
//
// r is the generalised force of 1 N: about y it is −1 for a muscle that pulls the femur straight down. Moment arms about
// α at θz held, and about knee flexion at α held: an arm about flexion that includes coupled secondary motion must be
// taken apart first. Arms are constant over the small secondary motion, or linear in it:
//   R(α) = R + Σ_j (α_j − a_j) ∂R/∂α_j.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"
#include "condyle/contact/contact_model.hpp"
#include "condyle/fdk/knee_loads.hpp"
#include "condyle/model/ligament.hpp"
#include "condyle/recruitment/problem.hpp"

namespace condyle::fdk {

/// The unknowns, in their order.
inline constexpr std::array<int, 5> kSecondary{kX, kY, kZ, kThetaX, kThetaY};
using Secondary = Eigen::Matrix<double, 5, 1>;

/// What does not change from time frame to time frame.
struct GivenLoadsSetup {
  SideOfBody side_of_body = SideOfBody::kRight;  ///< of the loads; must be the contact model's
  recruitment::RecruitmentSetup muscles;  ///< names, weights and reserves of n coordinates, m muscles
  /// Which of the n is knee flexion: contact and ligaments act on it, too. −1: none is.
  int knee_coordinate = -1;
  /// Whether it counts flexion positive, as −θz, or extension, as θz.
  bool knee_counts_flexion = true;
  std::vector<model::Ligament> ligaments;  ///< between F and T
  /// Springs on x, z and θy for soft tissue that the ligaments leave out; a reference that is not set counts as 0.
  std::optional<RestraintSprings> restraint;

  /// d(knee coordinate)/dθz.
  double knee_sign() const { return knee_counts_flexion ? -1.0 : 1.0; }
};

/// One time frame.
struct GivenLoadsFrame {
  double flexion = 0.0;                           ///< −θz [rad]
  recruitment::Vector loads;                      ///< τ (n)
  Secondary secondary_loads = Secondary::Zero();  ///< τ_s
  Wrench wrench = Wrench::Zero();                 ///< W
  recruitment::RowMatrix moment_arms;             ///< R (n, m)
  recruitment::RowMatrix secondary_arms;          ///< R_s (5, m)
  recruitment::Vector strengths;                  ///< N (m)
  recruitment::Vector minima;                     ///< l (m), or of size 0: all 0
  /// ∂(R; R_s)/∂α_j, one (n + 5, m) block below another for j = 0 … 4; no rows: constant arms.
  recruitment::RowMatrix arms_by_pose;
  Secondary arms_at = Secondary::Zero();  ///< a: where R and R_s hold; used with arms_by_pose only
};

/// @throws std::invalid_argument naming the field, its value and the limit; so where the contact model is of the other
///   side of the body.
void require_valid(const GivenLoadsSetup& setup, const contact::ContactModel& contact);
/// @throws std::invalid_argument for a shape that does not fit the setup or a value that is not finite, after
///   "time frame 12: ". What recruitment checks itself is left to it.
void require_valid(const GivenLoadsFrame& frame, const GivenLoadsSetup& setup, std::size_t index);

/// (1 − t) a + t b in every field. @pre both have the same shapes.
GivenLoadsFrame between(const GivenLoadsFrame& a, const GivenLoadsFrame& b, double t);

/// The frame without its loads: τ, τ_s and W are nil; where continuation begins.
GivenLoadsFrame unloaded(const GivenLoadsFrame& frame);

}  // namespace condyle::fdk
