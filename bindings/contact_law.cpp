// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_law.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "arrays.hpp"

namespace condyle::bindings {
namespace {

using namespace contact;

/// (n, 3): energy, pressure and pressure rate at n depths.
auto values(const ContactLaw& law, const VectorIn& depth) {
  std::vector<double> table;
  for (const double d : as_span(depth)) {
    const LawValue value = law.at(d);
    table.insert(table.end(), {value.energy, value.pressure, value.pressure_rate});
  }
  return to_numpy(std::move(table), {depth.shape(0), 3});
}

}  // namespace

void bind_contact_law(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<ElasticLayer>(m, "ElasticLayer", "Isotropic layer bonded to a rigid body.")
      .def(nb::init<double, double, double>(), "youngs_modulus"_a, "poissons_ratio"_a,
           "thickness"_a);
  nb::class_<LinearVolumeLaw>(m, "LinearVolumeLaw", "Pressure p = K d.")
      .def(nb::init<>())
      .def(nb::init<double>(), "modulus"_a)
      .def_ro("modulus", &LinearVolumeLaw::modulus, "K [N/m^3]");
  nb::class_<ThinLayerLinearLaw>(m, "ThinLayerLinearLaw", "Pressure p = M d/h.")
      .def(nb::init<ElasticLayer>(), "layer"_a);
  nb::class_<ThinLayerLogarithmicLaw>(m, "ThinLayerLogarithmicLaw", "Pressure p = -M ln(1 - d/h).")
      .def(nb::init<ElasticLayer>(), "layer"_a);
  nb::class_<PowerLaw>(m, "PowerLaw", "Pressure p = c d^n.")
      .def(nb::init<double, double>(), "coefficient"_a, "exponent"_a);
  nb::class_<TableLaw>(m, "TableLaw", "Pressure linear between points.")
      .def(nb::init<std::vector<double>, std::vector<double>>(), "depth"_a, "pressure"_a);
  nb::class_<ContactLaw>(m, "ContactLaw", "Any of the laws.")
      .def(nb::init<LinearVolumeLaw>(), "law"_a)
      .def(nb::init<ThinLayerLinearLaw>(), "law"_a)
      .def(nb::init<ThinLayerLogarithmicLaw>(), "law"_a)
      .def(nb::init<PowerLaw>(), "law"_a)
      .def(nb::init<TableLaw>(), "law"_a)
      .def("values", &values, "depth"_a,
           "(n, 3): energy [J/m^2], pressure [Pa] and pressure rate [Pa/m] at n depths [m].")
      .def_prop_ro("has_layer", &ContactLaw::has_layer)
      .def_prop_ro("name", [](const ContactLaw& law) { return law.describe().name; })
      .def_prop_ro(
          "parameters", [](const ContactLaw& law) { return law.describe().parameters; },
          "Names, with their units, and values.");
  m.def(
      "layer_of",
      [](double youngs_modulus, double poissons_ratio, double thickness) {
        const Layer layer = layer_of({youngs_modulus, poissons_ratio, thickness});
        return std::pair(layer.modulus, layer.thickness);
      },
      "youngs_modulus"_a, "poissons_ratio"_a, "thickness"_a,
      "Confined modulus [Pa] and thickness [m] of a layer.");
  m.def("pressure_modulus", &pressure_modulus, "layer"_a, "K [N/m^3] of a layer.");
  m.def("youngs_modulus", &youngs_modulus, "modulus"_a, "poissons_ratio"_a, "thickness"_a,
        "E [Pa] of the layer of a pressure modulus [N/m^3].");
}

}  // namespace condyle::bindings
