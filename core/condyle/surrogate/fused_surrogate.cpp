// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/fused_surrogate.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "condyle/surrogate/dense_kernels.hpp"
#include "condyle/surrogate/potential_graph.hpp"
#include "condyle/surrogate/row_program.hpp"
#include "condyle/surrogate/two_stage_graph.hpp"
#include "condyle/surrogate/wrench_networks.hpp"

namespace condyle::surrogate {
namespace {

constexpr std::size_t kWrench = 12;
constexpr std::size_t kStiffness = 72;
static_assert(RowProgram::kMaxRows >= kMaxDenseColumns);

/// What is left of the graph must be error and trust, from pose and wrench; nothing in a file that
/// has the wrench alone.
std::optional<RowProgram> match_trust(const GraphTemplate& graph) {
  const auto rest = graph.rest();
  const auto& outputs = graph.file().signature.outputs;
  const bool has_trust = std::any_of(outputs.begin(), outputs.end(),
                                     [](const auto& output) { return output.name == "trust"; });
  if (!has_trust && rest.empty()) return std::nullopt;
  return RowProgram(rest, graph.file().initialisers, {{"pose", {6}}, {"wrench", {2, 6}}},
                    {{"error", {2, 6}}, {"trust", {}}});
}

}  // namespace

struct FusedSurrogate::Impl {
  explicit Impl(const OnnxFile& file) {
    GraphTemplate graph(file);
    if (resembles_potential(graph)) {
      architecture = "potential";
      networks = match_potential(graph);
    } else {
      networks = match_two_stage(graph);
    }
    judgement = match_trust(graph);
  }

  std::string architecture = "two_stage";
  std::unique_ptr<WrenchNetworks> networks;
  std::optional<RowProgram> judgement;
};

FusedSurrogate::FusedSurrogate(const OnnxFile& file) : impl_(std::make_unique<Impl>(file)) {}
FusedSurrogate::~FusedSurrogate() = default;
FusedSurrogate::FusedSurrogate(FusedSurrogate&&) noexcept = default;
FusedSurrogate& FusedSurrogate::operator=(FusedSurrogate&&) noexcept = default;

const std::string& FusedSurrogate::architecture() const { return impl_->architecture; }
const char* FusedSurrogate::instruction_set() const { return dense_kernels().instruction_set; }

void FusedSurrogate::evaluate(std::span<const Pose> poses, const FusedOutputs& outputs) const {
  DenseWorkspace workspace;
  const bool judges = outputs.error != nullptr || outputs.trust != nullptr;
  const std::size_t most = impl_->networks->max_poses(outputs.stiffness != nullptr);
  const auto at = [](double* first, std::size_t row, std::size_t width) {
    return first == nullptr ? nullptr : first + row * width;
  };
  for (std::size_t row = 0; row < poses.size(); row += most) {
    const auto piece = poses.subspan(row, std::min(most, poses.size() - row));
    double* wrench = outputs.wrench + row * kWrench;
    impl_->networks->evaluate(piece, workspace, wrench, at(outputs.stiffness, row, kStiffness));
    if (!judges) continue;
    const std::array<const double*, 2> read{piece.front().data(), wrench};
    const std::array<double*, 2> written{at(outputs.error, row, kWrench),
                                         at(outputs.trust, row, 1)};
    impl_->judgement->run(piece.size(), read, written);
  }
}

}  // namespace condyle::surrogate
