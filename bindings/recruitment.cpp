// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "arrays.hpp"
#include "condyle/recruitment/series.hpp"

namespace condyle::bindings {
namespace {

namespace rec = condyle::recruitment;
using Solver = rec::RecruitmentSolver;
using TableIn = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using ArmsIn = nb::ndarray<const double, nb::shape<-1, -1, -1>, nb::c_contig, nb::device::cpu>;
constexpr auto kNew = nb::rv_policy::move;

rec::Vector vector(const VectorIn& in) {
  return Eigen::Map<const rec::Vector>(in.data(), static_cast<Eigen::Index>(in.shape(0)));
}
Eigen::Map<const rec::RowMatrix> table(const TableIn& in) {
  return {in.data(), static_cast<Eigen::Index>(in.shape(0)), static_cast<Eigen::Index>(in.shape(1))};
}
Eigen::Map<const rec::RowMatrix> stacked(const ArmsIn& in) {
  return {in.data(), static_cast<Eigen::Index>(in.shape(0) * in.shape(1)),
          static_cast<Eigen::Index>(in.shape(2))};
}
template <typename Array>
std::span<const double> all(const Array& in) {
  return {in.data(), in.size()};
}

rec::RecruitmentSeries solve(Solver& solver, const ArmsIn& moment_arms, const TableIn& loads,
                             const TableIn& strengths, const TableIn& minima, bool warm_starts,
                             bool forces_by_loads) {
  nb::gil_scoped_release release;
  return recruit_series(solver, {all(moment_arms), all(loads), all(strengths), all(minima)}, warm_starts,
                        forces_by_loads);
}

// (k, m) changes of forces and (k, n) of reserves.
nb::tuple along(Solver& solver, const TableIn& loads, const ArmsIn& moment_arms, const TableIn& strengths) {
  const auto k = static_cast<Eigen::Index>(loads.shape(0));
  rec::RowMatrix forces(k, solver.setup().muscles), reserves(k, solver.setup().coordinates);
  solver.forces_along(table(loads), stacked(moment_arms), table(strengths), forces, reserves);
  return nb::make_tuple(to_numpy(forces), to_numpy(reserves));
}

void bind_series(nb::module_& m) {
  using S = rec::RecruitmentSeries;
  nb::class_<S>(m, "RecruitmentSeries", "Recruitment of t time frames.")
      .def_prop_ro("status", [](const S& s) {
        std::vector<std::string> names;
        for (auto status : s.status) names.emplace_back(rec::name(status));
        return names; })
      .def_ro("message", &S::message)
      .def_prop_ro("forces", [](const S& s) { return to_numpy(s.forces); }, kNew, "(t, m) [N]")
      .def_prop_ro("activities", [](const S& s) { return to_numpy(s.activities); }, kNew, "(t, m)")
      .def_prop_ro("reserves", [](const S& s) { return to_numpy(s.reserves); }, kNew, "(t, n)")
      .def_prop_ro("multipliers", [](const S& s) { return to_numpy(s.multipliers); }, kNew, "(t, n)")
      .def_prop_ro("unmet", [](const S& s) { return to_numpy(s.unmet); }, kNew, "(t, n)")
      .def_prop_ro("kkt", [](const S& s) { return to_numpy(s.kkt); }, kNew, "(t, 3)")
      .def_prop_ro("objective", [](const S& s) { return to_numpy(s.objective); }, kNew, "(t,)")
      .def_prop_ro("iterations", [](const S& s) { return to_numpy(std::vector<int>(s.iterations), {s.iterations.size()}); },
                   kNew, "(t,)")
      .def_prop_ro("forces_by_loads", [](const S& s) { return to_numpy(s.forces_by_loads); }, kNew, "(t m, n)");
}

}  // namespace

void bind_recruitment(nb::module_& m) {
  using namespace nb::literals;
  using Setup = rec::RecruitmentSetup;
  using Settings = rec::RecruitmentSettings;
  nb::class_<Setup>(m, "RecruitmentSetup", "What does not change from time frame to time frame.")
      .def(nb::init<>())
      .def_rw("coordinates", &Setup::coordinates)
      .def_rw("muscles", &Setup::muscles)
      .def_rw("coordinate_names", &Setup::coordinate_names)
      .def_rw("muscle_names", &Setup::muscle_names)
      .def_prop_rw("weights", [](const Setup& s) { return to_numpy(s.weights); },
                   [](Setup& s, const VectorIn& v) { s.weights = vector(v); }, nb::for_getter(kNew))
      .def_prop_rw("reserve_strengths", [](const Setup& s) { return to_numpy(s.reserve_strengths); },
                   [](Setup& s, const VectorIn& v) { s.reserve_strengths = vector(v); }, nb::for_getter(kNew))
      .def_prop_rw("reserve_prices", [](const Setup& s) { return to_numpy(s.reserve_prices); },
                   [](Setup& s, const VectorIn& v) { s.reserve_prices = vector(v); }, nb::for_getter(kNew));
  nb::class_<rec::Criterion>(m, "Criterion", "What is made small.")
      .def(nb::init<>())
      .def_rw("min_max", &rec::Criterion::min_max)
      .def_rw("exponent", &rec::Criterion::exponent);
  nb::class_<Settings>(m, "RecruitmentSettings", "How muscles are recruited.")
      .def(nb::init<>())
      .def_rw("criterion", &Settings::criterion)
      .def_rw("upper_bounds", &Settings::upper_bounds)
      .def_rw("max_iterations", &Settings::max_iterations)
      .def_rw("tolerance", &Settings::tolerance);
  bind_series(m);
  nb::class_<Solver>(m, "RecruitmentSolver", "Muscle recruitment, time frame after time frame.")
      .def(nb::init<Setup, Settings>(), "setup"_a, "settings"_a)
      .def("solve", &solve, "moment_arms"_a, "loads"_a, "strengths"_a, "minima"_a, "warm_starts"_a,
           "forces_by_loads"_a)
      .def_prop_ro("levels", [](const Solver& s) { return s.result().levels; })
      .def_prop_ro("states", [](const Solver& s) {
        std::vector<int> states;
        for (auto state : s.result().states) states.push_back(static_cast<int>(state));
        return states; })
      .def_prop_ro("unmet_coordinates", [](const Solver& s) { return s.result().unmet_coordinates; })
      .def("sensitivity_is_regular", &Solver::sensitivity_is_regular)
      .def("forces_along", &along, "loads"_a, "moment_arms"_a, "strengths"_a);
}

}  // namespace condyle::bindings
