// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/ligament.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <stdexcept>

#include "condyle/model/ligament_law.hpp"

namespace condyle::model {
namespace {

Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

struct Line {
  Vector3 arm;        // r = A − Fo, in T
  Vector3 direction;  // from A to B, unit, in T
  double length = 0.0;
};

Line line(const Ligament& ligament, const Pose& pose) {
  Line l;
  l.arm = rotation_TF(pose) * ligament.p_FoA_F;
  const Vector3 p_AB_T = ligament.p_ToB_T - pose.head<3>() - l.arm;
  l.length = p_AB_T.norm();
  l.direction = p_AB_T / l.length;
  return l;
}

LigamentForceLaw law(const Ligament& ligament) {
  return {LigamentLaw::kBlankevoort, ligament.stiffness, ligament.slack_length,
          2.0 * ligament.transition, 0.0};
}

// One row of the table of default bundles: attachments in mm of a right knee.
struct DefaultBundle {
  const char* name;
  std::array<double, 3> femoral_mm, tibial_mm;
  double stiffness, reference_strain;
};
constexpr std::array<DefaultBundle, 8> kDefaultBundles{{
    {"mcl_superficial", {0, 8, -42}, {2, -58, -26}, 2200.0, 0.03},
    {"mcl_deep", {-2, 2, -44}, {-4, -11, -44}, 2800.0, 0.03},
    {"posteromedial_capsule", {-13, 8, -42}, {-21, -13, -35}, 2000.0, 0.05},
    {"lcl", {-19, 2, 41}, {-14, -18, 44}, 1800.0, 0.06},
    {"popliteofibular", {-9, -9, 43}, {-25, -8, 37}, 3000.0, -0.01},
    {"pcl_anterolateral", {-10, -10, -9}, {-21, -8, 0}, 5700.0, 0.01},
    {"pcl_posteromedial", {-17, -10, -13}, {-25, -8, 0}, 2400.0, -0.06},
    {"posterior_capsule", {-23, 16, 2}, {-29, -10, -1}, 4000.0, 0.08},
}};

}  // namespace

void require_valid(const Ligament& ligament) {
  const auto refuse = [&](const char* field, double value, const char* limit) {
    throw std::invalid_argument("ligament '" + ligament.name + "': " + field + " is " +
                                std::to_string(value) + ": must be " + limit);
  };
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(ligament.p_FoA_F[i])) refuse("p_FoA_F", ligament.p_FoA_F[i], "finite [m]");
    if (!std::isfinite(ligament.p_ToB_T[i])) refuse("p_ToB_T", ligament.p_ToB_T[i], "finite [m]");
  }
  if (!(ligament.stiffness >= 0.0) || !std::isfinite(ligament.stiffness)) {
    refuse("stiffness", ligament.stiffness, "finite and at least 0 [N per unit strain]");
  }
  if (!(ligament.slack_length > 0.0 && ligament.slack_length < 1.0)) {
    refuse("slack_length", ligament.slack_length, "above 0 and below 1 [m]");
  }
  if (!(ligament.transition > 0.0 && ligament.transition < 1.0)) {
    refuse("transition", ligament.transition, "above 0 and below 1 [-]");
  }
}

double length(const Ligament& ligament, const Pose& pose) { return line(ligament, pose).length; }

double slack_length(const Ligament& ligament, const Pose& reference_pose, double reference_strain) {
  return length(ligament, reference_pose) / (1.0 + reference_strain);
}

double tension(const Ligament& ligament, double length) {
  return tension(law(ligament), length).force;
}

double tension_by_length(const Ligament& ligament, double length) {
  return tension(law(ligament), length).by_length;
}

double energy(const Ligament& ligament, double length) { return energy(law(ligament), length); }

Wrench ligament_wrench(const Ligament& ligament, const Pose& pose) {
  const Line l = line(ligament, pose);
  const Vector3 force = tension(ligament, l.length) * l.direction;
  Wrench wrench;
  wrench << force, l.arm.cross(force);
  return wrench;
}

Matrix6 ligament_stiffness(const Ligament& ligament, const Pose& pose) {
  const Line l = line(ligament, pose);
  const double T = tension(ligament, l.length);
  const Vector3 force = T * l.direction;
  const Matrix3 along = l.direction * l.direction.transpose();
  // A moves by δa = v + ω×r: δL = −uᵀδa, δu = −(I − uuᵀ)δa/L, so δf = −(T' uuᵀ + T/L (I − uuᵀ)) δa.
  const Matrix3 by_A = -(tension_by_length(ligament, l.length) * along +
                         T / l.length * (Matrix3::Identity() - along));
  const Matrix3 arm = cross_matrix(l.arm);
  Matrix6 by_twist;
  by_twist.topLeftCorner<3, 3>() = by_A;
  by_twist.topRightCorner<3, 3>() = -by_A * arm;
  by_twist.bottomLeftCorner<3, 3>() = arm * by_A;
  // The arm turns with the femur: (ω×r)×f = [f]×[r]× ω.
  by_twist.bottomRightCorner<3, 3>() = -arm * by_A * arm + cross_matrix(force) * arm;
  return by_twist * twist_map(pose);
}

std::vector<Ligament> default_ligaments(SideOfBody side_of_body, const Pose& reference_pose) {
  const double mirror = side_of_body == SideOfBody::kRight ? 1.0 : -1.0;
  const auto metres = [&](const std::array<double, 3>& p_mm) {
    return Vector3(1e-3 * p_mm[0], 1e-3 * p_mm[1], 1e-3 * mirror * p_mm[2]);
  };
  std::vector<Ligament> ligaments;
  ligaments.reserve(kDefaultBundles.size());
  for (const DefaultBundle& bundle : kDefaultBundles) {
    Ligament ligament;
    ligament.name = bundle.name;
    ligament.p_FoA_F = metres(bundle.femoral_mm);
    ligament.p_ToB_T = metres(bundle.tibial_mm);
    ligament.stiffness = bundle.stiffness;
    ligament.slack_length = slack_length(ligament, reference_pose, bundle.reference_strain);
    ligaments.push_back(ligament);
  }
  return ligaments;
}

}  // namespace condyle::model
