// SPDX-License-Identifier: Apache-2.0
// A multilayer perceptron with tanh hidden layers and linear output, and its derivatives along with
// its value (forward mode):
//
//   h_0 = x,  h_l = tanh(W_lᵀ h_{l−1} + b_l),  y = W_Lᵀ h_{L−1} + b_L,
//   h_l' = (1 − h_l²)·(W_lᵀ h_{l−1}'),  y' = W_Lᵀ h_{L−1}'
//
// for as many directions as there are coordinates of a pose. Inputs and outputs are SI: scaling
// stands in the first and last layers.
#pragma once

#include <array>
#include <vector>

#include "condyle/surrogate/dense_kernels.hpp"

namespace condyle::surrogate {

/// One layer: weight (inputs, outputs) row-major, bias (outputs).
struct DenseLayer {
  int inputs = 0;
  int outputs = 0;
  std::vector<double> weight;
  std::vector<double> bias;
};

/// Memory for one evaluation at a time, by one network after the other. Left as it is when made:
/// clearing it would take longer than a network.
struct DenseWorkspace {
  DenseWorkspace() {}  // not "= default", which would clear it in DenseWorkspace{}
  alignas(64) std::array<double, kMaxDenseColumns * kMaxDenseWidth> a;
  alignas(64) std::array<double, kMaxDenseColumns * kMaxDenseWidth> b;
};

/// Thread safety: const functions, each thread with a workspace of its own.
class DenseNetwork {
 public:
  DenseNetwork() = default;

  /// @throws std::invalid_argument if a layer's sizes do not fit the one before or its own arrays,
  /// is
  ///   wider than kMaxDenseWidth, or has a weight that is not finite.
  explicit DenseNetwork(const std::vector<DenseLayer>& layers);

  int inputs() const { return inputs_; }
  int outputs() const { return outputs_; }
  int hidden_layers() const { return static_cast<int>(layers_.size()) - 1; }

  /// Doubles from one column to the next in the workspace.
  int stride() const { return stride_; }

  /// Where the caller writes the inputs: column c begins at workspace.a.data() + c·stride().
  /// With derivatives each pose has seven columns: x, then x' for each of the six directions.
  /// @pre 1 ≤ columns ≤ kMaxDenseColumns, a multiple of seven with derivatives.
  /// @return the outputs, in columns like the inputs; in the workspace.
  const double* evaluate(const DenseKernels& kernels, DenseWorkspace& workspace, int columns,
                         bool derivatives) const;

 private:
  struct Layer {
    int inputs = 0;
    int width = 0;               // outputs, rounded up to kDenseStep
    std::vector<double> weight;  // (inputs, width)
    std::vector<double> bias;    // (width)
  };
  int inputs_ = 0;
  int outputs_ = 0;
  int stride_ = 0;
  std::vector<Layer> layers_;
};

}  // namespace condyle::surrogate
