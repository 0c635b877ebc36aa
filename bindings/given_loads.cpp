// SPDX-License-Identifier: Apache-2.0
#include "condyle/fdk/given_loads.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.hpp"

namespace condyle::bindings {
namespace {

using fdk::GivenLoadsFrame;
using fdk::GivenLoadsResult;
using fdk::GivenLoadsSimulation;
using recruitment::RowMatrix;
using TableIn = nb::ndarray<const double, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;
using StackIn = nb::ndarray<const double, nb::shape<-1, -1, -1>, nb::c_contig, nb::device::cpu>;

// Row i of (t, k), or nothing of (0, k).
Eigen::VectorXd row(const TableIn& in, std::size_t i) {
  if (in.shape(0) == 0) return {};
  const auto size = static_cast<Eigen::Index>(in.shape(1));
  return Eigen::Map<const Eigen::VectorXd>(in.data() + static_cast<Eigen::Index>(i) * size, size);
}
// Layer i of (t, rows, columns), or no rows of (0, …).
RowMatrix layer(const StackIn& in, std::size_t i) {
  const auto rows = static_cast<Eigen::Index>(in.shape(1)), columns = static_cast<Eigen::Index>(in.shape(2));
  if (in.shape(0) == 0) return RowMatrix(0, columns);
  return Eigen::Map<const RowMatrix>(in.data() + static_cast<Eigen::Index>(i) * rows * columns, rows, columns);
}

/// Arrays over t time frames, as Python gives them.
struct Given {
  VectorIn flexion;
  TableIn loads, secondary_loads, wrench;
  StackIn moment_arms, secondary_arms;
  TableIn strengths, minima;
  StackIn arms_by_pose;
  TableIn arms_at;
};

void require_rows(const char* field, std::size_t rows, std::size_t t, bool may_be_none) {
  if (rows == t || (may_be_none && rows == 0)) return;
  throw std::invalid_argument("given loads: " + std::string(field) + " has " + std::to_string(rows) +
                              " time frames, flexion has " + std::to_string(t));
}

template <int n>
Eigen::Matrix<double, n, 1> fixed(const TableIn& in, std::size_t i, const char* field) {
  if (in.shape(1) != n) {
    throw std::invalid_argument("given loads: " + std::string(field) + " has " + std::to_string(in.shape(1)) +
                                " columns: must be " + std::to_string(n));
  }
  return Eigen::Map<const Eigen::Matrix<double, n, 1>>(in.data() + n * static_cast<std::ptrdiff_t>(i));
}

std::vector<GivenLoadsFrame> frames_of(const Given& in) {
  const std::size_t t = in.flexion.shape(0);
  require_rows("loads", in.loads.shape(0), t, false);
  require_rows("secondary_loads", in.secondary_loads.shape(0), t, false);
  require_rows("wrench", in.wrench.shape(0), t, false);
  require_rows("moment_arms", in.moment_arms.shape(0), t, false);
  require_rows("secondary_arms", in.secondary_arms.shape(0), t, false);
  require_rows("strengths", in.strengths.shape(0), t, false);
  require_rows("minima", in.minima.shape(0), t, true);
  require_rows("arms_by_pose", in.arms_by_pose.shape(0), t, true);
  require_rows("arms_at", in.arms_at.shape(0), t, false);
  std::vector<GivenLoadsFrame> frames(t);
  for (std::size_t i = 0; i < t; ++i) {
    frames[i] = {in.flexion(i),
                 row(in.loads, i),
                 fixed<5>(in.secondary_loads, i, "secondary_loads"),
                 fixed<6>(in.wrench, i, "wrench"),
                 layer(in.moment_arms, i),
                 layer(in.secondary_arms, i),
                 row(in.strengths, i),
                 row(in.minima, i),
                 layer(in.arms_by_pose, i),
                 fixed<5>(in.arms_at, i, "arms_at")};
  }
  return frames;
}

GivenLoadsSimulation solve(const contact::ContactModel& contact, SideOfBody side,
                           const recruitment::RecruitmentSetup& muscles, int knee_coordinate,
                           bool knee_counts_flexion, const std::vector<model::Ligament>& ligaments,
                           const std::optional<fdk::RestraintSprings>& restraint, const Given& given, const fdk::GivenLoadsSettings& settings) {
  nb::gil_scoped_release release;
  const std::vector<GivenLoadsFrame> frames = frames_of(given);
  return fdk::solve_given_loads(contact, {side, muscles, knee_coordinate, knee_counts_flexion, ligaments, restraint},
                                frames, settings);
}

// (t, size) of what `get` gives of each time frame: anything with data() and size().
template <typename Get>
nb::ndarray<nb::numpy, double> table(const GivenLoadsSimulation& s, Get get) {
  std::vector<double> values;
  for (const GivenLoadsResult& frame : s.frames) {
    const auto& part = get(frame);
    values.insert(values.end(), part.data(), part.data() + part.size());
  }
  return to_numpy(std::move(values), {s.frames.size(), values.size() / s.frames.size()});
}
template <typename Scalar, typename Get>
nb::ndarray<nb::numpy, Scalar> column(const GivenLoadsSimulation& s, Get get) {
  std::vector<Scalar> values;
  for (const GivenLoadsResult& frame : s.frames) values.push_back(static_cast<Scalar>(get(frame)));
  return to_numpy(std::move(values), {s.frames.size()});
}

Eigen::Matrix<double, 12, 1> wrenches(const GivenLoadsResult& r) {
  Eigen::Matrix<double, 12, 1> both;
  both << r.loads.wrench[kMedial], r.loads.wrench[kLateral];
  return both;
}
Vector6 clinical(const GivenLoadsResult& r) {
  const ClinicalKinematics& k = r.clinical;
  return Vector6(k.flexion, k.adduction, k.tibial_external_rotation, k.anterior_tibial_translation,
                 k.distraction, k.lateral_tibial_translation);
}

void bind_result(nb::module_& m) {
  constexpr auto kNew = nb::rv_policy::move;
  using S = GivenLoadsSimulation;
  using R = GivenLoadsResult;
  nb::class_<S>(m, "GivenLoadsSimulation", "Result of solve_given_loads, as arrays over time frames.")
      .def_prop_ro("poses", [](const S& s) { return table(s, [](const R& r) { return r.pose; }); }, kNew, "(t, 6)")
      .def_prop_ro("wrenches", [](const S& s) { return table(s, wrenches); }, kNew, "(t, 12) medial, lateral")
      .def_prop_ro("kinematics", [](const S& s) { return table(s, clinical); }, kNew, "(t, 6)")
      .def_prop_ro("muscle_forces", [](const S& s) { return table(s, [](const R& r) { return r.muscle_forces; }); }, kNew, "(t, m)")
      .def_prop_ro("activities", [](const S& s) { return table(s, [](const R& r) { return r.activities; }); }, kNew, "(t, m)")
      .def_prop_ro("reserves", [](const S& s) { return table(s, [](const R& r) { return r.reserves; }); }, kNew, "(t, n)")
      .def_prop_ro("unmet", [](const S& s) { return table(s, [](const R& r) { return r.unmet; }); }, kNew, "(t, n)")
      .def_prop_ro("ligament_tensions", [](const S& s) { return table(s, [](const R& r) { return r.ligament_tensions; }); }, kNew, "(t, ligaments)")
      .def_prop_ro("residuals", [](const S& s) { return table(s, [](const R& r) { return r.residual; }); }, kNew, "(t, 5)")
      .def_prop_ro("worst_coordinate", [](const S& s) { return column<int>(s, [](const R& r) { return r.worst_coordinate; }); }, kNew, "(t,)")
      .def_prop_ro("iterations", [](const S& s) { return column<std::int64_t>(s, [](const R& r) { return r.iterations; }); }, kNew, "(t,)")
      .def_prop_ro("evaluations", [](const S& s) { return column<std::int64_t>(s, [](const R& r) { return r.evaluations; }); }, kNew, "(t,)")
      .def_prop_ro("substeps", [](const S& s) { return column<std::int64_t>(s, [](const R& r) { return r.substeps; }); }, kNew, "(t,)")
      .def_prop_ro("trust", [](const S& s) { return column<double>(s, [](const R& r) { return r.loads.trust; }); }, kNew, "(t,)")
      .def_prop_ro("status", [](const S& s) {
        std::vector<std::string> names;
        for (const R& r : s.frames) names.emplace_back(name(r.status));
        return names; })
      .def_prop_ro("messages", [](const S& s) {
        std::vector<std::string> texts;
        for (const R& r : s.frames) texts.push_back(r.message);
        return texts; })
      .def_prop_ro("summary", [](const S& s) { return fdk::summary(s); });
}

}  // namespace

void bind_given_loads(nb::module_& m) {
  using namespace nb::literals;
  using S = fdk::GivenLoadsSettings;
  nb::class_<S>(m, "GivenLoadsSettings", "How equilibria under given loads are found.")
      .def(nb::init<>())
      .def_rw("newton", &S::newton)
      .def_rw("recruitment", &S::recruitment)
      .def_rw("max_substeps", &S::max_substeps)
      .def_rw("least_trust", &S::least_trust)
      .def_rw("seating", &S::seating)
      .def_prop_rw("initial_pose",
                   [](const S& s) { return s.initial_pose ? nb::cast(to_numpy(*s.initial_pose)) : nb::none(); },
                   [](S& s, const std::optional<PoseIn>& p) {
                     s.initial_pose = p ? std::optional<Pose>(as_pose(*p)) : std::nullopt; },
                   nb::arg().none(), "(6,) or None");
  nb::class_<Given>(m, "GivenLoads", "Arrays over time frames.")
      .def(nb::init<VectorIn, TableIn, TableIn, TableIn, StackIn, StackIn, TableIn, TableIn, StackIn, TableIn>(),
           "flexion"_a, "loads"_a, "secondary_loads"_a, "wrench"_a, "moment_arms"_a, "secondary_arms"_a,
           "strengths"_a, "minima"_a, "arms_by_pose"_a, "arms_at"_a);
  bind_result(m);
  m.def("solve_given_loads", &solve, "contact"_a, "side_of_body"_a, "muscles"_a, "knee_coordinate"_a,
        "knee_counts_flexion"_a, "ligaments"_a, "restraint"_a.none(), "given"_a, "settings"_a);
}

}  // namespace condyle::bindings
