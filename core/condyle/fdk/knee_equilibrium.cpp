// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/knee_equilibrium.hpp"

#include <array>

namespace condyle::fdk {
namespace {

constexpr std::array<std::string_view, 6> kCoordinates{"x",       "y",       "z",
                                                       "theta_x", "theta_y", "theta_z"};

Wrench net_wrench(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                  const contact::ContactLoads& loads) {
  Wrench wrench = loads.total_wrench() + applied_wrench(load, setup.contact.side_of_body(),
                                                        setup.axial_offset, pose);
  for (const model::Ligament& ligament : setup.ligaments) {
    wrench += model::ligament_wrench(ligament, pose);
  }
  return wrench;
}

}  // namespace

Vector6 net_generalised_force(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                              const contact::ContactLoads& loads) {
  return generalised_force(pose, net_wrench(setup, load, pose, loads)) +
         restraint_force(setup.restraint, pose);
}

Matrix6 net_generalised_stiffness(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                                  const contact::ContactLoads& loads) {
  Matrix6 S = loads.total_stiffness() + applied_stiffness(load);
  for (const model::Ligament& ligament : setup.ligaments) {
    S += model::ligament_stiffness(ligament, pose);
  }
  return generalised_stiffness(pose, net_wrench(setup, load, pose, loads), S) +
         restraint_stiffness(setup.restraint, pose);
}

KneeEquilibrium::KneeEquilibrium(const KneeSetup& setup, const KneeLoad& load, const Pose& pose,
                                 std::span<const int> free)
    : setup_(setup), load_(load), fixed_(pose), free_(free.begin(), free.end()) {}

numerics::LoadKind KneeEquilibrium::load_kind(int i) const {
  return free_[static_cast<std::size_t>(i)] < kThetaX ? numerics::LoadKind::kForce
                                                      : numerics::LoadKind::kMoment;
}

std::string_view KneeEquilibrium::coordinate_name(int i) const {
  return kCoordinates[static_cast<std::size_t>(free_[static_cast<std::size_t>(i)])];
}

numerics::Unknowns KneeEquilibrium::unknowns(const Pose& p) const {
  numerics::Unknowns alpha(size());
  for (int i = 0; i < size(); ++i) alpha[i] = p[free_[static_cast<std::size_t>(i)]];
  return alpha;
}

Pose KneeEquilibrium::pose(const numerics::Unknowns& alpha) const {
  Pose p = fixed_;
  for (int i = 0; i < size(); ++i) p[free_[static_cast<std::size_t>(i)]] = alpha[i];
  return p;
}

void KneeEquilibrium::residual(const numerics::Unknowns& alpha, numerics::Unknowns& r) {
  const Pose p = pose(alpha);
  const auto loads = setup_.contact.evaluate(p, contact::Derivatives::kNone);
  r = unknowns(net_generalised_force(setup_, load_, p, loads));
}

void KneeEquilibrium::residual_and_jacobian(const numerics::Unknowns& alpha, numerics::Unknowns& r,
                                            numerics::Jacobian& J) {
  const Pose p = pose(alpha);
  const auto loads = setup_.contact.evaluate(p, contact::Derivatives::kStiffness);
  r = unknowns(net_generalised_force(setup_, load_, p, loads));
  const Matrix6 K = net_generalised_stiffness(setup_, load_, p, loads);
  for (int i = 0; i < size(); ++i) {
    for (int j = 0; j < size(); ++j) {
      J(i, j) = K(free_[static_cast<std::size_t>(i)], free_[static_cast<std::size_t>(j)]);
    }
  }
}

}  // namespace condyle::fdk
