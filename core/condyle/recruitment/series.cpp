// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/series.hpp"

#include <limits>
#include <stdexcept>

namespace condyle::recruitment {
namespace {

using Arms = Eigen::Map<const RowMatrix>;
using Row = Eigen::Map<const Vector>;

void require(const char* field, std::size_t size, std::size_t needed) {
  if (size == needed) return;
  throw std::invalid_argument("recruitment: " + std::string(field) + " has " + std::to_string(size) +
                              " values: must be " + std::to_string(needed));
}

// Row i of an array of t rows, of one row for all, or of none.
Row row(std::span<const double> values, std::size_t i, std::size_t size) {
  if (values.empty()) return Row(nullptr, 0);
  const double* first = values.data() + (values.size() == size ? 0 : i * size);
  return Row(first, static_cast<Eigen::Index>(size));
}

void require_sizes(const SeriesInput& in, std::size_t t, std::size_t n, std::size_t m) {
  require("loads", in.loads.size(), t * n);
  require("moment_arms", in.moment_arms.size(), t * n * m);
  if (in.strengths.size() != m) require("strengths", in.strengths.size(), t * m);
  if (in.minima.size() != m && !in.minima.empty()) require("minima", in.minima.size(), t * m);
}

RecruitmentSeries sized(Eigen::Index t, Eigen::Index n, Eigen::Index m, bool with_forces_by_loads) {
  RecruitmentSeries out;
  out.status.resize(static_cast<std::size_t>(t));
  out.message.resize(static_cast<std::size_t>(t));
  out.iterations.resize(static_cast<std::size_t>(t));
  for (RowMatrix* a : {&out.forces, &out.activities}) a->resize(t, m);
  for (RowMatrix* a : {&out.reserves, &out.multipliers, &out.unmet}) a->resize(t, n);
  out.kkt.resize(t, 3);
  out.objective.resize(t);
  out.forces_by_loads.resize(with_forces_by_loads ? t * m : 0, n);
  return out;
}

void store(const Recruitment& r, Eigen::Index i, RecruitmentSeries& out) {
  out.status[static_cast<std::size_t>(i)] = r.status;
  out.iterations[static_cast<std::size_t>(i)] = r.iterations;
  out.forces.row(i) = r.forces.transpose();
  out.activities.row(i) = r.activities.transpose();
  out.reserves.row(i) = r.reserves.transpose();
  out.multipliers.row(i) = r.multipliers.transpose();
  out.unmet.row(i) = r.unmet.transpose();
  out.kkt.row(i) << r.kkt.primal, r.kkt.stationarity, r.kkt.complementarity;
  out.objective[i] = r.objective;
}

}  // namespace

RecruitmentSeries recruit_series(RecruitmentSolver& solver, const SeriesInput& in, bool warm_starts,
                                 bool with_forces_by_loads) {
  const auto n = static_cast<std::size_t>(solver.setup().coordinates);
  const auto m = static_cast<std::size_t>(solver.setup().muscles);
  const std::size_t t = in.loads.size() / n;
  require_sizes(in, t, n, m);
  const auto rows = static_cast<Eigen::Index>(n), columns = static_cast<Eigen::Index>(m);
  RecruitmentSeries out = sized(static_cast<Eigen::Index>(t), rows, columns, with_forces_by_loads);
  RowMatrix by_loads(columns, rows), reserves_by_loads(rows, rows);
  WarmStart warm;
  for (std::size_t k = 0; k < t; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const RecruitmentFrame frame{Arms(in.moment_arms.data() + k * n * m, rows, columns), row(in.loads, k, n),
                                 row(in.strengths, k, m), row(in.minima, k, m)};
    try {
      store(solver.solve(frame, warm), i, out);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("time frame " + std::to_string(k) + ": " + error.what());
    }
    const bool converged = solver.result().converged();
    if (!converged) out.message[k] = solver.message();
    if (warm_starts && converged) warm = solver.warm_start();
    if (!with_forces_by_loads) continue;
    by_loads.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (converged) solver.forces_by_loads(by_loads, reserves_by_loads);
    out.forces_by_loads.middleRows(i * columns, columns) = by_loads;
  }
  return out;
}

}  // namespace condyle::recruitment
