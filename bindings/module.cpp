// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>

namespace nb = nanobind;

namespace condyle::bindings {
void bind_common(nb::module_& m);
void bind_contact_model(nb::module_& m);
void bind_geometry(nb::module_& m);
void bind_contact_law(nb::module_& m);
void bind_contact_pair(nb::module_& m);
void bind_contact(nb::module_& m);
void bind_surrogate(nb::module_& m);
void bind_fast_accuracy(nb::module_& m);
void bind_fdk(nb::module_& m);
void bind_seating(nb::module_& m);
void bind_given_loads(nb::module_& m);
void bind_recruitment(nb::module_& m);
void bind_io(nb::module_& m);
void bind_model(nb::module_& m);
void bind_trial_analysis(nb::module_& m);
void bind_force_dependent(nb::module_& m);
void bind_model_files(nb::module_& m);
void bind_trial_files(nb::module_& m);
}  // namespace condyle::bindings

NB_MODULE(_core, m) {
  using namespace condyle::bindings;
  // At exit nanobind lists what the interpreter has not released, such as what a test runner still holds: nothing a user
  // can act on, and a library does not print.
  nb::set_leak_warnings(false);
  m.doc() = "Condyle's C++ core. Use the condyle package; this module is its inside.";
  nb::module_ common = m.def_submodule("common", "Conventions: poses, wrenches, clinical kinematics.");
  nb::module_ geometry = m.def_submodule("geometry", "Triangle meshes and distances.");
  nb::module_ contact = m.def_submodule("contact", "Contact models.");
  nb::module_ surrogate = m.def_submodule("surrogate", "Neural surrogates of the contact model.");
  nb::module_ fdk = m.def_submodule("fdk", "Static equilibrium and the knee simulator.");
  nb::module_ recruitment = m.def_submodule("recruitment", "Sharing loads over muscles.");
  nb::module_ io = m.def_submodule("io", "Tables, models and trials in files.");
  nb::module_ model = m.def_submodule("model", "Musculoskeletal models.");
  bind_common(common);
  bind_contact_model(contact);
  bind_geometry(geometry);
  bind_contact_law(contact);
  bind_contact_pair(contact);
  bind_contact(contact);
  bind_fast_accuracy(contact);
  bind_surrogate(surrogate);
  bind_fdk(fdk);
  bind_seating(fdk);
  bind_recruitment(recruitment);
  bind_given_loads(fdk);
  bind_io(io);
  bind_model(model);
  bind_trial_analysis(fdk);
  bind_force_dependent(fdk);
  bind_model_files(io);
  bind_trial_files(io);
}
