// SPDX-License-Identifier: Apache-2.0
// The shortest line between two points around a cylinder: exact, in closed form, with its first
// and second derivatives.
//
// In the cylinder's frame (z its axis) a cylinder unrolls: seen along z the line is tangent, arc,
// tangent, of length
//   s = d_a + d_b + r θ,   d = √(ρ² − r²),   θ from one tangent point to the other in its sense,
// and it climbs evenly along it, a straight line on the unrolled surface:
//   L = √(s² + ζ²),   ζ = z_b − z_a.
// The ends' gradients are unit vectors (away from the line); d enters the second derivatives as
// 1/d, so a point on the surface itself has no finite curvature. At θ = 0 length and gradient equal
// the straight line's; the second derivative jumps there.
//
// When a path goes around, and on which side, follows OpenSim's WrapCylinder (version 4.6):
//   quadrant "all"   a segment that pierces the infinite cylinder goes around the shorter way, any
//                    other stays straight;
//   quadrant ±x, ±y, ±z
//                    with an end on that side, a segment that pierces it goes around, and one that
//                    misses it only if its ends are on different sides and its nearest point to the
//                    axis is on the wrong one; with no end on that side it always goes around. It
//                    turns so that its tangent points are on that side, the first end's deciding
//                    before the second's.
//   An end inside the radius, or both tangent points beyond the cylinder's length: straight.
// Departures:
//   (a) OpenSim places the tangent points along z by a construction that is not the shortest line
//       where a path has only one wrap: its lengths are longer, by up to some 1e-5 m.
//   (b) Where the candidate tangent points do not tell the two ways apart, OpenSim takes one fixed
//       sense, even the long way; here the shorter way is taken.
// Pitfalls: quadrants and the finite length make the length jump where the rule switches; so does
// entering the radius. With a quadrant the two ends are not alike where their candidates disagree.
#pragma once

#include <string>
#include <string_view>

#include "condyle/common/types.hpp"

namespace condyle::model {

struct Cylinder {
  double radius = 0.0;    ///< [m]
  double length = 0.0;    ///< [m], centred on the frame's origin
  int quadrant_axis = 0;  ///< 0, 1, 2: x, y, z
  int quadrant_sign = 0;  ///< 0: "all"
};

/// @param quadrant all, x, -x, y, -y, z, -z. @throws std::invalid_argument naming the owner, the
/// field and the value.
Cylinder make_cylinder(double radius, double length, std::string_view quadrant,
                       const std::string& owner);

/// What a segment does at a cylinder.
enum class CylinderContact {
  kMisses,   ///< stays straight
  kInside,   ///< an end is within the radius: stays straight
  kForced,   ///< goes around because of the quadrant only
  kPierces,  ///< goes around because the straight line would pierce it
};

/// Whether and in which sense the segment a → b goes around.
struct CylinderDecision {
  CylinderContact contact = CylinderContact::kMisses;
  int turn = 0;  ///< +1: counter-clockwise about z from a to b, −1: clockwise; 0: straight
  bool goes_around() const { return turn != 0; }
};

/// @param a, b ends in the cylinder's frame [m].
CylinderDecision decide_wrap(const Cylinder& cylinder, const Vector3& a, const Vector3& b);

/// The line around, in the cylinder's frame.
struct CylinderLine {
  double length = 0.0;                                               ///< L [m]
  double arc = 0.0;                                                  ///< length on the surface [m]
  double angle = 0.0;                                                ///< θ [rad], in [0, 2π)
  Vector3 tangent_a = Vector3::Zero(), tangent_b = Vector3::Zero();  ///< where it touches [m]
  Vector3 by_a = Vector3::Zero(), by_b = Vector3::Zero();            ///< ∂L/∂a, ∂L/∂b: unit
};

/// @param turn +1 or −1. @pre a and b are not within the radius.
CylinderLine line_around(double radius, const Vector3& a, const Vector3& b, int turn);

/// ∂²L/∂(a,b)² [1/m]: blocks aa, ab (rows a, columns b) and bb.
struct CylinderCurvature {
  Matrix3 aa, ab, bb;
};
CylinderCurvature line_curvature(double radius, const Vector3& a, const Vector3& b,
                                 const CylinderLine& line);

}  // namespace condyle::model
