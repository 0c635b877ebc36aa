// SPDX-License-Identifier: Apache-2.0
// A simulated trial with all that its result files say of it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "condyle/fdk/trial_simulation.hpp"
#include "condyle/model/model.hpp"
#include "trial_contacts.hpp"
#include "trial_pressures.hpp"

namespace condyle::apps {

/// Shapes as TrialSimulation.
struct TrialRun {
  const model::Model& model;
  std::vector<double> times;            ///< (T) [s]
  std::vector<std::string> at_default;  ///< force-dependent coordinates without a column
  /// Files by what they are, in the order in which they are named.
  std::vector<std::pair<std::string, std::filesystem::path>> inputs;
  std::vector<TrialContact> contacts;
  fdk::TrialSimulationSettings settings;
  fdk::TrialSimulation simulation;
  std::vector<std::optional<ContactPressures>> pressures;  ///< of each contact; nothing: no meshes
  std::vector<std::string> balanced;                       ///< (k) coordinates that muscles balance
  std::vector<std::string> wraps_passed_by;  ///< not computed and not in the snapshots, in words
};

/// A value at a time frame.
struct Peak {
  std::string name;  ///< of what has it
  double value = 0.0;
  double time = 0.0;  ///< [s]
};

/// (T) largest net generalised force on a force-dependent coordinate, in units of its tolerance.
std::vector<double> scaled_residuals(const TrialRun& run);

/// Peak forces of contact c over the time frames in equilibrium [N]: total, medial, lateral Fy
/// (compression); of a pair of bodies the total |F| alone. Empty where none is in equilibrium.
std::vector<Peak> contact_peaks(const TrialRun& run, std::size_t c);
/// Of which load contact_peaks() are: "Fy", "|F|".
const char* peak_load(const TrialContact& contact);

/// The largest |value| of a table over the time frames in equilibrium, with its sign.
/// @param names of the columns. @returns nothing for an empty table or no such time frame.
std::optional<Peak> largest(const TrialRun& run, const fdk::TimeFrames& table,
                            std::span<const std::string> names);

/// Names of muscles, ligaments, coordinates.
template <typename Item>
std::vector<std::string> names_of(const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

}  // namespace condyle::apps
