// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/mesh_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "condyle/common/parallel.hpp"
#include "condyle/contact/implant_check.hpp"

namespace condyle::contact {
namespace {

// The checks that a knee's surfaces need, before anything is built of them.
ContactPair checked_pair(const geometry::TriangleMesh& femur, const InsertMeshes& insert,
                         SideOfBody side_of_body, const ContactLaw& law,
                         const MeshContactSettings& settings, const ImplantLayers& layers) {
  if (!std::isfinite(settings.plausible_depth) || settings.plausible_depth <= 0.0) {
    throw std::invalid_argument("plausible_depth is " + std::to_string(settings.plausible_depth) +
                                " m: must be finite and greater than 0");
  }
  require_femur(femur);
  require_insert(insert, side_of_body);
  PairLayers by_body{layers.femur, {}};
  if (!layers.insert[kMedial].empty() || !layers.insert[kLateral].empty()) {
    by_body.fixed = {layers.insert[kMedial], layers.insert[kLateral]};
  }
  return make_contact_pair(femur, {insert[kMedial], insert[kLateral]}, law, settings.pair, by_body);
}

SideDetail detail_of(const CompartmentLoads& loads, double plausible_depth) {
  SideDetail detail;
  detail.wrench = loads.wrench;
  detail.energy = loads.energy;
  detail.volume = loads.volume;
  detail.area = loads.area;
  detail.border_area = loads.border_area;
  detail.max_depth = loads.max_depth;
  detail.peak_pressure = loads.peak_pressure;
  if (loads.pressure_sum > 0.0) {
    detail.mean_pressure = loads.pressure_sum / loads.area;
    detail.centre_of_pressure = loads.pressure_moment / loads.pressure_sum;
  }
  detail.implausible_depth = loads.max_depth > plausible_depth;
  detail.back_face = loads.back_face;
  return detail;
}

std::string status_of(const ContactDetail& detail, double plausible_depth) {
  std::string status;
  const auto add = [&status](Side side, const char* format, auto... values) {
    char text[160];
    std::snprintf(text, sizeof text, format, values...);
    status += (status.empty() ? "" : "; ") + std::string(name(side)) + ": " + text;
  };
  for (const Side side : {kMedial, kLateral}) {
    const SideDetail& s = detail.sides[side];
    if (s.implausible_depth) {
      add(side, "depth %.3g mm is more than the plausible %.3g mm", 1e3 * s.max_depth,
          1e3 * plausible_depth);
    }
    if (s.back_face) add(side, "overlap reaches a back face");
    if (s.border_area > 0.0) {
      add(side, "%.3g mm^2 of overlap beyond the femoral surface's border left out",
          1e6 * s.border_area);
    }
  }
  return status.empty() ? "ok" : status;
}

}  // namespace

MeshContact::MeshContact(const geometry::TriangleMesh& femur, const InsertMeshes& insert,
                         SideOfBody side_of_body, const ContactLaw& law,
                         const MeshContactSettings& settings, const ImplantLayers& layers)
    : femur_(femur),
      insert_(insert),
      side_of_body_(side_of_body),
      law_(law),
      settings_(settings),
      pair_(checked_pair(femur, insert, side_of_body, law, settings, layers)) {}

double MeshContact::insert_width() const {
  const auto medial = insert_[kMedial].vertices.col(2), lateral = insert_[kLateral].vertices.col(2);
  return std::max(medial.maxCoeff(), lateral.maxCoeff()) -
         std::min(medial.minCoeff(), lateral.minCoeff());
}

bool MeshContact::implausible(const CompartmentLoads& loads) const {
  return loads.max_depth > settings_.plausible_depth || loads.back_face;
}

ContactLoads MeshContact::evaluate(const Pose& pose, Derivatives derivatives) const {
  require_finite(pose);
  ContactLoads loads;
  for (const Side side : {kMedial, kLateral}) {
    const CompartmentLoads one = pair_.evaluate(pose, side, derivatives);
    loads.wrench[side] = one.wrench;
    loads.stiffness[side] = one.stiffness;
    loads.implausible_depth |= implausible(one);
  }
  return loads;
}

ContactDetail MeshContact::evaluate_detail(const Pose& pose) const {
  require_finite(pose);
  ContactDetail detail;
  for (const Side side : {kMedial, kLateral}) {
    detail.sides[side] =
        detail_of(pair_.evaluate(pose, side, Derivatives::kNone), settings_.plausible_depth);
  }
  detail.status = status_of(detail, settings_.plausible_depth);
  return detail;
}

std::vector<ContactDetail> MeshContact::evaluate_details(std::span<const Pose> poses,
                                                         int threads) const {
  std::vector<ContactDetail> details(poses.size());
  parallel_for(poses.size(), threads, [&](std::size_t i) {
    try {
      details[i] = evaluate_detail(poses[i]);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("row " + std::to_string(i) + ": " + error.what());
    }
  });
  return details;
}

FacePressure MeshContact::face_pressure(const Pose& pose, Side side) const {
  require_finite(pose);
  return pair_.face_pressure(pose, side);
}

}  // namespace condyle::contact
