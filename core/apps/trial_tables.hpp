// SPDX-License-Identifier: Apache-2.0
// A simulated trial as tables: OpenSim's STO files, and a record of every time frame as CSV. Names
// and columns are those of the Python command's files (docs/simulation.md).
//
//   coordinates.sto …          q, generalised forces, residuals, muscles, ligaments, reserves
//   NAME_contact.sto           pose of F in T; wrench on F, at Fo, in T: medial, lateral, total;
//   error
//                              bounds; trust
//   NAME_kinematics.sto        clinical kinematics of F in T
//   NAME_pressures.sto         of the meshes: centre, peak, mean, area, depth; NAME_reference.sto
//                              beside a hybrid: their wrench
//   record.csv                 what became of each time frame
#pragma once

#include <string>
#include <vector>

#include "result_folder.hpp"
#include "trial_run.hpp"

namespace condyle::apps {

/// Every table of a run.
std::vector<ResultFile> trial_tables(const TrialRun& run);

}  // namespace condyle::apps
