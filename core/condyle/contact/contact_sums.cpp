// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_sums.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace condyle::contact {
namespace {

Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

// Σ q×f from Σ f qᵀ.
Vector3 moment_of(const Matrix3& dyad) {
  return {dyad(2, 1) - dyad(1, 2), dyad(0, 2) - dyad(2, 0), dyad(1, 0) - dyad(0, 1)};
}

CompartmentLoads scalars_of(const ContactSums& sums, const RigidTransform& X_TD) {
  CompartmentLoads loads;
  loads.energy = sums.energy;
  loads.volume = sums.volume;
  loads.area = sums.area;
  loads.border_area = sums.border_area;
  loads.max_depth = sums.max_depth;
  loads.peak_pressure = sums.peak_pressure;
  loads.pressure_sum = sums.pressure_sum;
  loads.pressure_moment = X_TD.R * sums.pressure_moment + sums.pressure_sum * X_TD.p;
  loads.back_face = sums.back_face;
  return loads;
}

}  // namespace

void ContactSums::add(const LoadedPoint& point) {
  const double load = point.area * point.pressure;
  const Vector3 f = -load * point.gradient;
  energy += point.area * point.energy;
  volume += point.area * point.depth;
  area += point.area;
  max_depth = std::max(max_depth, point.depth);
  peak_pressure = std::max(peak_pressure, point.pressure);
  pressure_sum += load;
  pressure_moment += load * point.position;
  force += f;
  dyad += f * point.position.transpose();
}

void ContactSums::add_stiffness(const LoadedPoint& point, const Matrix3& hessian) {
  const Matrix3 s = point.area * (point.pressure * hessian - point.pressure_rate * point.gradient *
                                                                 point.gradient.transpose());
  const Matrix3 cross = cross_matrix(point.position), s_cross = s * cross;
  S += s;
  Sq += s_cross;
  qSq += cross.transpose() * s_cross;
}

// The moving body takes D along: in F the fixed points move by δq = −(v + ω×q), and f turns with F.
CompartmentLoads loads_of_moving_distance(const ContactSums& sums, const Pose& pose,
                                          bool with_stiffness) {
  const RigidTransform X_TF = transform_TF(pose);
  const Matrix3& R = X_TF.R;
  CompartmentLoads loads = scalars_of(sums, X_TF);
  loads.wrench << R * sums.force, R * moment_of(sums.dyad);
  if (!with_stiffness) return loads;
  const Matrix3 force = cross_matrix(sums.force);
  Matrix6 K;
  K.topLeftCorner<3, 3>() = R * sums.S * R.transpose();
  K.topRightCorner<3, 3>() = R * (-sums.Sq - force) * R.transpose();
  K.bottomLeftCorner<3, 3>() = R * (force - sums.Sq.transpose()) * R.transpose();
  K.bottomRightCorner<3, 3>() =
      R * (sums.qSq - sums.dyad + sums.dyad.trace() * Matrix3::Identity()) * R.transpose();
  loads.stiffness = K * twist_map(pose);
  return loads;
}

// The points move with the body: in T δq = v + ω×r with r = q − Fo; the force on it is −f, and its
// arm turns, δr = ω×r.
CompartmentLoads loads_of_fixed_distance(const ContactSums& sums, const Pose& pose,
                                         bool with_stiffness) {
  CompartmentLoads loads = scalars_of(sums, RigidTransform{Matrix3::Identity(), Vector3::Zero()});
  const Vector3 o = pose.head<3>();
  const Matrix3 dyad = sums.dyad - sums.force * o.transpose();  // Σ f rᵀ
  // Zero minus, so that no contact is 0 and not −0.
  loads.wrench << Vector3::Zero() - sums.force, Vector3::Zero() - moment_of(dyad);
  if (!with_stiffness) return loads;
  const Matrix3 origin = cross_matrix(o);
  const Matrix3 Sr = sums.Sq - sums.S * origin;
  const Matrix3 rSr = sums.qSq - origin.transpose() * sums.Sq - sums.Sq.transpose() * origin +
                      origin.transpose() * sums.S * origin;
  Matrix6 K;
  K.topLeftCorner<3, 3>() = sums.S;
  K.topRightCorner<3, 3>() = -Sr;
  K.bottomLeftCorner<3, 3>() = -Sr.transpose();
  K.bottomRightCorner<3, 3>() =
      rSr - dyad.transpose() + dyad.trace() * Matrix3::Identity();
  loads.stiffness = K * twist_map(pose);
  return loads;
}

CompartmentLoads mean(const CompartmentLoads& a, const CompartmentLoads& b) {
  CompartmentLoads loads;
  loads.wrench = 0.5 * (a.wrench + b.wrench);
  loads.stiffness = 0.5 * (a.stiffness + b.stiffness);
  loads.energy = 0.5 * (a.energy + b.energy);
  loads.volume = 0.5 * (a.volume + b.volume);
  loads.area = 0.5 * (a.area + b.area);
  loads.border_area = 0.5 * (a.border_area + b.border_area);
  loads.max_depth = std::max(a.max_depth, b.max_depth);
  loads.peak_pressure = std::max(a.peak_pressure, b.peak_pressure);
  loads.pressure_sum = 0.5 * (a.pressure_sum + b.pressure_sum);
  loads.pressure_moment = 0.5 * (a.pressure_moment + b.pressure_moment);
  loads.back_face = a.back_face || b.back_face;
  return loads;
}

}  // namespace condyle::contact
