// SPDX-License-Identifier: Apache-2.0
// The exact volume in which two closed solids overlap.
//
//   V = ∫ dx over A ∩ B,   c = (1/V) ∫ x dx
//
// from the triangles of A ∩ B itself (corefinement: both surfaces are cut along the curves where
// they meet). Cuts are decided exactly; corners of the cut are then rounded to double, so V carries
// rounding only: some 1e-17 m of position over the overlap's surface.
//
// A check of contact models, not a part of them: tens of milliseconds a pose on real implants. It
// is the overlap of *solids*; a depth measured from one open surface differs at that surface's rim.
//
// Source: CGAL 5.5, Polygon Mesh Processing, corefinement and Boolean operations.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/common/pose.hpp"
#include "condyle/geometry/triangle_mesh.hpp"

namespace condyle::geometry {

/// A closed surface, checked and prepared to be overlapped at many poses. May have several parts,
/// and voids wound the other way.
class OverlapSolid {
 public:
  /// @param what names the solid in messages.
  /// @throws std::invalid_argument naming `what`, the fault and the remedy, unless the mesh is well
  /// formed, closed, manifold, consistently wound and outward. A solid that passes through itself
  /// is no error: its pairs are counted.
  explicit OverlapSolid(const TriangleMesh& mesh, const std::string& what = "solid");
  ~OverlapSolid();
  OverlapSolid(OverlapSolid&&) noexcept;
  OverlapSolid& operator=(OverlapSolid&&) noexcept;

  double volume() const;  ///< [m³]
  /// Pairs of faces that meet in more than the vertex or edge that they share (exact predicates:
  /// touching counts, a gap however small does not).
  Eigen::Index self_intersections() const;

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<const Impl> impl_;
};

/// What to think of an overlap volume.
enum class OverlapStatus {
  kOk,
  /// A solid passes through itself close to where it cuts the other. The volume is the sum over the
  /// parts as they are wound, and a region that a solid covers twice may count twice.
  kSelfIntersectionAtCut,
  /// The overlap is no solid (two of its parts share just an edge), or could not be formed: move
  /// one of the solids by a micrometre, or repair the one that passes through itself.
  kFailed,
};

/// "ok", "self_intersection_at_cut" or "failed".
std::string_view name(OverlapStatus status);

struct OverlapVolume {
  double volume = 0.0;                  ///< exactly 0 where disjoint; NaN if failed [m³]
  Vector3 centroid = Vector3::Zero();   ///< in B's frame; zero where disjoint, NaN if failed [m]
  Eigen::Index self_intersections = 0;  ///< of both solids, wherever they are
  OverlapStatus status = OverlapStatus::kOk;
};

/// The overlap of A, placed by X_BA, with B. Thread safe: the solids are only read.
/// @throws std::invalid_argument if X_BA is not finite or not a rotation (to 1e-6).
OverlapVolume overlap_volume(const OverlapSolid& a, const OverlapSolid& b,
                             const RigidTransform& X_BA);

/// The overlap with the insert of a femur at many poses, on `threads` threads (0: all); the same
/// bytes for any number.
/// @throws std::invalid_argument for a pose that is not finite, naming its row.
std::vector<OverlapVolume> overlap_volumes(const OverlapSolid& femur, const OverlapSolid& insert,
                                           std::span<const Pose> poses, int threads);

}  // namespace condyle::geometry
