// SPDX-License-Identifier: Apache-2.0
// What a contact adds up to, and what it means for a pose: the one place that turns sums over faces
// into wrench and stiffness.
//
// The points q of one surface (body P) are pressed into another body D, whose signed distance is φ
// (negative inside). With d = −φ(q), p = W′(d) the pressure, g = ∇φ, H = ∇²φ, all expressed in D:
//
//   f = −A p g the force of a face on D,   S = A (p H − p′ g gᵀ),
//
// and Σf, Σf qᵀ, ΣS, ΣS[q] and Σ[q]ᵀS[q] are all that the wrench on either body and its derivative
// need, whichever of the two moves. A twist (v, ω) of the moving body about its origin changes q in
// D by δq, and δΣf = −ΣS δq + …, as below.
//
// Source: gradient and Hessian of the elastic-foundation energy, derived here; the law is Marra et
// al. 2015, 2017.
#pragma once

#include "condyle/common/pose.hpp"

namespace condyle::contact {

/// One loaded face, everything expressed in D.
struct LoadedPoint {
  Vector3 position;            ///< q [m]
  Vector3 gradient;            ///< g = ∇φ, unit where φ is an exact distance
  double area = 0.0;           ///< A [m²]
  double depth = 0.0;          ///< d [m], > 0
  double energy = 0.0;         ///< W(d) [J/m²]
  double pressure = 0.0;       ///< W′(d) [Pa]
  double pressure_rate = 0.0;  ///< W″(d) [Pa/m]
};

/// Sums over the loaded faces of one surface at one placement, components in D. Zero out of contact.
struct ContactSums {
  double energy = 0.0;         ///< U = Σ A W [J]
  double volume = 0.0;         ///< Σ A d [m³]
  double area = 0.0;           ///< Σ A of loaded faces [m²]
  double border_area = 0.0;    ///< Σ A of overlapping faces closest to D's open border: not counted
  double max_depth = 0.0;      ///< [m]
  double peak_pressure = 0.0;  ///< [Pa]
  double pressure_sum = 0.0;   ///< Σ A p [N]
  Vector3 pressure_moment = Vector3::Zero();  ///< Σ A p q [N m]
  bool back_face = false;                     ///< a loaded face overlaps a back face
  Vector3 force = Vector3::Zero();            ///< Σ f [N]
  Matrix3 dyad = Matrix3::Zero();             ///< Σ f qᵀ [N m]
  Matrix3 S = Matrix3::Zero();                ///< ΣS [N/m]
  Matrix3 Sq = Matrix3::Zero();               ///< ΣS[q] [N]
  Matrix3 qSq = Matrix3::Zero();              ///< Σ[q]ᵀS[q] [N m]

  /// Adds a point's share of everything but the stiffness.
  void add(const LoadedPoint& point);

  /// Adds a point's share of S, S[q] and [q]ᵀS[q]. @param hessian H = ∇²φ in D [1/m].
  void add_stiffness(const LoadedPoint& point, const Matrix3& hessian);
};

/// What one compartment's contact adds up to at one pose. Zero out of contact.
struct CompartmentLoads {
  Wrench wrench = Wrench::Zero();      ///< on the moving body, at Fo, in T [N, Nm]
  Matrix6 stiffness = Matrix6::Zero(); ///< ∂wrench/∂pose; zero unless asked for
  double energy = 0.0;                 ///< [J]
  double volume = 0.0;                 ///< Σ A d [m³]
  double area = 0.0;                   ///< of loaded faces [m²]
  double border_area = 0.0;            ///< of overlapping faces that did not count [m²]
  double max_depth = 0.0;              ///< [m]
  double peak_pressure = 0.0;          ///< [Pa]
  double pressure_sum = 0.0;           ///< Σ A p [N]; mean pressure is this / area
  Vector3 pressure_moment = Vector3::Zero();  ///< Σ A p c, in T; centre of pressure is this / sum
  bool back_face = false;                     ///< a loaded face overlaps a back face
};

/// The loads where D is the moving body (frame F) and the points are fixed in T.
CompartmentLoads loads_of_moving_distance(const ContactSums& sums, const Pose& pose,
                                          bool with_stiffness);

/// The loads where D is the fixed body (frame T) and the points move with F.
CompartmentLoads loads_of_fixed_distance(const ContactSums& sums, const Pose& pose,
                                         bool with_stiffness);

/// The mean of two integrations of the same contact; the deeper and harder of their maxima.
CompartmentLoads mean(const CompartmentLoads& a, const CompartmentLoads& b);

}  // namespace condyle::contact
