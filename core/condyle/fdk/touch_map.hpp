// SPDX-License-Identifier: Apache-2.0
// Where a contact model first touches, as a map over (x, θz): starts for equilibria without any guess from the user.
//
// A node of the map holds both sides' SideResponse at z = θx = θy = 0 and a light load; between nodes the laws are
// interpolated bilinearly. Nodes are found when first asked for, each from its own descent, so that a start does not depend on
// the order of questions or on the number of threads.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "condyle/contact/contact_model.hpp"
#include "condyle/fdk/side_response.hpp"

namespace condyle::fdk {

using KneeResponse = std::array<SideResponse, kSides>;

/// Where to look for contact.
struct TouchSearch {
  double y_high = 0.065;      ///< start of the descent: out of contact [m]
  double y_low = 0.020;       ///< end of the descent: no knee replacement rests this low [m]
  double step = 1e-3;         ///< of the descent [m]; half the plausible depth, so that first touch is not passed
  double light_load = 150.0;  ///< Fy that each side is brought to [N]
};

/// Throws std::invalid_argument naming the setting, its value and its limit.
void require_valid(const TouchSearch& search);

/// Lowers the femur from `search.y_high` at the x, z and angles of `pose` until the contact is loaded.
/// Poses that the model itself does not trust (trust < 0.5) count as unloaded: out there a surrogate's loads mean nothing.
/// @param pose its y is set to the first loaded one found.
/// @param loads the loads there, with stiffness.
/// @returns contact evaluations used; 0 < loads.total Fy where touch was found, no load otherwise.
int descend_to_contact(const contact::ContactModel& model, const TouchSearch& search, Pose& pose,
                       contact::ContactLoads& loads);

/// Both sides' local laws at a light load, at the x, z, θy, θz of `pose` and its θx.
/// @param evaluations is increased by the contact evaluations used.
KneeResponse light_contact(const contact::ContactModel& model, const TouchSearch& search, Pose pose,
                           int& evaluations);

class TouchMap {
 public:
  /// `model` must outlive the map.
  TouchMap(const contact::ContactModel& model, const TouchSearch& search);
  ~TouchMap();
  TouchMap(const TouchMap&) = delete;
  TouchMap& operator=(const TouchMap&) = delete;

  /// The laws to start from at a pose's x and θz. A side is known only where it touches at all four nodes around.
  /// Thread-safe.
  KneeResponse at(double x, double theta_z) const;

  /// Contact evaluations spent on nodes so far.
  long evaluations() const { return evaluations_.load(); }

 private:
  struct Node {
    std::once_flag once;
    KneeResponse response;
  };
  const KneeResponse& node(int i, int j) const;

  const contact::ContactModel& model_;
  const TouchSearch search_;
  const std::unique_ptr<Node[]> nodes_;
  mutable std::atomic<long> evaluations_{0};
};

}  // namespace condyle::fdk
