// SPDX-License-Identifier: Apache-2.0
// Twists and wrenches at ground's origin, and the products of rigid-body dynamics between them.
//
//   twist S = (w, v): angular velocity, velocity of the point at the origin
//   wrench F = (n, f): moment about the origin, force;   power S·F = w·n + v·f
//
// Source: Featherstone 2008, Rigid Body Dynamics Algorithms, ch. 2, doi:10.1007/978-1-4899-7560-7.
#pragma once

#include <Eigen/Geometry>

#include "condyle/common/types.hpp"
#include "condyle/model/kinematics.hpp"

namespace condyle::model {

struct Screw {
  Vector3 w = Vector3::Zero(), v = Vector3::Zero();
  Screw& operator+=(const Screw& other) {
    w += other.w;
    v += other.v;
    return *this;
  }
};

struct ForceScrew {
  Vector3 n = Vector3::Zero(), f = Vector3::Zero();
  ForceScrew& operator+=(const ForceScrew& other) {
    n += other.n;
    f += other.f;
    return *this;
  }
  ForceScrew& operator-=(const ForceScrew& other) {
    n -= other.n;
    f -= other.f;
    return *this;
  }
};

/// S_a of an axis where it stands.
inline Screw axis_screw(const AxisNow& axis) {
  if (!axis.rotational) return {Vector3::Zero(), axis.direction};
  return {axis.direction, axis.point.cross(axis.direction)};
}

inline double power(const Screw& S, const ForceScrew& F) { return S.w.dot(F.n) + S.v.dot(F.f); }

/// A × B: rate of change of a twist B that is carried along by A.
inline Screw cross(const Screw& A, const Screw& B) {
  return {A.w.cross(B.w), A.w.cross(B.v) + A.v.cross(B.w)};
}

/// A ×* F: rate of change of a wrench F that is carried along by A. S·(A ×* F) = −(A × S)·F.
inline ForceScrew cross(const Screw& A, const ForceScrew& F) {
  return {A.w.cross(F.n) + A.v.cross(F.f), A.w.cross(F.f)};
}

/// The wrench of a force at a point and a moment.
inline ForceScrew wrench_at_origin(const Vector3& force, const Vector3& point,
                                   const Vector3& moment) {
  return {moment + point.cross(force), force};
}

}  // namespace condyle::model
