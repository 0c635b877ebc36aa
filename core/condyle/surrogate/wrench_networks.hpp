// SPDX-License-Identifier: Apache-2.0
// What an architecture is to the fused path: networks that give the wrench of a few poses, and its
// derivative. Error and trust are not theirs: they are computed from pose and wrench
// (row_program.hpp).
#pragma once

#include <cstddef>
#include <span>

#include "condyle/common/pose.hpp"
#include "condyle/surrogate/dense_network.hpp"

namespace condyle::surrogate {

/// Thread safety: const functions, each thread with a workspace of its own.
class WrenchNetworks {
 public:
  virtual ~WrenchNetworks() = default;

  /// Poses that one evaluation takes at most.
  virtual std::size_t max_poses(bool stiffness) const = 0;

  /// @param wrench (n, 2, 6) row-major, ContactLoads::wrench of each pose; written.
  /// @param stiffness (n, 2, 6, 6), or null if not wanted.
  /// @pre 1 ≤ poses.size() ≤ max_poses(stiffness != nullptr). Allocates nothing.
  virtual void evaluate(std::span<const Pose> poses, DenseWorkspace& workspace, double* wrench,
                        double* stiffness) const = 0;
};

}  // namespace condyle::surrogate
