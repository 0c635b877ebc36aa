// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "arrays.hpp"
#include "condyle/model/kinematics.hpp"
#include "condyle/model/model.hpp"
#include "condyle/model/path.hpp"
#include "condyle/model/path_route.hpp"

namespace condyle::bindings {
namespace {

using namespace condyle::model;

template <typename Item>
std::vector<std::string> names(const std::vector<Item>& items) {
  std::vector<std::string> found;
  for (const Item& item : items) found.push_back(item.name);
  return found;
}

template <typename Item, typename Get>
auto column(const std::vector<Item>& items, Get get) {
  std::vector<decltype(get(items.front()))> values;
  for (const Item& item : items) values.push_back(get(item));
  return values;
}

std::string role(const CoordinateDescription& coordinate) {
  return coordinate.role == CoordinateRole::kDriven ? "driven" : "force_dependent";
}
std::string balance(const CoordinateDescription& coordinate) {
  return coordinate.balance == CoordinateBalance::kMuscles ? "muscles" : "reaction";
}

/// A path as it lies, in ground (k, 3).
nb::ndarray<nb::numpy, double> path_line(const Kinematics& kinematics, const PathDescription& description,
                                         const PathSnapshot* held) {
  PathSnapshot line;
  if (held == nullptr) {
    const Path path(kinematics.model(), description, "path");
    PathWorkspace workspace;
    line = path.snapshot(kinematics, workspace);
    held = &line;
  }
  std::vector<double> points;
  for (const HeldPoint& point : held->points) {
    const Vector3 p = kinematics.X_GB(point.body) * point.location;
    points.insert(points.end(), p.data(), p.data() + 3);
  }
  return to_numpy(std::move(points), {held->points.size(), 3});
}

/// Placements (k, 4, 4) of frames fixed to bodies.
template <typename Item, typename Get>
nb::ndarray<nb::numpy, double> placements(const Kinematics& kinematics, const std::vector<Item>& items,
                                          Get frame) {
  std::vector<double> values;
  for (const Item& item : items) {
    const FrameDescription& at = frame(item);
    const RigidTransform X_GB =
        kinematics.X_GB(at.body == kGround ? -1 : kinematics.model().body(at.body));
    const RigidTransform X = X_GB * placement(at);
    for (int i = 0; i < 3; ++i) {
      values.insert(values.end(), {X.R(i, 0), X.R(i, 1), X.R(i, 2), X.p[i]});
    }
    values.insert(values.end(), {0.0, 0.0, 0.0, 1.0});
  }
  return to_numpy(std::move(values), {items.size(), 4, 4});
}

void bind_model_class(nb::module_& m) {
  nb::class_<Model> c(m, "Model", "A musculoskeletal model, checked and compiled.");
  c.def(nb::init<ModelDescription>(), nb::arg("description"),
        "Raises ValueError naming source, item, field, value and limit.");
  const auto list = [&](const char* name, auto member) {
    c.def_prop_ro(name, [member](const Model& self) { return names(self.description().*member); });
  };
  list("body_names", &ModelDescription::bodies);
  list("joint_names", &ModelDescription::joints);
  list("coordinate_names", &ModelDescription::coordinates);
  list("muscle_names", &ModelDescription::muscles);
  list("ligament_names", &ModelDescription::ligaments);
  list("wrap_names", &ModelDescription::wraps);
  list("marker_names", &ModelDescription::markers);
  list("contact_surface_names", &ModelDescription::contact_surfaces);
  list("contact_pair_names", &ModelDescription::contact_pairs);
  const auto of_coordinates = [&](const char* name, auto get) {
    c.def_prop_ro(name, [get](const Model& self) { return column(self.description().coordinates, get); });
  };
  of_coordinates("coordinate_roles", role);
  of_coordinates("coordinate_balances", balance);
  of_coordinates("coordinate_defaults", [](const CoordinateDescription& q) { return q.default_value; });
  of_coordinates("coordinate_minima", [](const CoordinateDescription& q) { return q.range_min; });
  of_coordinates("coordinate_maxima", [](const CoordinateDescription& q) { return q.range_max; });
  of_coordinates("coordinate_is_rotational", [](const CoordinateDescription& q) { return q.rotational; });
  of_coordinates("coordinate_is_locked", [](const CoordinateDescription& q) { return q.locked; });
  c.def_prop_ro("coordinate_needs_motion", [](const Model& self) {
    auto needs = column(self.description().coordinates, [](const CoordinateDescription& q) { return !q.locked; });
    for (const CouplingDescription& coupling : self.description().couplings) {
      needs[static_cast<std::size_t>(self.coordinate(coupling.dependent))] = false;
    }
    return needs;
  }, "Of each coordinate: neither locked nor following another.");
  c.def_prop_ro("coupled_coordinates", [](const Model& self) {
     return column(self.description().couplings, [](const CouplingDescription& c) { return c.dependent; });
   }).def_prop_ro("sprung_coordinates", [](const Model& self) {
     return column(self.description().springs, [](const SpringDescription& s) { return s.coordinate; });
   }).def_prop_ro("gravity", [](const Model& self) { return to_numpy(self.description().gravity); },
                  nb::rv_policy::move, "(3,) [m/s²].");
  c.def_prop_ro("name", [](const Model& self) { return self.description().name; })
      .def_prop_ro("source", [](const Model& self) { return self.description().source; })
      .def_prop_ro("description", &Model::description, nb::rv_policy::copy)
      .def_prop_ro("masses", [](const Model& self) {
        return column(self.description().bodies, [](const BodyDescription& body) { return body.mass; });
      })
      .def_prop_ro("muscle_max_forces", [](const Model& self) {
        return column(self.description().muscles, [](const MuscleDescription& m) { return m.max_isometric_force; });
      })
      .def_prop_ro("parents", [](const Model& self) {
        std::vector<int> parents;
        for (int body = 0; body < self.n_bodies(); ++body) parents.push_back(self.parent(body));
        return parents;
      }, "Of each body: the body that its joint hangs it on; -1: ground.")
      .def_prop_ro("joint_children", [](const Model& self) {
        return column(self.description().joints,
                      [&](const JointDescription& joint) { return self.body(joint.child.body); });
      }, "Of each joint: the body that hangs on it.")
      .def_prop_ro("contact_surface_files", [](const Model& self) {
        return column(self.description().contact_surfaces,
                      [](const ContactSurfaceDescription& surface) { return surface.mesh; });
      });
}

void bind_kinematics(nb::module_& m) {
  nb::class_<Kinematics>(m, "Kinematics", "Where everything is at one configuration.")
      .def("__init__", [](Kinematics* self, const Model& model, const VectorIn& q) {
             new (self) Kinematics(model);
             self->set(Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.shape(0))));
           },
           nb::arg("model"), nb::arg("q"), nb::keep_alive<1, 2>())
      .def_prop_ro("q", [](const Kinematics& self) { return to_numpy(self.q()); }, nb::rv_policy::move)
      .def_prop_ro("body_placements", [](const Kinematics& self) {
        std::vector<FrameDescription> bodies(self.model().description().bodies.size());
        for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].body = self.model().description().bodies[i].name;
        return placements(self, bodies, [](const FrameDescription& body) -> const FrameDescription& { return body; });
      }, nb::rv_policy::move, "(bodies, 4, 4) in ground.")
      .def_prop_ro("child_placements", [](const Kinematics& self) {
        return placements(self, self.model().description().joints,
                          [](const JointDescription& joint) -> const FrameDescription& { return joint.child; });
      }, nb::rv_policy::move, "(joints, 4, 4) child frames in ground.")
      .def_prop_ro("surface_placements", [](const Kinematics& self) {
        return placements(self, self.model().description().contact_surfaces,
                          [](const ContactSurfaceDescription& s) -> const FrameDescription& { return s.frame; });
      }, nb::rv_policy::move, "(surfaces, 4, 4) of the meshes' coordinates in ground.")
      .def_prop_ro("markers", [](const Kinematics& self) {
        std::vector<double> points;
        const auto& markers = self.model().description().markers;
        for (const MarkerDescription& marker : markers) {
          const Vector3 p = self.X_GB(marker.body == kGround ? -1 : self.model().body(marker.body)) *
                            marker.location;
          points.insert(points.end(), p.data(), p.data() + 3);
        }
        return to_numpy(std::move(points), {markers.size(), 3});
      }, nb::rv_policy::move, "(markers, 3) in ground [m].")
      .def_prop_ro("mass_centres", [](const Kinematics& self) {
        std::vector<double> points;
        const auto& bodies = self.model().description().bodies;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
          const Vector3 p = self.X_GB(static_cast<int>(i)) * bodies[i].mass_centre;
          points.insert(points.end(), p.data(), p.data() + 3);
        }
        return to_numpy(std::move(points), {bodies.size(), 3});
      }, nb::rv_policy::move, "(bodies, 3) in ground [m].")
      .def("muscle_line", [](const Kinematics& self, std::size_t i, const PathSnapshots* held, std::size_t row) {
             const auto& muscle = self.model().description().muscles.at(i);
             return path_line(self, muscle.path, held == nullptr ? nullptr : held->find(muscle.name, row));
           },
           nb::arg("muscle"), nb::arg("snapshots").none(), nb::arg("row"), "(k, 3) in ground [m].")
      .def("ligament_line", [](const Kinematics& self, std::size_t i, const PathSnapshots* held, std::size_t row) {
             const auto& ligament = self.model().description().ligaments.at(i);
             return path_line(self, ligament.path, held == nullptr ? nullptr : held->find(ligament.name, row));
           },
           nb::arg("ligament"), nb::arg("snapshots").none(), nb::arg("row"), "(k, 3) in ground [m].");
}

}  // namespace

void bind_model(nb::module_& m) {
  bind_model_class(m);
  bind_kinematics(m);
}

}  // namespace condyle::bindings
