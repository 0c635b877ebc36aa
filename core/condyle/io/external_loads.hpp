// SPDX-License-Identifier: Apache-2.0
// Loads on bodies over time, from the table that an external-loads file names.
//
// Between the table's rows each component is a natural cubic spline, as in OpenSim (ExternalForce: a GCV spline of degree 3).
// A row in which the force is zero needs no point and no moment: NaN there is a moment of zero, and the point moves straight
// between its neighbours. Any other gap is refused: NaN, and a step in time of more than 1.5 of the usual ones next to a
// load that is not zero.
#pragma once

#include <string>
#include <vector>

#include "condyle/common/types.hpp"
#include "condyle/io/external_loads_file.hpp"
#include "condyle/io/motion_file.hpp"
#include "condyle/model/external_load.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/model_description.hpp"
#include "condyle/numerics/natural_spline.hpp"

namespace condyle::io {

struct ExternalLoadsSettings {
  /// A force up to this counts as zero where the table has no point or moment for it [N]. Laboratories that leave out the
  /// centre of pressure below a threshold need that threshold here.
  double negligible_force = 0.0;
};

/// A load on a body at one time, in the frames in which the table has it.
struct BodyLoad {
  std::string body;
  std::string force_frame;  ///< body in which force and moment are expressed; "ground"
  std::string point_frame;  ///< body in whose frame the point is; "ground"
  Vector3 force = Vector3::Zero();   ///< [N]
  Vector3 point = Vector3::Zero();   ///< [m]
  Vector3 moment = Vector3::Zero();  ///< free moment [Nm]
};

class ExternalLoads {
 public:
  /// @param data the table, read with allow_nan.
  /// @throws std::invalid_argument naming the table, the force, column and time span of a gap; or a column that is not
  /// there, with the near miss.
  ExternalLoads(ExternalLoadsSpec spec, const Motion& data,
                const ExternalLoadsSettings& settings = {});
  /// Reads both files.
  static ExternalLoads read(const std::filesystem::path& file,
                            const ExternalLoadsSettings& settings = {});

  const ExternalLoadsSpec& spec() const { return spec_; }
  double first_time() const { return spline_.first(); }
  double last_time() const { return spline_.last(); }

  /// One load for each force of the spec, in its order.
  /// @param time [s]; one step of the table beyond its ends is taken as the end.
  /// @throws std::invalid_argument naming the table, the time and the table's span.
  std::vector<BodyLoad> at(double time) const;

  /// Refuses bodies that a model lacks. @throws std::invalid_argument naming file, force, body and the near miss.
  void require_bodies(const model::ModelDescription& model) const;

  /// The loads in ground, at the placements that the bodies have now.
  /// @throws std::invalid_argument as `at`, and for a body that the model lacks.
  std::vector<model::ExternalLoad> in_ground(double time,
                                             const model::Kinematics& kinematics) const;

 private:
  ExternalLoadsSpec spec_;
  std::string table_;  ///< for messages
  double step_ = 0.0;  ///< usual step of the table [s]
  numerics::NaturalSpline spline_;  ///< force, point, moment of each force: 9 columns
};

}  // namespace condyle::io
