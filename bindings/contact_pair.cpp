// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_pair.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "condyle/common/parallel.hpp"
#include "condyle/contact/contact_model.hpp"

namespace condyle::bindings {
namespace {

using namespace contact;
using geometry::TriangleMesh;

/// Every compartment's loads at n poses.
struct PairLoads {
  std::size_t poses, compartments;
  std::vector<CompartmentLoads> loads;  // compartment by compartment of a pose after another

  /// (n, c) of one number of `of` a compartment.
  template <typename Of>
  auto column(Of of) const {
    std::vector<double> values;
    values.reserve(loads.size());
    for (const auto& one : loads) values.push_back(of(one));
    return to_numpy(std::move(values), {poses, compartments});
  }

  /// (n, c, size) of one vector of `of` a compartment.
  template <std::size_t Size, typename Of>
  auto vectors(Of of) const {
    std::vector<double> values;
    values.reserve(loads.size() * Size);
    for (const auto& one : loads) {
      const auto vector = of(one);
      values.insert(values.end(), vector.data(), vector.data() + Size);
    }
    return to_numpy(std::move(values), {poses, compartments, Size});
  }
};

PairLoads evaluate(const ContactPair& pair, const PosesIn& array, Derivatives derivatives,
                   int threads) {
  const auto poses = as_poses(array);
  PairLoads result{poses.size(), pair.compartments(), {}};
  result.loads.resize(poses.size() * pair.compartments());
  nb::gil_scoped_release release;
  for (const Pose& pose : poses) require_finite(pose);
  parallel_for(poses.size(), threads, [&](std::size_t i) {
    for (std::size_t c = 0; c < pair.compartments(); ++c) {
      result.loads[i * pair.compartments() + c] = pair.evaluate(poses[i], c, derivatives);
    }
  });
  return result;
}

auto face_pressure(const ContactPair& pair, const PoseIn& pose, std::size_t compartment) {
  if (compartment >= pair.compartments()) {
    throw std::invalid_argument("compartment is " + std::to_string(compartment) +
                                ": must be less than " + std::to_string(pair.compartments()));
  }
  require_finite(as_pose(pose));
  const FacePressure faces = pair.face_pressure(as_pose(pose), compartment);
  return nb::make_tuple(to_numpy(faces.depth), to_numpy(faces.pressure));
}

void make_pair(ContactPair* pair, const TriangleMesh& moving,
               const std::vector<TriangleMesh>& fixed, const ContactLaw& law,
               const PairSettings& settings, const LayersIn& moving_layers,
               const std::vector<LayersIn>& fixed_layers) {
  PairLayers layers{as_layers(moving_layers), {}};
  for (const LayersIn& one : fixed_layers) layers.fixed.push_back(as_layers(one));
  nb::gil_scoped_release release;
  new (pair) ContactPair(make_contact_pair(moving, fixed, law, settings, layers));
}

Vector3 centre_of_pressure(const CompartmentLoads& loads) {
  if (!(loads.pressure_sum > 0.0)) return Vector3::Zero();
  return loads.pressure_moment / loads.pressure_sum;
}

void bind_loads(nb::module_& m) {
  using L = CompartmentLoads;
  constexpr auto kNew = nb::rv_policy::move;  // each access makes its own array
  const auto number = [](double L::* member) {
    return [member](const PairLoads& p) {
      return p.column([member](const L& l) { return l.*member; });
    };
  };
  nb::class_<PairLoads>(m, "PairLoads", "Loads of c compartments at n poses.")
      .def_prop_ro(
          "wrench",
          [](const PairLoads& p) { return p.vectors<6>([](const L& l) { return l.wrench; }); },
          kNew, "(n, c, 6) on the moving body, at its origin, in T [N, Nm].")
      .def_prop_ro(
          "stiffness",
          [](const PairLoads& p) { return p.vectors<36>([](const L& l) { return l.stiffness; }); },
          kNew, "(n, c, 36) d wrench_i / d pose_j, row by row.")
      .def_prop_ro("energy", number(&L::energy), kNew, "(n, c) [J]")
      .def_prop_ro("volume", number(&L::volume), kNew, "(n, c) [m^3]")
      .def_prop_ro("area", number(&L::area), kNew, "(n, c) of loaded faces [m^2]")
      .def_prop_ro("border_area", number(&L::border_area), kNew, "(n, c) that did not count [m^2]")
      .def_prop_ro("max_depth", number(&L::max_depth), kNew, "(n, c) [m]")
      .def_prop_ro("peak_pressure", number(&L::peak_pressure), kNew, "(n, c) [Pa]")
      .def_prop_ro(
          "centre_of_pressure",
          [](const PairLoads& p) { return p.vectors<3>(&centre_of_pressure); }, kNew,
          "(n, c, 3) in T [m]; zero out of contact");
}

}  // namespace

void bind_contact_pair(nb::module_& m) {
  using namespace nb::literals;
  nb::enum_<Evaluation>(m, "Evaluation")
      .value("exact", Evaluation::kExact)
      .value("fast", Evaluation::kFast);
  m.def(
      "evaluation", [](const std::string& name) { return evaluation_from_name(name); }, "name"_a,
      "Reads 'exact' or 'fast'.");
  nb::enum_<Integration>(m, "Integration")
      .value("fixed", Integration::kFixed)
      .value("moving", Integration::kMoving)
      .value("both", Integration::kBoth);
  m.def(
      "integration", [](const std::string& name) { return integration_from_name(name); }, "name"_a,
      "Reads 'fixed' (or 'insert'), 'moving' (or 'femur') or 'both'.");
  nb::class_<PairSettings>(m, "PairSettings")
      .def(nb::init<>())
      .def_rw("evaluation", &PairSettings::evaluation)
      .def_rw("integration", &PairSettings::integration)
      .def_prop_rw(
          "field_spacing", [](const PairSettings& s) { return s.field.spacing; },
          [](PairSettings& s, double spacing) { s.field.spacing = spacing; },
          "Of the fast evaluation's distance fields [m].")
      .def_rw("cache_directory", &PairSettings::cache_directory)
      .def_rw("threads", &PairSettings::threads, "Of building distance fields; 0: all.");
  bind_loads(m);
  nb::class_<ContactPair>(m, "ContactPair", "The contact of a moving body and a fixed one.")
      .def("__init__", &make_pair, "moving"_a, "fixed"_a, "law"_a, "settings"_a, "moving_layers"_a,
           "fixed_layers"_a)
      .def_prop_ro("compartments", &ContactPair::compartments)
      .def("evaluate", &evaluate, "poses"_a, "derivatives"_a, "threads"_a,
           "Loads at poses (n, 6); threads 0 means all cores. The result does not depend on threads.")
      .def("face_pressure", &face_pressure, "pose"_a, "compartment"_a,
           "Depth [m] and pressure [Pa] of each face of one compartment.");
}

}  // namespace condyle::bindings
