// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "condyle/contact/implant_check.hpp"
#include "condyle/contact/mesh_contact.hpp"
#include "condyle/contact/pair_contact_model.hpp"

namespace condyle::bindings {
namespace {

using namespace contact;
using geometry::TriangleMesh;

/// Many ContactDetails, taken apart into arrays; axis 1 is (medial, lateral).
struct DetailArrays {
  explicit DetailArrays(std::vector<ContactDetail> details_in) : details(std::move(details_in)) {}

  /// (n, 2) of one number a side.
  template <auto Member>
  auto column() const {
    std::vector<double> values;
    for (const auto& detail : details) {
      for (const auto& side : detail.sides) values.push_back(side.*Member);
    }
    return to_numpy(std::move(values), {details.size(), 2});
  }

  /// (n, 2, k) of one vector a side.
  template <auto Member, std::size_t Size>
  auto vectors() const {
    std::vector<double> values;
    for (const auto& detail : details) {
      for (const auto& side : detail.sides) {
        values.insert(values.end(), (side.*Member).data(), (side.*Member).data() + Size);
      }
    }
    return to_numpy(std::move(values), {details.size(), 2, Size});
  }

  std::vector<std::string> status() const {
    std::vector<std::string> texts;
    for (const auto& detail : details) texts.push_back(detail.status);
    return texts;
  }

  std::vector<ContactDetail> details;
};

DetailArrays evaluate_details(const MeshContact& contact, const PosesIn& poses, int threads) {
  nb::gil_scoped_release release;
  return DetailArrays(contact.evaluate_details(as_poses(poses), threads));
}

auto face_pressure(const MeshContact& contact, const PoseIn& pose, Side side) {
  const FacePressure faces = contact.face_pressure(as_pose(pose), side);
  return nb::make_tuple(to_numpy(faces.depth), to_numpy(faces.pressure));
}

void make_mesh_contact(MeshContact* contact, const TriangleMesh& femur, const TriangleMesh& medial,
                       const TriangleMesh& lateral, SideOfBody side, const ContactLaw& law,
                       const MeshContactSettings& settings, const LayersIn& femur_layers,
                       const LayersIn& medial_layers, const LayersIn& lateral_layers) {
  const ImplantLayers layers{as_layers(femur_layers),
                             {as_layers(medial_layers), as_layers(lateral_layers)}};
  nb::gil_scoped_release release;
  new (contact) MeshContact(femur, {medial, lateral}, side, law, settings, layers);
}

void bind_detail(nb::module_& m) {
  using D = SideDetail;
  constexpr auto kNew = nb::rv_policy::move;  // each access makes its own array
  nb::class_<DetailArrays>(m, "DetailArrays",
                           "Mesh contact at n poses in full; axis 1 is (medial, lateral).")
      .def_prop_ro("wrench", &DetailArrays::vectors<&D::wrench, 6>, kNew,
                   "(n, 2, 6) on the femur, at Fo, in T [N, Nm].")
      .def_prop_ro("energy", &DetailArrays::column<&D::energy>, kNew, "(n, 2) [J]")
      .def_prop_ro("volume", &DetailArrays::column<&D::volume>, kNew, "(n, 2) [m^3]")
      .def_prop_ro("area", &DetailArrays::column<&D::area>, kNew, "(n, 2) of loaded faces [m^2]")
      .def_prop_ro("border_area", &DetailArrays::column<&D::border_area>, kNew,
                   "(n, 2) that did not count [m^2]")
      .def_prop_ro("max_depth", &DetailArrays::column<&D::max_depth>, kNew, "(n, 2) [m]")
      .def_prop_ro("peak_pressure", &DetailArrays::column<&D::peak_pressure>, kNew, "(n, 2) [Pa]")
      .def_prop_ro("mean_pressure", &DetailArrays::column<&D::mean_pressure>, kNew, "(n, 2) [Pa]")
      .def_prop_ro("centre_of_pressure", &DetailArrays::vectors<&D::centre_of_pressure, 3>, kNew,
                   "(n, 2, 3) in T [m]")
      .def_prop_ro("status", &DetailArrays::status,
                   "n texts: 'ok', or what is wrong on which side.");
}

void bind_checks(nb::module_& m) {
  using namespace nb::literals;
  m.def("split_insert", &split_insert, "insert"_a, "side_of_body"_a,
        "Medial and lateral part of an insert, by face centroid at z = 0.");
  m.def("require_femur", &require_femur, "femur"_a,
        "Raises ValueError unless this can be a femoral component.");
  m.def("require_insert", &require_insert, "insert"_a, "side_of_body"_a,
        "Raises ValueError unless these can be the medial and lateral compartments.");
  m.def("require_unswapped", &require_unswapped, "femur"_a, "insert"_a,
        "Raises ValueError if femur and insert look swapped.");
}

}  // namespace

void bind_contact(nb::module_& m) {
  using namespace nb::literals;
  nb::enum_<Side>(m, "Side").value("medial", kMedial).value("lateral", kLateral);
  nb::class_<MeshContactSettings>(m, "MeshContactSettings")
      .def(nb::init<>())
      .def_rw("pair", &MeshContactSettings::pair)
      .def_rw("plausible_depth", &MeshContactSettings::plausible_depth, "[m]");
  bind_detail(m);
  bind_checks(m);
  nb::class_<MeshContact, ContactModel>(m, "MeshContact",
                                        "The reference contact of two triangle surfaces.")
      .def("__init__", &make_mesh_contact, "femur"_a, "insert_medial"_a, "insert_lateral"_a,
           "side_of_body"_a, "law"_a, "settings"_a, "femur_layers"_a, "medial_layers"_a,
           "lateral_layers"_a)
      .def_prop_ro("femur", &MeshContact::femur, nb::rv_policy::reference_internal)
      .def_prop_ro(
          "insert_medial",
          [](const MeshContact& c) -> const TriangleMesh& { return c.insert()[kMedial]; },
          nb::rv_policy::reference_internal)
      .def_prop_ro(
          "insert_lateral",
          [](const MeshContact& c) -> const TriangleMesh& { return c.insert()[kLateral]; },
          nb::rv_policy::reference_internal)
      .def_prop_ro("settings", &MeshContact::settings, nb::rv_policy::reference_internal)
      .def_prop_ro("insert_width", &MeshContact::insert_width, "Width of the insert along z [m].")
      .def("law_name", [](const MeshContact& c) { return c.law().describe().name; })
      .def(
          "law_parameters", [](const MeshContact& c) { return c.law().describe().parameters; },
          "Names, with their units, and values.")
      .def("evaluate_details", &evaluate_details, "poses"_a, "threads"_a,
           "Everything at poses (n, 6).")
      .def("face_pressure", &face_pressure, "pose"_a, "side"_a,
           "Depth [m] and pressure [Pa] of each face of one compartment.");
  nb::class_<PairContactModel, ContactModel>(m, "PairContactModel",
                                             "A pair of bodies as a contact model of one side.")
      .def(nb::init<ContactPair, SideOfBody, Side, double>(), "pair"_a, "side_of_body"_a, "side"_a,
           "plausible_depth"_a)
      .def_prop_ro("side", &PairContactModel::side);
}

}  // namespace condyle::bindings
