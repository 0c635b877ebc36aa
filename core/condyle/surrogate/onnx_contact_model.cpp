// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/onnx_contact_model.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "condyle/common/parallel.hpp"
#include "condyle/surrogate/onnx_contract.hpp"
#include "condyle/surrogate/onnx_session.hpp"

namespace condyle::surrogate {

using contact::ContactLoads;
using contact::Derivatives;

namespace {

constexpr std::size_t kLoads = 6;

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

ContactLoads read_row(const Contract& contract, std::span<const double* const> outputs,
                      std::size_t row, Derivatives derivatives) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
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
  if (!loads.wrench[kMedial].allFinite() || !loads.wrench[kLateral].allFinite()) loads.trust = 0.0;
  return loads;
}

}  // namespace

struct OnnxContactModel::Impl {
  explicit Impl(const std::filesystem::path& path)
      : file(path), session(path), contract(check_contract(session.signature(), path.string())) {}

  /// Damaged weights show at the first pose: deep in contact, where both sides' gates are open.
  void require_finite_outputs() const {
    const Pose probe = Pose::Zero();
    session.run({&probe, 1}, [&](std::span<const double* const> outputs) {
      for (std::size_t i = 0; i < outputs.size(); ++i) {
        const TensorSignature& output = session.signature().outputs[i];
        Eigen::Index size = 1;
        for (std::size_t d = 1; d < output.shape.size(); ++d) size *= output.shape[d];
        if (!Eigen::Map<const Eigen::VectorXd>(outputs[i], size).allFinite()) {
          throw std::invalid_argument(
              file.string() + ": output " + output.name +
              " is not finite at the pose 0: the file's weights are damaged");
        }
      }
    });
  }

  void require_available(Derivatives derivatives) const {
    if (derivatives == Derivatives::kStiffness && !contract.stiffness) {
      throw std::invalid_argument(
          file.string() + ": stiffness was asked of a file that has the output wrench alone");
    }
  }

  /// Calls take(row, loads) for each of at most kMaxRows poses.
  template <typename Take>
  void evaluate(std::span<const Pose> poses, Derivatives derivatives, const Take& take) const {
    const auto read = [&](std::span<const double* const> outputs) {
      for (std::size_t row = 0; row < poses.size(); ++row) {
        take(row, read_row(contract, outputs, row, derivatives));
      }
    };
    // By reference: a std::function would else copy the captures to the heap.
    session.run(poses, std::cref(read));
  }

  /// The same for any number of poses, in pieces counted from the first.
  template <typename Take>
  void evaluate_pieces(std::span<const Pose> poses, Derivatives derivatives, int threads,
                       const Take& take) const {
    require_available(derivatives);
    contact::require_finite(poses);
    constexpr std::size_t kPiece = OnnxSession::kMaxRows;
    const auto body = [&](std::size_t piece) {
      const std::size_t first = piece * kPiece;
      const std::size_t count = std::min(kPiece, poses.size() - first);
      evaluate(poses.subspan(first, count), derivatives,
               [&](std::size_t row, const ContactLoads& loads) { take(first + row, loads); });
    };
    parallel_for((poses.size() + kPiece - 1) / kPiece, threads, std::cref(body));
  }

  std::filesystem::path file;
  OnnxSession session;
  Contract contract;
};

OnnxContactModel::OnnxContactModel(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(file)) {
  impl_->require_finite_outputs();
}
OnnxContactModel::~OnnxContactModel() = default;
OnnxContactModel::OnnxContactModel(OnnxContactModel&&) noexcept = default;
OnnxContactModel& OnnxContactModel::operator=(OnnxContactModel&&) noexcept = default;

SideOfBody OnnxContactModel::side_of_body() const { return impl_->contract.side_of_body; }
bool OnnxContactModel::has_stiffness() const { return impl_->contract.stiffness.has_value(); }
const std::filesystem::path& OnnxContactModel::file() const { return impl_->file; }
const std::map<std::string, std::string>& OnnxContactModel::metadata() const {
  return impl_->session.signature().metadata;
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
  impl_->evaluate_pieces(
      poses, loads.derivatives(), threads,
      [&](std::size_t row, const ContactLoads& found) { loads.write(row, found); });
}

}  // namespace condyle::surrogate
