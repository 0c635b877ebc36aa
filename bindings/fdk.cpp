// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "arrays.hpp"
#include "condyle/fdk/knee_simulator.hpp"
#include "condyle/fdk/static_equilibrium.hpp"

namespace condyle::bindings {
namespace {

using contact::ContactModel;

// (n, 2, 6) and (n, 2, 6, 6) out of any result that holds `loads`.
template <typename Result>
nb::ndarray<nb::numpy, double> wrenches(const std::vector<Result>& results) {
  std::vector<double> values;
  values.reserve(12 * results.size());
  for (const Result& r : results) {
    for (const Wrench& w : r.loads.wrench) values.insert(values.end(), w.data(), w.data() + 6);
  }
  return to_numpy(std::move(values), {results.size(), 2, 6});
}
template <typename Result>
nb::ndarray<nb::numpy, double> stiffnesses(const std::vector<Result>& results) {
  std::vector<double> values;
  values.reserve(72 * results.size());
  for (const Result& r : results) {
    for (const Matrix6& S : r.loads.stiffness) values.insert(values.end(), S.data(), S.data() + 36);
  }
  return to_numpy(std::move(values), {results.size(), 2, 6, 6});
}
template <typename Result>
nb::ndarray<nb::numpy, double> poses(const std::vector<Result>& results) {
  std::vector<double> values;
  values.reserve(6 * results.size());
  for (const Result& r : results) values.insert(values.end(), r.pose.data(), r.pose.data() + 6);
  return to_numpy(std::move(values), {results.size(), 6});
}
// (n,) of one member or expression.
template <typename Scalar, typename Result, typename Get>
nb::ndarray<nb::numpy, Scalar> column(const std::vector<Result>& results, Get get) {
  std::vector<Scalar> values;
  values.reserve(results.size());
  for (const Result& r : results) values.push_back(static_cast<Scalar>(get(r)));
  return to_numpy(std::move(values), {results.size()});
}

// Each access to an array makes its own, which then belongs to Python.
constexpr auto kNew = nb::rv_policy::move;

struct StaticEquilibria {
  std::vector<fdk::StaticEquilibrium> rows;
  long map_evaluations = 0;
};

// `loads` has the columns x, z, θy, θz, Fy and Mx or θx; `starts` y and θx.
StaticEquilibria solve_static(const fdk::StaticEquilibriumSolver& solver, const PosesIn& loads, bool theta_x_given,
                              const std::optional<nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig,
                                                              nb::device::cpu>>& starts,
                              int threads) {
  if (starts && starts->shape(0) != loads.shape(0)) {
    throw std::invalid_argument("start has " + std::to_string(starts->shape(0)) + " rows for " +
                                std::to_string(loads.shape(0)) + " loads");
  }
  nb::gil_scoped_release release;
  std::vector<fdk::StaticLoad> rows(loads.shape(0));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double* v = loads.data() + 6 * i;
    rows[i] = {v[0], v[1], v[2], v[3], v[4], v[5], std::nullopt, std::nullopt};
    if (theta_x_given) rows[i].theta_x = v[5];
    if (starts) rows[i].start = {starts->data()[2 * i], starts->data()[2 * i + 1]};
  }
  const long before = solver.map_evaluations();
  StaticEquilibria result{solver.solve_batch(rows, threads), 0};
  result.map_evaluations = solver.map_evaluations() - before;
  return result;
}

fdk::KneeSimulation simulate(const ContactModel& model, const VectorIn& time, const VectorIn& flexion,
                             const VectorIn& axial_force, const VectorIn& ap_force, const VectorIn& ie_torque,
                             const fdk::KneeSimulatorSettings& settings) {
  const auto vector = [](const VectorIn& in) {
    return std::vector<double>(in.data(), in.data() + in.shape(0));
  };
  const fdk::LoadCase load_case{vector(time), vector(flexion), vector(axial_force), vector(ap_force),
                                vector(ie_torque)};
  nb::gil_scoped_release release;
  return fdk::simulate_knee(model, load_case, settings);
}

nb::ndarray<nb::numpy, double> clinical(const fdk::KneeSimulation& s) {
  std::vector<double> table;
  for (const fdk::KneeFrame& frame : s.frames) {
    const ClinicalKinematics& k = frame.clinical;
    table.insert(table.end(), {k.flexion, k.adduction, k.tibial_external_rotation,
                               k.anterior_tibial_translation, k.distraction, k.lateral_tibial_translation});
  }
  return to_numpy(std::move(table), {s.frames.size(), 6});
}

nb::ndarray<nb::numpy, double> residuals(const fdk::KneeSimulation& s) {
  std::vector<double> table;
  for (const fdk::KneeFrame& frame : s.frames) {
    table.insert(table.end(), frame.residual.data(), frame.residual.data() + 5);
  }
  return to_numpy(std::move(table), {s.frames.size(), 5});
}

template <typename Status>
auto status_enum(nb::module_& m, const char* class_name) {
  return nb::enum_<Status>(m, class_name, nb::is_arithmetic())
      .def_prop_ro("text", [](Status s) { return std::string(name(s)); }, "Its name in results.")
      .def_prop_ro("advice", [](Status s) { return std::string(advice(s)); },
                   "What happened, and what to do next.");
}

void bind_static(nb::module_& m) {
  using namespace nb::literals;
  using fdk::EquilibriumStatus;
  status_enum<EquilibriumStatus>(m, "EquilibriumStatus")
      .value("converged", EquilibriumStatus::kConverged)
      .value("no_equilibrium", EquilibriumStatus::kNoEquilibrium)
      .value("overclosure", EquilibriumStatus::kOverclosure)
      .value("off_insert", EquilibriumStatus::kOffInsert)
      .value("not_converged", EquilibriumStatus::kNotConverged);
  nb::class_<fdk::TouchSearch>(m, "TouchSearch", "Where first touch is looked for along y.")
      .def(nb::init<>())
      .def_rw("y_high", &fdk::TouchSearch::y_high, "[m]")
      .def_rw("y_low", &fdk::TouchSearch::y_low, "[m]")
      .def_rw("step", &fdk::TouchSearch::step, "[m]")
      .def_rw("light_load", &fdk::TouchSearch::light_load, "[N]");
  using S = fdk::StaticEquilibriumSettings;
  nb::class_<S>(m, "StaticEquilibriumSettings", "Tolerances and limits of a static equilibrium.")
      .def(nb::init<>())
      .def_rw("force_tolerance", &S::force_tolerance, "[N]")
      .def_rw("force_relative_tolerance", &S::force_relative_tolerance)
      .def_rw("moment_tolerance", &S::moment_tolerance, "[Nm]")
      .def_rw("moment_relative_tolerance", &S::moment_relative_tolerance)
      .def_rw("max_iterations", &S::max_iterations)
      .def_rw("max_evaluations", &S::max_evaluations)
      .def_rw("max_newton_step_m", &S::max_newton_step_m)
      .def_rw("max_newton_step_rad", &S::max_newton_step_rad)
      .def_rw("max_theta_x", &S::max_theta_x, "[rad]")
      .def_rw("greatest_moment_arm", &S::greatest_moment_arm, "[m]")
      .def_rw("touch", &S::touch);
  using E = fdk::StaticEquilibrium;
  nb::class_<StaticEquilibria>(m, "StaticEquilibria", "Results of StaticEquilibriumSolver.solve, as arrays.")
      .def_prop_ro("poses", [](const StaticEquilibria& r) { return poses(r.rows); }, kNew, "(n, 6)")
      .def_prop_ro("wrenches", [](const StaticEquilibria& r) { return wrenches(r.rows); }, kNew, "(n, 2, 6)")
      .def_prop_ro("stiffness", [](const StaticEquilibria& r) { return stiffnesses(r.rows); }, kNew, "(n, 2, 6, 6)")
      .def_prop_ro("status", [](const StaticEquilibria& r) {
        return column<int>(r.rows, [](const E& e) { return static_cast<int>(e.status); }); }, kNew, "(n,)")
      .def_prop_ro("evaluations", [](const StaticEquilibria& r) {
        return column<std::int64_t>(r.rows, [](const E& e) { return e.evaluations; }); }, kNew, "(n,)")
      .def_prop_ro("iterations", [](const StaticEquilibria& r) {
        return column<std::int64_t>(r.rows, [](const E& e) { return e.iterations; }); }, kNew, "(n,)")
      .def_prop_ro("trust", [](const StaticEquilibria& r) {
        return column<double>(r.rows, [](const E& e) { return e.loads.trust; }); }, kNew, "(n,)")
      .def_ro("map_evaluations", &StaticEquilibria::map_evaluations);
  nb::class_<fdk::StaticEquilibriumSolver>(m, "StaticEquilibriumSolver",
                                           "Solves static equilibria; keeps its map of first touches.")
      .def(nb::init<const ContactModel&, const S&>(), "model"_a, "settings"_a, nb::keep_alive<1, 2>())
      .def("solve", &solve_static, "loads"_a, "theta_x_given"_a, "start"_a.none(), "threads"_a,
           "Static equilibria; loads (n, 6): x, z, theta_y, theta_z, Fy and Mx (or theta_x where given).");
}

void bind_ligaments(nb::module_& m) {
  using namespace nb::literals;
  using model::Ligament;
  const auto point = [](Vector3 Ligament::*member) {
    return [member](const Ligament& l) { return to_numpy(l.*member); };
  };
  const auto set_point = [](Vector3 Ligament::*member) {
    return [member](Ligament& l, const nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu>& p) {
      l.*member = Vector3(p.data());
    };
  };
  nb::class_<Ligament>(m, "Ligament", "A straight bundle after Blankevoort et al. 1991.")
      .def(nb::init<>())
      .def_rw("name", &Ligament::name)
      .def_prop_rw("p_FoA_F", point(&Ligament::p_FoA_F), set_point(&Ligament::p_FoA_F), nb::rv_policy::move,
                   "(3,) femoral attachment in F [m]")
      .def_prop_rw("p_ToB_T", point(&Ligament::p_ToB_T), set_point(&Ligament::p_ToB_T), nb::rv_policy::move,
                   "(3,) tibial attachment in T [m]")
      .def_rw("stiffness", &Ligament::stiffness, "[N per unit strain]")
      .def_rw("slack_length", &Ligament::slack_length, "[m]")
      .def_rw("transition", &Ligament::transition, "[-]");
  m.def("ligament_length", [](const Ligament& l, const PoseIn& pose) { return model::length(l, as_pose(pose)); },
        "ligament"_a, "pose"_a, "[m]");
  m.def("ligament_tension", &model::tension, "ligament"_a, "length"_a, "[N]");
  m.def("ligament_wrench", [](const Ligament& l, const PoseIn& pose) {
          return to_numpy(model::ligament_wrench(l, as_pose(pose))); },
        "ligament"_a, "pose"_a, "(6,) on the femur, at Fo, expressed in T.");
  m.def("default_ligaments", [](SideOfBody side, const PoseIn& pose) {
          return model::default_ligaments(side, as_pose(pose)); },
        "side_of_body"_a, "reference_pose"_a);
}

void bind_simulator(nb::module_& m) {
  using namespace nb::literals;
  using fdk::FrameStatus;
  status_enum<FrameStatus>(m, "FrameStatus")
      .value("converged", FrameStatus::kConverged)
      .value("not_converged", FrameStatus::kNotConverged)
      .value("implausible_depth", FrameStatus::kImplausibleDepth);
  nb::enum_<numerics::JacobianMethod>(m, "JacobianMethod")
      .value("analytic", numerics::JacobianMethod::kAnalytic)
      .value("finite_differences", numerics::JacobianMethod::kFiniteDifferences);
  using N = numerics::NewtonSettings;
  nb::class_<N>(m, "NewtonSettings", "Settings of the Newton solver.")
      .def(nb::init<>())
      .def_rw("force_tolerance", &N::force_tolerance, "[N]")
      .def_rw("moment_tolerance", &N::moment_tolerance, "[Nm]")
      .def_rw("max_iterations", &N::max_iterations)
      .def_rw("max_newton_step_m", &N::max_newton_step_m)
      .def_rw("max_newton_step_rad", &N::max_newton_step_rad)
      .def_rw("max_line_search", &N::max_line_search)
      .def_rw("jacobian", &N::jacobian)
      .def_rw("perturbation", &N::perturbation, "[m, rad]");
  using R = fdk::RestraintSprings;
  nb::class_<R>(m, "RestraintSprings", "Linear springs with free play on AP, IE and ML.")
      .def(nb::init<>())
      .def_rw("ap_stiffness", &R::ap_stiffness, "[N/m]").def_rw("ap_gap", &R::ap_gap, "[m]")
      .def_rw("ie_stiffness", &R::ie_stiffness, "[Nm/rad]").def_rw("ie_gap", &R::ie_gap, "[rad]")
      .def_rw("ml_stiffness", &R::ml_stiffness, "[N/m]").def_rw("ml_gap", &R::ml_gap, "[m]")
      .def_rw("reference_x", &R::reference_x, "[m] or None")
      .def_rw("reference_z", &R::reference_z, "[m] or None")
      .def_rw("reference_theta_y", &R::reference_theta_y, "[rad] or None");
  using T = fdk::SettleSettings;
  nb::class_<T>(m, "SettleSettings", "How the settled pose is found.")
      .def(nb::init<>())
      .def_rw("axial_force", &T::axial_force, "[N]")
      .def_rw("newton", &T::newton).def_rw("touch", &T::touch);
  using S = fdk::KneeSimulatorSettings;
  nb::class_<S>(m, "KneeSimulatorSettings", "Settings of the knee simulator.")
      .def(nb::init<>())
      .def_rw("newton", &S::newton)
      .def_rw("insert_width", &S::insert_width, "[m]")
      .def_rw("axial_offset_ratio", &S::axial_offset_ratio)
      .def_rw("restraint", &S::restraint)
      .def_rw("ligaments", &S::ligaments)
      .def_rw("max_substeps", &S::max_substeps)
      .def_rw("least_trust", &S::least_trust)
      .def_rw("settle", &S::settle)
      .def_prop_rw("initial_pose",
                   [](const S& s) { return s.initial_pose ? nb::cast(to_numpy(*s.initial_pose)) : nb::none(); },
                   [](S& s, const std::optional<PoseIn>& p) {
                     s.initial_pose = p ? std::optional<Pose>(as_pose(*p)) : std::nullopt; },
                   nb::arg().none(), "(6,) or None");
  using F = fdk::KneeFrame;
  using K = fdk::KneeSimulation;
  nb::class_<K>(m, "KneeSimulation", "Result of simulate, as arrays over time frames.")
      .def_prop_ro("poses", [](const K& k) { return poses(k.frames); }, kNew, "(n, 6)")
      .def_prop_ro("wrenches", [](const K& k) { return wrenches(k.frames); }, kNew, "(n, 2, 6)")
      .def_prop_ro("kinematics", &clinical, kNew, "(n, 6)")
      .def_prop_ro("residuals", &residuals, kNew, "(n, 5) on x, y, z, theta_x, theta_y [N, Nm]")
      .def_prop_ro("status", [](const K& k) {
        return column<int>(k.frames, [](const F& f) { return static_cast<int>(f.status); }); }, kNew, "(n,)")
      .def_prop_ro("worst_coordinate", [](const K& k) {
        return column<int>(k.frames, [](const F& f) { return f.worst_coordinate; }); }, kNew, "(n,) position in a pose")
      .def_prop_ro("iterations", [](const K& k) {
        return column<std::int64_t>(k.frames, [](const F& f) { return f.iterations; }); }, kNew, "(n,)")
      .def_prop_ro("evaluations", [](const K& k) {
        return column<std::int64_t>(k.frames, [](const F& f) { return f.evaluations; }); }, kNew, "(n,)")
      .def_prop_ro("substeps", [](const K& k) {
        return column<std::int64_t>(k.frames, [](const F& f) { return f.substeps; }); }, kNew, "(n,)")
      .def_prop_ro("trust", [](const K& k) {
        return column<double>(k.frames, [](const F& f) { return f.loads.trust; }); }, kNew, "(n,)")
      .def_ro("restraint", &K::restraint, "As used, references filled in.")
      .def_ro("axial_offset", &K::axial_offset, "As used [m].")
      .def_ro("not_converged", &K::not_converged).def_ro("implausible", &K::implausible)
      .def_ro("untrusted", &K::untrusted)
      .def_prop_ro("summary", [](const K& k) { return fdk::summary(k); });
  m.def("simulate_knee", &simulate, "model"_a, "time"_a, "flexion"_a, "axial_force"_a, "ap_force"_a,
        "ie_torque"_a, "settings"_a);
  m.def("settled_pose", [](const ContactModel& model, double flexion, const T& settings) {
          nb::gil_scoped_release release;
          return fdk::settled_pose(model, flexion, settings); },
        "model"_a, "flexion"_a, "settings"_a);
}

}  // namespace

void bind_fdk(nb::module_& m) {
  bind_static(m);
  bind_ligaments(m);
  nb::class_<fdk::SettledPose>(m, "SettledPose", "Where the femur rests, rotations zero.")
      .def_prop_ro("pose", [](const fdk::SettledPose& s) { return to_numpy(s.pose); }, kNew, "(6,)")
      .def_ro("touched", &fdk::SettledPose::touched)
      .def_prop_ro("converged", &fdk::SettledPose::converged);
  bind_simulator(m);
}

}  // namespace condyle::bindings
