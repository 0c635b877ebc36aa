// SPDX-License-Identifier: Apache-2.0
// A right leg's loads and moment arms as a simulator would give them: three coordinates, seven muscles, figures of a
// stance phase in round numbers, and random ones about them.
#pragma once

#include "condyle/fdk/given_loads.hpp"
#include "fdk/analytic_contact.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

inline fdk::GivenLoadsSetup leg_setup() {
  fdk::GivenLoadsSetup setup;
  setup.muscles.coordinates = 3;
  setup.muscles.muscles = 7;
  setup.muscles.coordinate_names = {"hip", "knee", "ankle"};
  setup.muscles.muscle_names = {"quadriceps", "hamstrings", "gastrocnemius", "soleus",
                                "tibialis",   "iliopsoas",  "gluteus"};
  setup.knee_coordinate = 1;
  setup.knee_counts_flexion = true;
  Pose reference = Pose::Zero();
  reference[kY] = 0.0421;
  setup.ligaments = model::default_ligaments(SideOfBody::kRight, reference);
  return setup;
}

/// Flexion 0.27 rad; the knee needs 15 Nm of extension, 540 N of compression, 13 Nm of adduction.
inline fdk::GivenLoadsFrame leg_frame() {
  fdk::GivenLoadsFrame frame;
  frame.flexion = 0.27;
  frame.loads.resize(3);
  frame.loads << -21.0, -15.0, -32.0;
  frame.secondary_loads << 23.0, 540.0, 11.0, -13.0, 1.3;
  frame.moment_arms.resize(3, 7);
  // clang-format off
  frame.moment_arms << 0.000, -0.061,  0.000,  0.000, 0.000, 0.052, -0.057,
                      -0.046,  0.036,  0.023,  0.000, 0.000, 0.000,  0.000,
                       0.000,  0.000, -0.044, -0.041, 0.036, 0.000,  0.000;
  frame.secondary_arms.resize(5, 7);
  frame.secondary_arms << -0.21,   0.27,  -0.41,  0.0, 0.0, 0.0, 0.0,
                          -0.97,  -0.95,  -0.88,  0.0, 0.0, 0.0, 0.0,
                           0.03,  -0.02,   0.04,  0.0, 0.0, 0.0, 0.0,
                          -0.002,  0.006,  0.001, 0.0, 0.0, 0.0, 0.0,
                           0.003,  0.002, -0.004, 0.0, 0.0, 0.0, 0.0;
  // clang-format on
  frame.strengths.resize(7);
  frame.strengths << 4700.0, 2300.0, 1800.0, 3600.0, 900.0, 1900.0, 2100.0;
  return frame;
}

/// Arms that turn with α: quadriceps to gastrocnemius.
inline void let_arms_move(fdk::GivenLoadsFrame& frame, Draw& draw) {
  const Eigen::Index n = frame.moment_arms.rows(), m = frame.moment_arms.cols();
  frame.arms_by_pose.setZero(5 * (n + 5), m);
  for (Eigen::Index i = 0; i < frame.arms_by_pose.rows(); ++i) {
    // Of the knee and of α only; of the order of 1 per metre of lever, 0.3 m per m.
    if (i % (n + 5) == 0 || i % (n + 5) == 2) continue;
    for (int k = 0; k < 3; ++k) frame.arms_by_pose(i, k) = draw(-0.3, 0.3);
  }
  frame.arms_at << 0.002, 0.0419, 0.0004, 0.001, -0.012;
}

/// A stance phase: loads rise and fall, the knee flexes.
inline std::vector<fdk::GivenLoadsFrame> leg_stance(int size) {
  std::vector<fdk::GivenLoadsFrame> frames;
  for (int i = 0; i < size; ++i) {
    const double t = static_cast<double>(i) / (size - 1);
    const double rise = 0.1 + std::sin(3.0 * t);
    fdk::GivenLoadsFrame frame = leg_frame();
    frame.flexion = 0.05 + 0.5 * t * t;
    frame.loads = rise * frame.loads;
    frame.loads[1] *= std::cos(4.0 * t);
    frame.secondary_loads = rise * frame.secondary_loads;
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace condyle::test
