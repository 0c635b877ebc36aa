// SPDX-License-Identifier: Apache-2.0
#include "trial_pressures.hpp"

#include <limits>

#include "condyle/common/parallel.hpp"
#include "condyle/contact/pair_contact_model.hpp"

namespace condyle::apps {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

PartPressure unknown() {
  return {Wrench::Constant(kNan), Vector3::Constant(kNan), kNan, kNan, kNan, kNan, kNan};
}

/// Out of contact there is no centre.
void drop_centre(PartPressure& part) {
  if (!(part.area > 0.0)) part.centre.setConstant(kNan);
}

std::vector<PartPressure> sides(const contact::MeshContact& meshes, const Pose& pose) {
  const contact::ContactDetail detail = meshes.evaluate_detail(pose);
  std::vector<PartPressure> parts;
  for (const contact::SideDetail& side : detail.sides) {
    parts.push_back({side.wrench, side.centre_of_pressure, side.peak_pressure, side.mean_pressure,
                     side.area, side.max_depth, side.border_area});
    drop_centre(parts.back());
  }
  return parts;
}

std::vector<PartPressure> whole(const contact::ContactPair& pair, const Pose& pose) {
  const contact::CompartmentLoads loads = pair.evaluate(pose, 0, contact::Derivatives::kNone);
  PartPressure part;
  part.wrench = loads.wrench;
  part.centre.setConstant(kNan);
  if (loads.pressure_sum > 0.0) part.centre = loads.pressure_moment / loads.pressure_sum;
  part.peak = loads.peak_pressure;
  part.area = loads.area;
  part.max_depth = loads.max_depth;
  part.border_area = loads.border_area;
  return {part};
}

}  // namespace

std::optional<ContactPressures> contact_pressures(const TrialContact& contact,
                                                  const fdk::TimeFrames& poses, Eigen::Index c,
                                                  int threads) {
  const auto* pair = dynamic_cast<const contact::PairContactModel*>(contact.contact.get());
  if (pair == nullptr && !contact.made.meshes) return std::nullopt;
  ContactPressures found;
  found.has_mean = pair == nullptr;
  found.parts = pair == nullptr ? std::vector<std::string>{"medial", "lateral"}
                                : std::vector<std::string>{"patella"};
  found.frames.resize(static_cast<std::size_t>(poses.rows()));
  parallel_for(found.frames.size(), threads, [&](std::size_t i) {
    const Pose pose = poses.row(static_cast<Eigen::Index>(i)).segment<6>(6 * c).transpose();
    if (!pose.allFinite()) {
      found.frames[i].assign(found.parts.size(), unknown());
    } else {
      found.frames[i] =
          pair == nullptr ? sides(*contact.made.meshes, pose) : whole(pair->pair(), pose);
    }
  });
  return found;
}

}  // namespace condyle::apps
