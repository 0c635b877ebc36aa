// SPDX-License-Identifier: Apache-2.0
// The potential surrogate: an energy for each side, whose gradient is the load.
//
//   N(p) = w·h_L(p) + c + ½ p·(G + b),  G = 2A p + b,   h_l = tanh(W_lᵀ h_{l−1} + b_l), h_0 = p
//   U = k·N^q where N > 0, else 0;  Q = −∂U/∂p,  wrench = R(p)·Q,  R = the inverse transpose of
//   the G of common/pose.hpp
//
// First derivatives come by one way back, δ_L = w∘s_L, δ_l = (W_{l+1} δ_{l+1})∘s_l, s = 1 − h². The
// second come from the six tangents S_l = ∂(sums of layer l)/∂p of the way there:
//
//   ∂²N/∂p² = 2A + Σ_l S_lᵀ diag(−2 h_l∘δ_l) S_l,
//
// symmetric as computed. Sides that are lifted cost their value of N and no more.
#pragma once

#include <array>
#include <vector>

#include "condyle/common/side.hpp"
#include "condyle/surrogate/wrench_networks.hpp"

namespace condyle::surrogate {

/// One side's energy.
struct PotentialSide {
  std::vector<DenseLayer> layers;      ///< 6 → ... → 1; the last bias holds c
  std::array<double, 36> curvature{};  ///< 2A, symmetric
  std::array<double, 6> steepness{};   ///< b
  double exponent = 0.0;               ///< q − 2 > 0
  double force_factor = 0.0;           ///< −k·q: ∂U/∂N is −force_factor·N^(q−1)
  double curve_factor = 0.0;           ///< −k·q·(q − 1)
};

class Potential final : public WrenchNetworks {
 public:
  /// @throws std::invalid_argument on layers that are not 6 to 1, that DenseNetwork would refuse,
  ///   or that are too many for the memory of an evaluation; on an exponent that is not positive.
  explicit Potential(const std::array<PotentialSide, kSides>& sides,
                     const DenseKernels& kernels = dense_kernels());

  std::size_t max_poses(bool stiffness) const override;
  void evaluate(std::span<const Pose> poses, DenseWorkspace& workspace, double* wrench,
                double* stiffness) const override;

 private:
  struct Layer {
    int inputs = 0;
    int width = 0;               // outputs, rounded up to kDenseStep
    int back_width = 0;          // inputs, rounded up
    std::vector<double> weight;  // (inputs, width)
    std::vector<double> bias;    // (width)
    std::vector<double> back;    // (outputs, back_width), transposed weights
    int outputs = 0;
  };
  struct Energy {
    std::vector<Layer> hidden;
    std::vector<double> last_row;        // w (width), as the seed of the way back
    std::vector<double> last_column;     // w (inputs, kDenseStep), its first column
    std::array<double, 48> curvature{};  // (6, kDenseStep)
    PotentialSide constants;             // without layers
    double last_bias = 0.0;
    int stride = 0;
    std::size_t poses = 0;  // that fit into the memory of an evaluation
  };
  struct Memory;
  struct Turn;

  static Energy prepare(const PotentialSide& side);
  std::size_t find_loaded(const Energy& side, std::span<const Pose> poses, Memory& memory) const;
  void go_back(const Energy& side, std::size_t loaded, Memory& memory) const;
  void find_curvature(const Energy& side, std::size_t first, std::size_t count,
                      Memory& memory) const;
  static void write_loads(const Energy& side, std::size_t loaded, const Memory& memory,
                          double* wrench, double* stiffness);

  std::array<Energy, kSides> sides_;
  DenseKernels kernels_;
};

}  // namespace condyle::surrogate
