// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "condyle/fdk/trial_simulation.hpp"
#include "trial_tables.hpp"

namespace condyle::bindings {
namespace {

using fdk::ForceDependentRecord;
using fdk::TrialSimulation;
using TransformIn = nb::ndarray<const double, nb::shape<4, 4>, nb::c_contig, nb::device::cpu>;

RigidTransform transform(const TransformIn& in) {
  RigidTransform X;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) X.R(i, j) = in(i, j);
    X.p[i] = in(i, 3);
  }
  return X;
}

nb::ndarray<nb::numpy, double> vector(const numerics::Unknowns& values) {
  return to_numpy(Eigen::VectorXd(values));
}

TrialSimulation simulate(const model::Model& model, const TableIn& q, const TableIn& qd,
                         const TableIn& qdd, const LoadsIn& loads, const std::vector<int>& bodies,
                         const model::PathSnapshots* snapshots,
                         const std::vector<std::size_t>& snapshot_rows,
                         const std::vector<fdk::BodyContactDescription>& contacts,
                         const TableIn& starts, const fdk::TrialSimulationSettings& settings) {
  nb::gil_scoped_release release;
  return simulate_trial(
      model,
      {table(q), table(qd), table(qdd), external_loads(loads, bodies), snapshots, snapshot_rows},
      contacts, table(starts), settings);
}

void bind_settings(nb::module_& m) {
  using D = fdk::BodyContactDescription;
  nb::class_<D>(m, "BodyContact", "Which contact model acts between which bodies.")
      .def(
          "__init__",
          [](D* self, std::string name, const contact::ContactModel& model, std::string moving,
             std::string fixed, const TransformIn& X_BF, const TransformIn& X_BT, SideOfBody side) {
            new (self)
                D{std::move(name), &model, std::move(moving), std::move(fixed), transform(X_BF),
                  transform(X_BT), side};
          },
          nb::arg("name"), nb::arg("model"), nb::arg("moving_body"), nb::arg("fixed_body"),
          nb::arg("X_BF"), nb::arg("X_BT"), nb::arg("side_of_body"), nb::keep_alive<1, 3>(),
          "X_BF, X_BT: (4, 4) placements of F in the moving body and of T in the fixed one [m].")
      .def_ro("name", &D::name);
  using F = fdk::ForceDependentSettings;
  nb::class_<F>(m, "ForceDependentSettings", "How a time frame is solved.")
      .def(nb::init<>())
      .def_rw("newton", &F::newton)
      .def_rw("max_sharing_updates", &F::max_sharing_updates)
      .def_rw("sharing_tolerance", &F::sharing_tolerance)
      .def_rw("max_substeps", &F::max_substeps)
      .def_rw("softer_contact", &F::softer_contact)
      .def_rw("uncoupled", &F::uncoupled);
  using S = fdk::TrialSimulationSettings;
  nb::class_<S>(m, "TrialSimulationSettings", "How a trial is simulated.")
      .def(nb::init<>())
      .def_rw("muscles", &S::muscles)
      .def_rw("solver", &S::solver)
      .def_rw("keep_rates", &S::keep_rates)
      .def_rw("extrapolation", &S::extrapolation)
      .def_rw("chunk", &S::chunk)
      .def_rw("threads", &S::threads)
      .def_rw("least_trust", &S::least_trust);
}

void bind_record(nb::module_& m) {
  using R = ForceDependentRecord;
  nb::class_<R>(m, "ForceDependentRecord", "What became of a time frame.")
      .def_prop_ro("status", [](const R& r) { return std::string(name(r.status)); })
      .def_prop_ro("newton", [](const R& r) { return std::string(numerics::name(r.newton)); })
      .def_prop_ro("approach", [](const R& r) { return std::string(name(r.approach)); })
      .def_prop_ro("recruitment",
                   [](const R& r) { return std::string(recruitment::name(r.recruitment)); })
      .def_prop_ro("converged", &R::converged)
      .def_ro("start", &R::start)
      .def_ro("message", &R::message)
      .def_ro("worst_coordinate", &R::worst_name)
      .def_prop_ro(
          "residual", [](const R& r) { return vector(r.residual); }, nb::rv_policy::move)
      .def_ro("history", &R::history)
      .def_ro("iterations", &R::iterations)
      .def_ro("evaluations", &R::evaluations)
      .def_ro("regularised_steps", &R::regularised_steps)
      .def_ro("substeps", &R::substeps)
      .def_ro("sharing_updates", &R::sharing_updates)
      .def_ro("sharing_change", &R::sharing_change)
      .def_ro("sharing_settled", &R::sharing_settled)
      .def_ro("remaining_m", &R::remaining_m)
      .def_ro("remaining_rad", &R::remaining_rad)
      .def_ro("attainable_force", &R::attainable_force)
      .def_ro("attainable_moment", &R::attainable_moment)
      .def_ro("least_trust", &R::least_trust)
      .def_prop_ro(
          "seconds",
          [](const R& r) {
            nb::dict by_phase;
            for (int p = 0; p < fdk::kPhases; ++p) {
              const std::string phase(name(static_cast<fdk::Phase>(p)));
              by_phase[phase.c_str()] = r.seconds[static_cast<std::size_t>(p)];
            }
            return by_phase;
          },
          "Seconds by phase: not for results that must be the same from run to run.");
}

}  // namespace

void bind_force_dependent(nb::module_& m) {
  bind_settings(m);
  bind_record(m);
  nb::class_<TrialSimulation> c(m, "TrialSimulation", "A simulated trial; one row a time frame.");
  const auto add = [&](const char* name, fdk::TimeFrames TrialSimulation::*member) {
    c.def_prop_ro(
        name, [member](const TrialSimulation& self) { return to_array(self.*member); },
        nb::rv_policy::move);
  };
  add("q", &TrialSimulation::q);
  add("alpha", &TrialSimulation::alpha);
  add("alpha_residuals", &TrialSimulation::alpha_residuals);
  add("segment_poses", &TrialSimulation::segment_poses);
  add("contact_poses", &TrialSimulation::contact_poses);
  add("contact_wrenches", &TrialSimulation::contact_wrenches);
  add("contact_errors", &TrialSimulation::contact_errors);
  add("contact_trust", &TrialSimulation::contact_trust);
  add("contact_loads", &TrialSimulation::contact_loads);
  add("generalised_forces", &TrialSimulation::generalised_forces);
  add("ligament_loads", &TrialSimulation::ligament_loads);
  add("spring_loads", &TrialSimulation::spring_loads);
  add("residuals", &TrialSimulation::residuals);
  add("muscle_lengths", &TrialSimulation::muscle_lengths);
  add("muscle_strengths", &TrialSimulation::muscle_strengths);
  add("passive_forces", &TrialSimulation::passive_forces);
  add("muscle_forces", &TrialSimulation::muscle_forces);
  add("activities", &TrialSimulation::activities);
  add("reserves", &TrialSimulation::reserves);
  add("ligament_lengths", &TrialSimulation::ligament_lengths);
  add("ligament_strains", &TrialSimulation::ligament_strains);
  add("ligament_forces", &TrialSimulation::ligament_forces);
  c.def_ro("force_dependent", &TrialSimulation::force_dependent)
      .def_ro("contact_names", &TrialSimulation::contact_names)
      .def_ro("records", &TrialSimulation::records)
      .def_ro("not_converged", &TrialSimulation::not_converged)
      .def_ro("implausible", &TrialSimulation::implausible)
      .def_ro("untrusted", &TrialSimulation::untrusted)
      .def_prop_ro("summary", [](const TrialSimulation& self) { return summary(self); });
  m.def("simulate_trial", &simulate, nb::arg("model"), nb::arg("q"), nb::arg("qd"), nb::arg("qdd"),
        nb::arg("loads"), nb::arg("load_bodies"), nb::arg("snapshots").none(),
        nb::arg("snapshot_rows"), nb::arg("contacts"), nb::arg("starts"), nb::arg("settings"),
        "starts: (0, 1 or T; force-dependent coordinates).");
}

}  // namespace condyle::bindings
