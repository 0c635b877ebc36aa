// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/onnx_contact_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "condyle/common/parallel.hpp"
#include "condyle/surrogate/fused_surrogate.hpp"
#include "condyle/surrogate/graph_template.hpp"
#include "condyle/surrogate/onnx_contract.hpp"
#include "condyle/surrogate/onnx_file.hpp"
#include "condyle/surrogate/onnx_session.hpp"

namespace condyle::surrogate {

using contact::ContactLoads;
using contact::Derivatives;

namespace {

constexpr std::size_t kLoads = 6;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// The fused path writes both sides at once.
static_assert(sizeof(ContactLoads::wrench) == 2 * 6 * sizeof(double));
static_assert(sizeof(ContactLoads::stiffness) == 2 * 36 * sizeof(double));

/// A side's vector of six in row `row` of an output [N, 2, 6].
Eigen::Map<const Vector6> vector_at(const double* values, std::size_t row, int side) {
  return Eigen::Map<const Vector6>(values +
                                   (row * kSides + static_cast<std::size_t>(side)) * kLoads);
}

/// A side's matrix in row `row` of an output [N, 2, 6, 6].
Eigen::Map<const Matrix6> matrix_at(const double* values, std::size_t row, int side) {
  const std::size_t matrix = row * kSides + static_cast<std::size_t>(side);
  return Eigen::Map<const Matrix6>(values + matrix * kLoads * kLoads);
}

/// A network may overflow far away; nobody should use what it then says.
void distrust_overflow(const double* wrench, double& trust) {
  if (!Eigen::Map<const Eigen::Matrix<double, 12, 1>>(wrench).allFinite()) trust = 0.0;
}

ContactLoads read_row(const Contract& contract, std::span<const double* const> outputs,
                      std::size_t row, Derivatives derivatives) {
  ContactLoads loads;
  for (int side = 0; side < kSides; ++side) {
    loads.wrench[side] = vector_at(outputs[contract.wrench], row, side);
    if (derivatives == Derivatives::kStiffness) {
      loads.stiffness[side] = matrix_at(outputs[*contract.stiffness], row, side);
    }
    if (contract.error) {
      loads.error[side] = vector_at(outputs[*contract.error], row, side);
    } else {
      loads.error[side].setConstant(kUnknown);
    }
  }
  loads.trust = contract.trust ? outputs[*contract.trust][row] : kUnknown;
  distrust_overflow(loads.wrench.front().data(), loads.trust);
  return loads;
}

/// A constant that is not a number is in no graph on purpose.
void require_numbers(const OnnxFile& parsed, const std::string& file) {
  for (const auto& [constant, tensor] : parsed.initialisers) {
    const auto& values = tensor.doubles;
    if (std::any_of(values.begin(), values.end(), [](double x) { return std::isnan(x); })) {
      throw std::invalid_argument(file + ": constant " + constant +
                                  " is not finite: the file's weights are damaged");
    }
  }
}

/// Rows of a batch that pass through memory on the stack.
constexpr std::size_t kRows = 28;

/// Memory for a few poses' results, before they go where the caller wants them.
struct Rows {
  Rows() {}  // left as it is: clearing it would take longer than many a network
  std::array<double, kRows * 2 * kLoads> wrench;
  std::array<double, kRows * 2 * kLoads * kLoads> stiffness;
  std::array<double, kRows * 2 * kLoads> error;
  std::array<double, kRows> trust;
};

}  // namespace

const char* name(Runtime runtime) {
  switch (runtime) {
    case Runtime::kFused:
      return "fused";
    case Runtime::kOnnxruntime:
      return "onnxruntime";
    default:
      return "auto";
  }
}

Runtime runtime_from_name(const std::string& word) {
  for (const Runtime runtime : {Runtime::kAuto, Runtime::kFused, Runtime::kOnnxruntime}) {
    if (word == name(runtime)) return runtime;
  }
  throw std::invalid_argument("runtime is '" + word + "': must be auto, fused or onnxruntime");
}

struct OnnxContactModel::Impl {
  Impl(const std::filesystem::path& path, Runtime wanted) : file(path) {
    const OnnxFile parsed = read_onnx(path);
    contract = check_contract(parsed.signature, path.string());
    require_numbers(parsed, path.string());
    metadata = parsed.signature.metadata;
    if (wanted != Runtime::kOnnxruntime) try_fused(parsed);
    if (wanted == Runtime::kFused && !fused) {
      throw std::invalid_argument(path.string() +
                                  ": the fused runtime does not know its graph: " + refusal);
    }
    if (!fused) {
      session.emplace(path);
      contract = check_contract(session->signature(), path.string());
    }
    require_finite_outputs();
  }

  void try_fused(const OnnxFile& parsed) {
    try {
      fused.emplace(parsed);
    } catch (const UnknownGraph& unknown) {
      refusal = unknown.what();
    }
  }

  /// Damaged weights show at the first pose: deep in contact, where both sides' gates are open.
  void require_finite_outputs() const {
    const Pose probe = Pose::Zero();
    const Derivatives all = contract.stiffness ? Derivatives::kStiffness : Derivatives::kNone;
    const auto check = [&](const char* output, bool finite) {
      if (finite) return;
      throw std::invalid_argument(file.string() + ": output " + output +
                                  " is not finite at the pose 0: the file's weights are damaged");
    };
    evaluate({&probe, 1}, all, [&](std::size_t, const ContactLoads& loads) {
      for (const Side side : {kMedial, kLateral}) {
        check("wrench", loads.wrench[side].allFinite());
        check("stiffness", loads.stiffness[side].allFinite());
        check("error", !contract.error || loads.error[side].allFinite());
      }
      check("trust", !contract.trust || std::isfinite(loads.trust));
    });
  }

  void require_available(Derivatives derivatives) const {
    if (derivatives == Derivatives::kStiffness && !contract.stiffness) {
      throw std::invalid_argument(
          file.string() + ": stiffness was asked of a file that has the output wrench alone");
    }
  }

  /// Calls take(row, loads) for each of at most OnnxSession::kMaxRows poses.
  template <typename Take>
  void evaluate(std::span<const Pose> poses, Derivatives derivatives, const Take& take) const {
    if (fused) {
      evaluate_fused(poses, derivatives, take);
      return;
    }
    const auto read = [&](std::span<const double* const> outputs) {
      for (std::size_t row = 0; row < poses.size(); ++row) {
        take(row, read_row(contract, outputs, row, derivatives));
      }
    };
    // By reference: a std::function would else copy the captures to the heap.
    session->run(poses, std::cref(read));
  }

  template <typename Take>
  void evaluate_fused(std::span<const Pose> poses, Derivatives derivatives,
                      const Take& take) const {
    Rows rows;
    const bool stiffness = derivatives == Derivatives::kStiffness;
    const FusedOutputs outputs{rows.wrench.data(), stiffness ? rows.stiffness.data() : nullptr,
                               contract.error ? rows.error.data() : nullptr,
                               contract.trust ? rows.trust.data() : nullptr};
    ContactLoads loads;
    for (Wrench& unknown : loads.error) unknown.setConstant(kUnknown);
    for (std::size_t first = 0; first < poses.size(); first += kRows) {
      const auto piece = poses.subspan(first, std::min(kRows, poses.size() - first));
      fused->evaluate(piece, outputs);
      for (std::size_t row = 0; row < piece.size(); ++row) {
        std::copy_n(&rows.wrench[row * 12], 12, loads.wrench.front().data());
        if (stiffness) std::copy_n(&rows.stiffness[row * 72], 72, loads.stiffness.front().data());
        if (contract.error) std::copy_n(&rows.error[row * 12], 12, loads.error.front().data());
        loads.trust = contract.trust ? rows.trust[row] : kUnknown;
        distrust_overflow(loads.wrench.front().data(), loads.trust);
        take(first + row, loads);
      }
    }
  }

  /// Straight into the caller's arrays, where they take the wrench.
  void evaluate_fused_into(std::span<const Pose> poses, std::size_t first,
                           const contact::LoadSpans& loads) const {
    const auto at = [&](std::span<double> values, std::size_t width) {
      return values.empty() ? nullptr : values.data() + first * width;
    };
    const FusedOutputs outputs{at(loads.wrench, 12), at(loads.stiffness, 72),
                               contract.error ? at(loads.error, 12) : nullptr,
                               contract.trust ? at(loads.trust, 1) : nullptr};
    fused->evaluate(poses, outputs);
    for (std::size_t row = 0; row < poses.size(); ++row) {
      if (!loads.error.empty() && !contract.error) {
        std::fill_n(at(loads.error, 12) + 12 * row, 12, kUnknown);
      }
      if (!loads.implausible_depth.empty()) loads.implausible_depth[first + row] = false;
      if (loads.trust.empty()) continue;
      if (!contract.trust) loads.trust[first + row] = kUnknown;
      distrust_overflow(outputs.wrench + 12 * row, loads.trust[first + row]);
    }
  }

  /// The same for any number of poses, in pieces counted from the first.
  template <typename Take>
  void evaluate_pieces(std::span<const Pose> poses, Derivatives derivatives, int threads,
                       const Take& take) const {
    require_available(derivatives);
    contact::require_finite(poses);
    for_each_piece(poses, threads, [&](std::size_t first, std::span<const Pose> piece) {
      evaluate(piece, derivatives,
               [&](std::size_t row, const ContactLoads& loads) { take(first + row, loads); });
    });
  }

  /// Calls body(first, poses) for each piece.
  template <typename Body>
  void for_each_piece(std::span<const Pose> poses, int threads, const Body& body) const {
    constexpr std::size_t kPiece = OnnxSession::kMaxRows;
    const auto one = [&](std::size_t piece) {
      const std::size_t first = piece * kPiece;
      body(first, poses.subspan(first, std::min(kPiece, poses.size() - first)));
    };
    parallel_for((poses.size() + kPiece - 1) / kPiece, threads, std::cref(one));
  }

  std::filesystem::path file;
  std::map<std::string, std::string> metadata;
  Contract contract;
  std::string refusal;
  // One of the two.
  std::optional<FusedSurrogate> fused;
  std::optional<OnnxSession> session;
};

OnnxContactModel::OnnxContactModel(const std::filesystem::path& file, Runtime runtime)
    : impl_(std::make_unique<Impl>(file, runtime)) {}
OnnxContactModel::~OnnxContactModel() = default;
OnnxContactModel::OnnxContactModel(OnnxContactModel&&) noexcept = default;
OnnxContactModel& OnnxContactModel::operator=(OnnxContactModel&&) noexcept = default;

SideOfBody OnnxContactModel::side_of_body() const { return impl_->contract.side_of_body; }
bool OnnxContactModel::has_stiffness() const { return impl_->contract.stiffness.has_value(); }
const std::filesystem::path& OnnxContactModel::file() const { return impl_->file; }
Runtime OnnxContactModel::runtime() const {
  return impl_->fused ? Runtime::kFused : Runtime::kOnnxruntime;
}
const std::string& OnnxContactModel::fused_refusal() const { return impl_->refusal; }
std::string OnnxContactModel::instruction_set() const {
  return impl_->fused ? impl_->fused->instruction_set() : "";
}
const std::map<std::string, std::string>& OnnxContactModel::metadata() const {
  return impl_->metadata;
}

ContactLoads OnnxContactModel::evaluate(const Pose& pose, Derivatives derivatives) const {
  impl_->require_available(derivatives);
  contact::require_finite(pose);
  ContactLoads loads;
  impl_->evaluate({&pose, 1}, derivatives,
                  [&](std::size_t, const ContactLoads& found) { loads = found; });
  return loads;
}

void OnnxContactModel::evaluate_batch(std::span<const Pose> poses, Derivatives derivatives,
                                      int threads, std::span<ContactLoads> loads) const {
  if (loads.size() != poses.size()) {
    throw std::invalid_argument("evaluate_batch: " + std::to_string(loads.size()) +
                                " results for " + std::to_string(poses.size()) + " poses");
  }
  impl_->evaluate_pieces(poses, derivatives, threads,
                         [&](std::size_t row, const ContactLoads& found) { loads[row] = found; });
}

void OnnxContactModel::evaluate_into(std::span<const Pose> poses, int threads,
                                     const contact::LoadSpans& loads) const {
  loads.require_rows(poses.size());
  if (impl_->fused && !loads.wrench.empty()) {
    impl_->require_available(loads.derivatives());
    contact::require_finite(poses);
    impl_->for_each_piece(poses, threads, [&](std::size_t first, std::span<const Pose> piece) {
      impl_->evaluate_fused_into(piece, first, loads);
    });
    return;
  }
  impl_->evaluate_pieces(
      poses, loads.derivatives(), threads,
      [&](std::size_t row, const ContactLoads& found) { loads.write(row, found); });
}

}  // namespace condyle::surrogate
