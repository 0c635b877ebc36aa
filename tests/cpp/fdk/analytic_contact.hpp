// SPDX-License-Identifier: Apache-2.0
// A contact model in closed form: spheres of the femur on dished surfaces of the insert, with an energy and its exact
// wrench and stiffness.
//
//   U = Σ c dⁿ⁺¹/(n+1),   d = max(0, h(c_x, c_z) + R − c_y),   h = h₀ + c_x²/2a + (c_z − z_s)²/2b
//
// with (c_x, c_y, c_z) a sphere's centre in T. Several spheres across a condyle's width make it a (nearly) flat one that
// carries a moment by itself, so that single-sided equilibria exist, up to the outermost sphere.
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <vector>

#include "condyle/contact/contact_model.hpp"

namespace condyle::test {

struct KneeShape {
  SideOfBody side_of_body = SideOfBody::kRight;
  double radius = 0.0267;          // [m]
  double centre_x = -0.0063;       // of the spheres in F [m]
  double centre_y = -0.0084;       // [m]
  double spacing = 0.0481;         // medial to lateral [m]
  double half_width = 0.0068;      // of a condyle [m]
  int spheres = 5;                 // across it
  double stiffness = 4.1e8;        // c of a sphere [N/mⁿ]
  double exponent = 1.9;
  double dish_height = 0.0071;     // h₀ [m]
  double sagittal_radius = 0.0573;  // a [m]
  double coronal_radius = 0.31;     // b [m]
  double insert_half_length = 0.024;  // no surface beyond |c_x| of this [m]
  double plausible_depth = 2e-3;
};

class AnalyticContact : public contact::ContactModel {
 public:
  explicit AnalyticContact(const KneeShape& shape = {}) : shape_(shape) {}

  SideOfBody side_of_body() const override { return shape_.side_of_body; }

  contact::ContactLoads evaluate(const Pose& pose, contact::Derivatives derivatives) const override {
    contact::require_finite(pose);
    ++evaluations;
    contact::ContactLoads loads;
    const RigidTransform X_TF = transform_TF(pose);
    for (int s = 0; s < kSides; ++s) {
      const double towards = medial_direction(shape_.side_of_body) * (s == kMedial ? 1.0 : -1.0);
      const double z_side = 0.5 * towards * shape_.spacing;
      Matrix6 by_twist = Matrix6::Zero();
      for (int k = 0; k < shape_.spheres; ++k) {
        const double across = shape_.spheres == 1 ? 0.0 : 2.0 * k / (shape_.spheres - 1) - 1.0;
        const Vector3 p_FoC_F(shape_.centre_x, shape_.centre_y,
                              z_side + towards * across * shape_.half_width);
        add(X_TF, p_FoC_F, z_side, loads, s, by_twist);
      }
      if (derivatives == contact::Derivatives::kStiffness) {
        loads.stiffness[s] = by_twist * twist_map(pose);
      }
    }
    return loads;
  }

  double energy(const Pose& pose) const {
    const RigidTransform X_TF = transform_TF(pose);
    double U = 0.0;
    for (const double towards : {-1.0, 1.0}) {
      for (int k = 0; k < shape_.spheres; ++k) {
        const double across = shape_.spheres == 1 ? 0.0 : 2.0 * k / (shape_.spheres - 1) - 1.0;
        const double z_side = 0.5 * towards * shape_.spacing;
        const Vector3 c = X_TF * Vector3(shape_.centre_x, shape_.centre_y,
                                         z_side + towards * across * shape_.half_width);
        const double d = depth(c, z_side);
        if (d > 0.0) U += shape_.stiffness * std::pow(d, shape_.exponent + 1) / (shape_.exponent + 1);
      }
    }
    return U;
  }

  const KneeShape& shape() const { return shape_; }

  mutable std::atomic<long> evaluations{0};

 private:
  double depth(const Vector3& c, double z_side) const {
    if (std::abs(c.x()) > shape_.insert_half_length) return -1.0;
    const double dz = c.z() - z_side;
    return shape_.dish_height + c.x() * c.x() / (2.0 * shape_.sagittal_radius) +
           dz * dz / (2.0 * shape_.coronal_radius) + shape_.radius - c.y();
  }

  void add(const RigidTransform& X_TF, const Vector3& p_FoC_F, double z_side,
           contact::ContactLoads& loads, int s, Matrix6& by_twist) const {
    const Vector3 c = X_TF * p_FoC_F;
    const double d = depth(c, z_side);
    if (d <= 0.0) return;
    if (d > shape_.plausible_depth) loads.implausible_depth = true;
    const Vector3 r = c - X_TF.p;
    const Vector3 g(c.x() / shape_.sagittal_radius, -1.0, (c.z() - z_side) / shape_.coronal_radius);
    const double n = shape_.exponent;
    const double p = shape_.stiffness * std::pow(d, n);
    const Vector3 force = -p * g;
    loads.wrench[s].head<3>() += force;
    loads.wrench[s].tail<3>() += r.cross(force);

    Matrix3 hessian = Matrix3::Zero();
    hessian(0, 0) = 1.0 / shape_.sagittal_radius;
    hessian(2, 2) = 1.0 / shape_.coronal_radius;
    const Matrix3 by_c =
        -shape_.stiffness * n * std::pow(d, n - 1.0) * (g * g.transpose()) - p * hessian;
    Eigen::Matrix<double, 3, 6> motion;  // of the centre with the twist (v, ω)
    motion.leftCols<3>().setIdentity();
    motion.rightCols<3>() = -cross(r);
    by_twist.topRows<3>() += by_c * motion;
    by_twist.bottomRows<3>() += cross(r) * by_c * motion;
    // The arm turns with ω: (ω×r)×f = −[f]×(ω×r) = [f]× [r]× ω.
    by_twist.bottomRightCorner<3, 3>() += cross(force) * cross(r);
  }

  static Matrix3 cross(const Vector3& a) {
    Matrix3 A;
    A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
    return A;
  }

  KneeShape shape_;
};

}  // namespace condyle::test
