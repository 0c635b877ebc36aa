// SPDX-License-Identifier: Apache-2.0
// What every contact model is to the rest of Condyle: a map from a pose to a wrench per side.
// The mesh reference, the neural surrogate and any hybrid of them implement it, so that a solver takes either with one
// constructor argument. No CGAL, no onnxruntime here.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "condyle/common/pose.hpp"
#include "condyle/common/side.hpp"

namespace condyle::contact {

/// What to compute beside the wrench.
enum class Derivatives { kNone, kStiffness };

/// The answer of a contact model at one pose. Sides are indexed by condyle::Side: medial, lateral.
struct ContactLoads {
  /// Contact wrench on the femur, at Fo, expressed in T, per side [N, Nm].
  std::array<Wrench, kSides> wrench{Wrench::Zero(), Wrench::Zero()};
  /// ∂wrench_i/∂pose_j per side; zero unless Derivatives::kStiffness was asked for [N/m, N/rad, Nm/m, Nm/rad].
  std::array<Matrix6, kSides> stiffness{Matrix6::Zero(), Matrix6::Zero()};
  /// Calibrated 95 % bound on each load's error against the reference; zero where the model is the reference.
  std::array<Wrench, kSides> error{Wrench::Zero(), Wrench::Zero()};
  /// 1 well inside what the model knows, 0 outside; below 0.5 do not use. Always 1 for the reference.
  double trust = 1.0;
  /// The overlap is deeper than plausible, or reaches a back face: the numbers are finite, but not to be believed.
  bool implausible_depth = false;

  Wrench total_wrench() const { return wrench[kMedial] + wrench[kLateral]; }
  Matrix6 total_stiffness() const { return stiffness[kMedial] + stiffness[kLateral]; }
};

/// Where the loads of n poses go: arrays of the caller's, row-major, one row a pose; the fields are
/// those of ContactLoads. An empty span is not written; stiffness is computed where its span is not.
struct LoadSpans {
  std::span<double> wrench;           ///< n × 2 × 6
  std::span<double> stiffness;        ///< n × 2 × 6 × 6
  std::span<double> error;            ///< n × 2 × 6
  std::span<double> trust;            ///< n
  std::span<bool> implausible_depth;  ///< n

  Derivatives derivatives() const {
    return stiffness.empty() ? Derivatives::kNone : Derivatives::kStiffness;
  }

  /// Writes one pose's loads into row `row`. @pre require_rows() accepted more rows than that.
  void write(std::size_t row, const ContactLoads& loads) const;

  /// @throws std::invalid_argument unless each span that is not empty holds `rows` rows, naming it.
  void require_rows(std::size_t rows) const;
};

/// A frictionless elastic contact between the femoral component and the insert's two compartments.
///
/// Thread safety: evaluate() is const and may be called from many threads at once.
/// Errors: a pose with a value that is not finite is the caller's mistake: std::invalid_argument names the coordinate.
class ContactModel {
 public:
  virtual ~ContactModel() = default;

  /// The knee that the model was built for.
  virtual SideOfBody side_of_body() const = 0;

  /// The loads at one pose.
  virtual ContactLoads evaluate(const Pose& pose, Derivatives derivatives) const = 0;

  /// Many poses at once on `threads` threads (0: all); loads.size() must equal poses.size().
  /// The result is the same bytes for any number of threads. The default calls evaluate() for each pose.
  /// @throws std::invalid_argument on a size mismatch or a pose that is not finite, naming its row.
  virtual void evaluate_batch(std::span<const Pose> poses, Derivatives derivatives, int threads,
                              std::span<ContactLoads> loads) const;

  /// evaluate_batch() straight into arrays: the same numbers, and nothing allocated per pose but
  /// what evaluate() allocates.
  /// @throws std::invalid_argument if a span's size does not fit, naming it, or for a pose that is
  ///   not finite, naming its row.
  virtual void evaluate_into(std::span<const Pose> poses, int threads,
                             const LoadSpans& loads) const;
};

/// Throws std::invalid_argument naming the first coordinate of `pose` that is not finite, and its value.
void require_finite(const Pose& pose);

/// The same for many poses; the text begins with the row.
void require_finite(std::span<const Pose> poses);

}  // namespace condyle::contact
