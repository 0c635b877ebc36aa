// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/path.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace condyle::model {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The free coordinate behind each coordinate of the model.
std::vector<int> free_coordinates(const Model& model) {
  std::vector<int> free(at(model.n_coordinates()));
  for (int c = 0; c < model.n_coordinates(); ++c) free[at(c)] = c;
  for (const ModelCoupling& c : model.couplings()) free[at(c.dependent)] = free[at(c.independent)];
  return free;
}

}  // namespace

Path::Path(const Model& model, const PathDescription& description, std::string owner)
    : owner_(std::move(owner)) {
  if (description.points.size() < 2) {
    refuse("path.points: " + std::to_string(description.points.size()) + ": must be at least 2");
  }
  compile_points(model, description);
  compile_wraps(model, description);
  compile_chains(model);
}

void Path::refuse(const std::string& what) const {
  throw std::invalid_argument(owner_ + ": " + what);
}

int Path::slot(int body) {
  const auto found = std::find(bodies_.begin(), bodies_.end(), body);
  if (found != bodies_.end()) return static_cast<int>(found - bodies_.begin());
  bodies_.push_back(body);
  return static_cast<int>(bodies_.size()) - 1;
}

void Path::compile_points(const Model& model, const PathDescription& description) {
  int moving_points = 0;
  for (std::size_t i = 0; i < description.points.size(); ++i) {
    const PathPointDescription& from = description.points[i];
    const std::string item = "path.points[" + std::to_string(i) + "]";
    // The model names itself and the name it does not know; the owner and the field go before.
    const auto found = [&](const char* field, auto&& look_up) {
      try {
        return look_up();
      } catch (const std::invalid_argument& error) {
        refuse(item + field + ": " + error.what());
        throw;
      }
    };
    PathPoint point;
    point.slot = slot(found(".body", [&] { return model.body(from.body); }));
    if (!from.location.allFinite()) refuse(item + ".location is not finite");
    point.location = from.location;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const TermDescription& term : from.moving[k]) {
        const int c = found(".moving", [&] { return model.coordinate(term.coordinate); });
        point.moving[k].push_back({c, term.function});
        point.motion = moving_points;
      }
    }
    if (point.motion >= 0) ++moving_points;
    if (from.condition_coordinate) {
      point.condition_coordinate =
          found(".condition", [&] { return model.coordinate(*from.condition_coordinate); });
      point.condition_min = from.condition_min;
      point.condition_max = from.condition_max;
      if (!(point.condition_min <= point.condition_max)) {
        refuse(item + ".condition: min is " + std::to_string(point.condition_min) +
               ": must not be above max, " + std::to_string(point.condition_max));
      }
    }
    points_.push_back(std::move(point));
  }
}

void Path::compile_wraps(const Model& model, const PathDescription& description) {
  const int n_points = static_cast<int>(points_.size());
  for (std::size_t i = 0; i < description.wraps.size(); ++i) {
    const PathWrapDescription& wrap = description.wraps[i];
    const std::string item = "path.wraps[" + std::to_string(i) + "]";
    const auto& surfaces = model.description().wraps;
    const auto surface = std::find_if(surfaces.begin(), surfaces.end(),
                                      [&](const auto& s) { return s.name == wrap.wrap; });
    if (surface == surfaces.end()) {
      refuse(item + ".wrap is '" + wrap.wrap + "': the model has no wrapping surface of that name");
    }
    PathCylinder cylinder;
    cylinder.first_point = wrap.first_point < 0 ? 0 : wrap.first_point;
    cylinder.last_point = wrap.last_point < 0 ? n_points - 1 : wrap.last_point;
    if (cylinder.first_point > cylinder.last_point || cylinder.last_point >= n_points) {
      refuse(item + ": first_point " + std::to_string(wrap.first_point) + ", last_point " +
             std::to_string(wrap.last_point) + ": must be ascending and at most " +
             std::to_string(n_points - 1));
    }
    if (!surface->active) continue;
    if (surface->kind != WrapKind::kCylinder) {
      wraps_ignored_.push_back(surface->name);
      slot(model.body(surface->frame.body));  // held points may sit on it
      continue;
    }
    const std::string owner = owner_ + ": " + item + " '" + surface->name + "'";
    cylinder.surface =
        make_cylinder(surface->dimensions[0], surface->dimensions[1], surface->quadrant, owner);
    cylinder.slot = slot(model.body(surface->frame.body));
    cylinder.X_BC = placement(surface->frame);
    cylinders_.push_back(cylinder);
  }
}

void Path::compile_chains(const Model& model) {
  const int n = static_cast<int>(bodies_.size());
  std::vector<int> motion_of_axis(at(model.n_axes()), -1);
  chains_.resize(bodies_.size() * bodies_.size());
  for (int from = 0; from < n; ++from) {
    for (int to = 0; to < n; ++to) {
      std::vector<ChainStep>& chain = chains_[at(from) * bodies_.size() + at(to)];
      const auto a = model.axes_to(bodies_[at(from)]), b = model.axes_to(bodies_[at(to)]);
      const auto [a_own, b_own] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
      // Out along the branch of `from`, its last axis first, and up that of `to`.
      for (auto it = a.end(); it != a_own;) chain.push_back({*--it, 0, -1.0});
      for (auto it = b_own; it != b.end(); ++it) chain.push_back({*it, 0, 1.0});
      for (const ChainStep& step : chain) motion_of_axis[at(step.axis)] = 0;
    }
  }
  for (int axis = 0; axis < model.n_axes(); ++axis) {
    if (motion_of_axis[at(axis)] < 0) continue;
    motion_of_axis[at(axis)] = static_cast<int>(axes_.size());
    axes_.push_back(axis);
  }
  for (auto& chain : chains_) {
    for (ChainStep& step : chain) step.motion = motion_of_axis[at(step.axis)];
  }

  const std::vector<int> free = free_coordinates(model);
  coordinate_index_.assign(at(model.n_coordinates()), -1);
  const auto depends_on = [&](int c) {
    coordinate_index_[at(free[at(c)])] = 0;
    ++n_terms_;
  };
  for (const int axis : axes_) {
    for (const auto& term : model.axes()[at(axis)].terms) depends_on(term.coordinate);
  }
  int motion = static_cast<int>(axes_.size());
  for (PathPoint& point : points_) {
    for (const auto& terms : point.moving) {
      for (const auto& term : terms) depends_on(term.coordinate);
    }
    if (point.motion < 0) continue;
    point.motion = motion;
    motion += 3;
  }
  free_motion_ = motion;
  n_free_ = std::max(0, static_cast<int>(cylinders_.size()) - 1);
  for (int c = 0; c < model.n_coordinates(); ++c) {
    if (coordinate_index_[at(c)] < 0) continue;
    coordinate_index_[at(c)] = static_cast<int>(coordinates_.size());
    coordinates_.push_back(c);
  }
}

double Path::velocity(const Kinematics& kinematics,
                      const Eigen::Ref<const Eigen::VectorXd>& gradient) const {
  double velocity = 0.0;
  for (std::size_t i = 0; i < coordinates_.size(); ++i) {
    velocity += gradient[static_cast<Eigen::Index>(i)] * kinematics.qd()[coordinates_[i]];
  }
  return velocity;
}

}  // namespace condyle::model
