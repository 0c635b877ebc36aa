// SPDX-License-Identifier: Apache-2.0
// The two-stage surrogate of Marra et al. 2017: net I gives both sides' Fy and Mx, then a net for
// each side its other four loads.
//
//   (Fy, Mx)_medial, (Fy, Mx)_lateral = I(pose)
//   (Fx, Fz, My, Mz)_side = II_side(pose, Fy_side, Mx_side),   all six zero where Fy_side ≤ 0
//
// Derivatives go through the second stage by the chain rule: d/dpose of (pose, Fy, Mx) enters net
// II as the derivative of its inputs. At the gate they are those of the zero side, as in the ONNX
// file.
#pragma once

#include <array>

#include "condyle/common/side.hpp"
#include "condyle/surrogate/wrench_networks.hpp"

namespace condyle::surrogate {

class TwoStage final : public WrenchNetworks {
 public:
  /// @param first 6 → 4; @param second 8 → 4 each.
  /// @throws std::invalid_argument on other sizes.
  TwoStage(DenseNetwork first, std::array<DenseNetwork, kSides> second,
           const DenseKernels& kernels = dense_kernels());

  std::size_t max_poses(bool stiffness) const override;
  void evaluate(std::span<const Pose> poses, DenseWorkspace& workspace, double* wrench,
                double* stiffness) const override;

 private:
  /// Net II or III, for the poses that press on its side; first holds (Fy, Mx) of each column.
  void evaluate_side(Side side, std::span<const Pose> poses, const double* first,
                     DenseWorkspace& workspace, double* wrench, double* stiffness) const;

  DenseNetwork first_;
  std::array<DenseNetwork, kSides> second_;
  DenseKernels kernels_;
};

}  // namespace condyle::surrogate
