// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "condyle/fdk/trial_analysis.hpp"
#include "trial_tables.hpp"

namespace condyle::bindings {
namespace {

using fdk::TimeFrames;
using fdk::TrialAnalysis;

TrialAnalysis analyse(const model::Model& model, const TableIn& q, const TableIn& qd, const TableIn& qdd,
                      const LoadsIn& loads, const std::vector<int>& bodies, const model::PathSnapshots* snapshots,
                      const std::vector<std::size_t>& snapshot_rows, const fdk::MuscleSettings& settings, const fdk::TrialParts& parts, int threads) {
  nb::gil_scoped_release release;
  return analyse_trial(model, {table(q), table(qd), table(qdd), external_loads(loads, bodies), snapshots, snapshot_rows}, settings,
                       parts, threads);
}

void bind_settings(nb::module_& m) {
  using S = fdk::MuscleSettings;
  nb::enum_<model::StrengthModel>(m, "StrengthModel")
      .value("CONSTANT", model::StrengthModel::kConstant)
      .value("HILL", model::StrengthModel::kHill);
  nb::class_<S>(m, "MuscleSettings")
      .def("__init__",
           [](S* self, model::StrengthModel strength, bool min_max, double exponent, bool upper_bounds,
              double reserve_moment, double reserve_force, double reserve_price) {
             new (self) S{strength, {}, reserve_moment, reserve_force, reserve_price};
             self->recruitment.criterion = {min_max, exponent};
             self->recruitment.upper_bounds = upper_bounds;
           },
           nb::kw_only(), nb::arg("strength"), nb::arg("min_max"), nb::arg("exponent"), nb::arg("upper_bounds"),
           nb::arg("reserve_moment"), nb::arg("reserve_force"), nb::arg("reserve_price"));
  using P = fdk::TrialParts;
  nb::class_<P>(m, "TrialParts")
      .def("__init__",
           [](P* self, bool dynamics, bool muscles, bool ligaments, bool recruitment) {
             new (self) P{dynamics, muscles, ligaments, recruitment};
           },
           nb::kw_only(), nb::arg("dynamics"), nb::arg("muscles"), nb::arg("ligaments"), nb::arg("recruitment"));
}

}  // namespace

void bind_trial_analysis(nb::module_& m) {
  bind_settings(m);
  nb::class_<TrialAnalysis> c(m, "TrialAnalysis", "A whole trial; one row a time frame.");
  const auto add = [&](const char* name, TimeFrames TrialAnalysis::* member) {
    c.def_prop_ro(name, [member](const TrialAnalysis& self) { return to_array(self.*member); },
                  nb::rv_policy::move);
  };
  add("segment_poses", &TrialAnalysis::segment_poses);
  add("generalised_forces", &TrialAnalysis::generalised_forces);
  add("muscle_lengths", &TrialAnalysis::muscle_lengths);
  add("muscle_velocities", &TrialAnalysis::muscle_velocities);
  add("moment_arms", &TrialAnalysis::moment_arms);
  add("muscle_strengths", &TrialAnalysis::muscle_strengths);
  add("passive_forces", &TrialAnalysis::passive_forces);
  add("ligament_lengths", &TrialAnalysis::ligament_lengths);
  add("ligament_strains", &TrialAnalysis::ligament_strains);
  add("ligament_forces", &TrialAnalysis::ligament_forces);
  add("ligament_loads", &TrialAnalysis::ligament_loads);
  add("spring_loads", &TrialAnalysis::spring_loads);
  add("muscle_forces", &TrialAnalysis::muscle_forces);
  add("activities", &TrialAnalysis::activities);
  add("reserves", &TrialAnalysis::reserves);
  add("residuals", &TrialAnalysis::residuals);
  c.def_prop_ro("status", [](const TrialAnalysis& self) {
     std::vector<std::string> words;
     for (const auto status : self.status) words.emplace_back(recruitment::name(status));
     return words;
   }).def_ro("messages", &TrialAnalysis::messages)
      .def_ro("kkt", &TrialAnalysis::kkt);
  m.def("analyse_trial", &analyse, nb::arg("model"), nb::arg("q"), nb::arg("qd"), nb::arg("qdd"), nb::arg("loads"),
        nb::arg("load_bodies"), nb::arg("snapshots").none(), nb::arg("snapshot_rows"), nb::arg("settings"), nb::arg("parts"),
        nb::arg("threads"));
  m.def("balanced_coordinates", [](const model::Model& model) {
    const fdk::MusculoskeletalFrame frame(model, {});
    return std::vector<int>(frame.balanced().begin(), frame.balanced().end());
  }, nb::arg("model"), "Coordinates that muscles balance.");
  m.def("wraps_ignored", [](const model::Model& model) {
    return fdk::MusculoskeletalFrame(model, {}).wraps_ignored();
  }, nb::arg("model"), "Wrapping surfaces that paths pass by unless a snapshot is given, in words.");
}

}  // namespace condyle::bindings
