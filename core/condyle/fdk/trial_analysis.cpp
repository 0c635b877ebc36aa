// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/trial_analysis.hpp"

#include <algorithm>
#include <stdexcept>

#include "condyle/common/parallel.hpp"
#include "condyle/model/model_checks.hpp"

namespace condyle::fdk {
namespace {

/// Time frames of one piece of work: enough that making its workspace does not show.
constexpr std::size_t kChunk = 32;

[[noreturn]] void refuse(const model::Model& model, const std::string& text) {
  throw std::invalid_argument(model_label(model.description()) + ": " + text);
}

void require_valid(const model::Model& model, const TrialInput& input, const TrialParts& parts) {
  const Eigen::Index frames = input.q.rows(), n = model.n_coordinates();
  const auto shape = [&](const TimeFrames& table, const char* what) {
    if (table.rows() == frames && table.cols() == n) return;
    refuse(model, std::string(what) + " has " + std::to_string(table.rows()) + " × " +
                      std::to_string(table.cols()) + " values; it must have " + std::to_string(frames) +
                      " time frames × " + std::to_string(n) + " coordinates");
  };
  shape(input.q, "q");
  shape(input.qd, "qd");
  shape(input.qdd, "qdd");
  const auto count = static_cast<std::size_t>(frames);
  if (!input.loads.empty() && input.loads.size() != count) {
    refuse(model, "external loads of " + std::to_string(input.loads.size()) + " time frames for " +
                      std::to_string(count) + " of motion");
  }
  if (input.snapshots != nullptr) {
    if (input.snapshot_rows.size() != count) {
      refuse(model, "snapshot_rows has " + std::to_string(input.snapshot_rows.size()) + " values for " +
                        std::to_string(count) + " time frames");
    }
    for (const std::size_t row : input.snapshot_rows) {
      if (row >= input.snapshots->times.size()) {
        refuse(model, "snapshot_rows holds " + std::to_string(row) + "; the snapshots have " +
                          std::to_string(input.snapshots->times.size()) + " times");
      }
    }
  }
  if (parts.recruitment && !(parts.dynamics && parts.muscles && parts.ligaments)) {
    refuse(model, "recruitment needs dynamics, muscles and ligaments");
  }
}

TrialAnalysis make_room(const model::Model& model, const MusculoskeletalFrame& frame, Eigen::Index frames,
                        const TrialParts& parts) {
  const Eigen::Index n = model.n_coordinates();
  const auto m = static_cast<Eigen::Index>(model.description().muscles.size());
  const auto s = static_cast<Eigen::Index>(model.description().ligaments.size());
  const auto k = static_cast<Eigen::Index>(frame.balanced().size());
  TrialAnalysis out;
  const auto room = [&](bool wanted, TimeFrames& table, Eigen::Index columns) {
    if (wanted) table.setZero(frames, columns);
  };
  room(true, out.segment_poses, 12 * model.n_bodies());
  room(parts.dynamics, out.generalised_forces, n);
  for (TimeFrames* table : {&out.muscle_lengths, &out.muscle_velocities, &out.muscle_strengths,
                            &out.passive_forces}) {
    room(parts.muscles, *table, m);
  }
  room(parts.muscles, out.moment_arms, n * m);
  for (TimeFrames* table : {&out.ligament_lengths, &out.ligament_strains, &out.ligament_forces}) {
    room(parts.ligaments, *table, s);
  }
  for (TimeFrames* table : {&out.ligament_loads, &out.spring_loads}) room(parts.ligaments, *table, n);
  for (TimeFrames* table : {&out.muscle_forces, &out.activities}) room(parts.recruitment, *table, m);
  room(parts.recruitment, out.reserves, k);
  room(parts.recruitment, out.residuals, n);
  if (parts.recruitment) {
    out.status.resize(static_cast<std::size_t>(frames));
    out.messages.resize(static_cast<std::size_t>(frames));
    out.kkt.resize(static_cast<std::size_t>(frames));
  }
  return out;
}

void keep_segments(const MusculoskeletalFrame& frame, Eigen::Index row, TrialAnalysis& out) {
  for (int body = 0; body < frame.kinematics().model().n_bodies(); ++body) {
    const RigidTransform& X_GB = frame.kinematics().X_GB(body);
    auto place = out.segment_poses.row(row).segment<12>(12 * body);
    for (int i = 0; i < 3; ++i) place.segment<3>(3 * i) = X_GB.R.row(i);
    place.tail<3>() = X_GB.p.transpose();
  }
}

void keep_muscles(const MusculoskeletalFrame& frame, Eigen::Index row, TrialAnalysis& out) {
  const auto m = static_cast<Eigen::Index>(frame.muscles().size());
  for (Eigen::Index i = 0; i < m; ++i) {
    const MuscleNow& now = frame.muscles()[static_cast<std::size_t>(i)];
    out.muscle_lengths(row, i) = now.length;
    out.muscle_velocities(row, i) = now.velocity;
    out.muscle_strengths(row, i) = now.strength.strength;
    out.passive_forces(row, i) = now.strength.passive;
  }
  for (Eigen::Index c = 0; c < frame.moment_arms().rows(); ++c) {
    out.moment_arms.row(row).segment(c * m, m) = frame.moment_arms().row(c);
  }
}

void keep_ligaments(const MusculoskeletalFrame& frame, Eigen::Index row, TrialAnalysis& out) {
  out.ligament_lengths.row(row) = frame.strand_loads().length.transpose();
  out.ligament_strains.row(row) = frame.strand_loads().strain.transpose();
  out.ligament_forces.row(row) = frame.strand_loads().force.transpose();
  out.ligament_loads.row(row) = frame.ligament_forces().transpose();
  out.spring_loads.row(row) = frame.spring_forces().transpose();
}

void keep_recruitment(const MusculoskeletalFrame& frame, const recruitment::Recruitment& result,
                      const std::string& message, Eigen::Index row, TrialAnalysis& out) {
  out.muscle_forces.row(row) = frame.muscle_forces().transpose();
  out.activities.row(row) = result.activities.transpose();
  out.reserves.row(row) = result.reserves.transpose();
  out.residuals.row(row) = frame.residual().transpose();
  const auto i = static_cast<std::size_t>(row);
  out.status[i] = result.status;
  out.messages[i] = message;
  out.kkt[i] = result.kkt.largest();
}

void analyse(MusculoskeletalFrame& frame, const TrialInput& input, const TrialParts& parts, Eigen::Index row,
             TrialAnalysis& out) {
  frame.set_motion(input.q.row(row).transpose(), input.qd.row(row).transpose(),
                   input.qdd.row(row).transpose());
  keep_segments(frame, row, out);
  const auto i = static_cast<std::size_t>(row);
  if (parts.dynamics) {
    frame.compute_dynamics(input.loads.empty() ? std::span<const model::ExternalLoad>{} : input.loads[i]);
    out.generalised_forces.row(row) = frame.generalised_forces().transpose();
  }
  frame.hold_paths(input.snapshots, input.snapshots == nullptr ? 0 : input.snapshot_rows[i]);
  if (parts.muscles) {
    frame.compute_muscles();
    keep_muscles(frame, row, out);
  }
  if (parts.ligaments) {
    frame.compute_ligaments();
    keep_ligaments(frame, row, out);
  }
  if (parts.recruitment) {
    const recruitment::Recruitment& result = frame.recruit();
    keep_recruitment(frame, result, frame.recruitment_message(), row, out);
  }
}

}  // namespace

TrialAnalysis analyse_trial(const model::Model& model, const TrialInput& input, const MuscleSettings& settings,
                            const TrialParts& parts, int threads) {
  require_valid(model, input, parts);
  const auto frames = static_cast<std::size_t>(input.q.rows());
  TrialAnalysis out = make_room(model, MusculoskeletalFrame(model, settings), input.q.rows(), parts);
  parallel_for((frames + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    MusculoskeletalFrame frame(model, settings);
    const std::size_t end = std::min(frames, (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      try {
        analyse(frame, input, parts, static_cast<Eigen::Index>(i), out);
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("time frame " + std::to_string(i) + ": " + error.what());
      }
    }
  });
  return out;
}

}  // namespace condyle::fdk
