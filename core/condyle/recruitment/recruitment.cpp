// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/recruitment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace condyle::recruitment {
namespace {

// Above, the dual's kinks lead Newton's method astray (InteriorPoint).
constexpr double kInteriorFrom = 3.0;
// From a warm start it either gets there soon or not at all.
constexpr int kPolishSteps = 30;
// A load that is not met by less is rounding: scaled loads are of order one.
constexpr double kUnmet = 1e-9;
// p of the problem whose solution the interior point method starts from.
constexpr double kStartExponent = 3.0;

}  // namespace

struct RecruitmentSolver::Workspace {
  Workspace(RecruitmentSetup setup_in, RecruitmentSettings settings_in);

  const Recruitment& solve(const RecruitmentFrame& frame, const WarmStart* warm);
  RecruitmentStatus solve_power(const WarmStart* warm);
  RecruitmentStatus solve_interior();
  RecruitmentStatus solve_linear(const WarmStart* warm);
  RecruitmentStatus solve_min_max();
  void linear_program();
  bool infeasible();
  void take_basis();
  void results(RecruitmentStatus status, const RecruitmentFrame& frame);
  void objective();
  void states();
  void keep_warm_start();
  void prepare_sensitivity();

  RecruitmentSetup setup;
  RecruitmentSettings settings;
  int n, m;
  ScaledProblem problem;
  std::unique_ptr<DualNewton> newton, start;  // p; p = 3
  std::unique_ptr<InteriorPoint> interior;
  std::unique_ptr<MinMax> min_max;
  LinearProgram program;
  BoundedSimplex simplex;
  ActiveSystem system;      // p = 1
  std::vector<int> held;    // (m + 2n) p = 1
  Sensitivity sensitivity;
  Vector x, y, multipliers, slope, reserve_slope;
  Vector change, df, de;  // one direction of a derivative
  Recruitment result;
  WarmStart next, empty;
  bool sensitivity_ready = false;
};

RecruitmentSolver::Workspace::Workspace(RecruitmentSetup setup_in, RecruitmentSettings settings_in)
    : setup((require_valid(setup_in, settings_in), std::move(setup_in))),
      settings(settings_in),
      n(setup.coordinates),
      m(setup.muscles),
      problem(setup, settings),
      program(n, m + 2 * n),
      simplex(n, m + 2 * n),
      system(n, m),
      held(static_cast<std::size_t>(m + 2 * n)),
      sensitivity(n, m, !settings.criterion.min_max && settings.criterion.exponent > kInteriorFrom),
      x(Vector::Zero(m)),
      y(Vector::Zero(n)),
      multipliers(Vector::Zero(n)),
      slope(Vector::Zero(m)),
      reserve_slope(Vector::Zero(n)),
      change(n),
      df(m),
      de(n) {
  const double p = settings.criterion.exponent;
  if (settings.criterion.min_max) {
    min_max = std::make_unique<MinMax>(n, m);
  } else if (p > 1.0) {
    newton = std::make_unique<DualNewton>(n, m, p);
    start = std::make_unique<DualNewton>(n, m, kStartExponent);
    interior = std::make_unique<InteriorPoint>(n, m, p);
  }
  for (Vector* v : {&result.forces, &result.activities}) *v = Vector::Zero(m);
  for (Vector* v : {&result.reserves, &result.multipliers, &result.unmet}) *v = Vector::Zero(n);
  const auto columns = static_cast<std::size_t>(m + 2 * n);
  result.unmet_coordinates.reserve(static_cast<std::size_t>(n));
  result.states.resize(static_cast<std::size_t>(m));
  result.levels.reserve(columns + 1);
  next.multipliers.resize(n);
  next.basis.resize(static_cast<std::size_t>(n));
  next.at_upper.resize(columns);
}

RecruitmentStatus RecruitmentSolver::Workspace::solve_power(const WarmStart* warm) {
  const double p = settings.criterion.exponent;
  const bool interior_first = p > kInteriorFrom;
  if (warm != nullptr) {
    for (int j = 0; j < n; ++j) newton->multipliers[j] = warm->multipliers[j] / problem.multiplier_scale(j, p);
  }
  if (warm != nullptr || !interior_first) {
    const int most = interior_first ? std::min(kPolishSteps, settings.max_iterations) : settings.max_iterations;
    const auto outcome = newton->solve(problem, warm != nullptr, most, settings.tolerance);
    result.iterations = newton->iterations;
    if (outcome == DualNewton::Outcome::kConverged) {
      x = newton->x;
      y = newton->y;
      multipliers = newton->multipliers;
      slope = newton->slope;
      reserve_slope = newton->reserve_slope;
      return RecruitmentStatus::kConverged;
    }
    if (outcome == DualNewton::Outcome::kUnbounded && infeasible()) return RecruitmentStatus::kInfeasible;
  }
  return solve_interior();
}

RecruitmentStatus RecruitmentSolver::Workspace::solve_interior() {
  if (problem.b.isZero(0.0) && problem.lower.isZero(0.0)) {
    // Nothing to carry: the one solution that has no inside.
    for (Vector* v : {&x, &y, &multipliers, &slope, &reserve_slope}) v->setZero();
    return RecruitmentStatus::kConverged;
  }
  const auto outcome = start->solve(problem, false, settings.max_iterations, settings.tolerance);
  if (outcome != DualNewton::Outcome::kConverged && infeasible()) return RecruitmentStatus::kInfeasible;
  interior->solve(problem, start->x, settings.max_iterations);
  result.iterations += start->iterations + interior->iterations;
  newton->multipliers = interior->multipliers;
  const auto polished = newton->polish(problem, interior->price_gap, kPolishSteps, settings.tolerance);
  result.iterations += newton->iterations;
  const bool better = polished == DualNewton::Outcome::kConverged;
  x = better ? newton->x : interior->x;
  y = better ? newton->y : interior->y;
  multipliers = better ? newton->multipliers : interior->multipliers;
  slope = better ? newton->slope : interior->slope;
  reserve_slope = better ? newton->reserve_slope : interior->reserve_slope;
  return RecruitmentStatus::kConverged;
}

// Forces that meet the loads, or as nearly as bounds allow; true where they do not.
bool RecruitmentSolver::Workspace::infeasible() {
  linear_program();
  simplex.forget();
  simplex.find_feasible(program);
  return simplex.infeasibility > kUnmet;
}

void RecruitmentSolver::Workspace::linear_program() {
  program.G.leftCols(m) = problem.A;
  program.b = problem.b;
  program.cost.head(m) = problem.weight;
  program.lower.head(m) = problem.lower;
  program.upper.head(m) = problem.upper;
  for (int j = 0; j < n; ++j) {
    for (int side = 0; side < 2; ++side) {
      const int i = m + side * n + j;
      program.G(j, i) = side == 0 ? problem.reserve[j] : -problem.reserve[j];
      program.cost[i] = problem.price[j];
      program.upper[i] = problem.reserve[j] > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
    }
  }
}

void RecruitmentSolver::Workspace::take_basis() {
  x = simplex.values.head(m);
  y = simplex.values.segment(m, n) - simplex.values.tail(n);
  multipliers = simplex.multipliers;
  for (int i = 0; i < m + 2 * n; ++i) {
    const auto index = static_cast<std::size_t>(i);
    held[index] = simplex.at_upper[index] ? kAtUpper : kAtLower;
  }
  for (int j : simplex.basis) {
    if (j < m + 2 * n) held[static_cast<std::size_t>(j)] = kFree;
  }
}

RecruitmentStatus RecruitmentSolver::Workspace::solve_linear(const WarmStart* warm) {
  linear_program();
  simplex.forget();
  if (warm != nullptr) {
    simplex.basis = warm->basis;
    simplex.at_upper = warm->at_upper;
  }
  auto outcome = simplex.solve(program);
  result.iterations = simplex.iterations;
  if (outcome == BoundedSimplex::Outcome::kInfeasible) {
    // From the logicals the violation gathers in few coordinates.
    return infeasible() ? RecruitmentStatus::kInfeasible : RecruitmentStatus::kMaxIterations;
  }
  take_basis();
  return outcome == BoundedSimplex::Outcome::kOptimal && system.build(problem, held, 0)
             ? RecruitmentStatus::kConverged
             : RecruitmentStatus::kMaxIterations;
}

RecruitmentStatus RecruitmentSolver::Workspace::solve_min_max() {
  const auto outcome = min_max->solve(problem);
  result.iterations = min_max->iterations;
  if (outcome == MinMax::Outcome::kInfeasible && infeasible()) return RecruitmentStatus::kInfeasible;
  x = min_max->x;
  y = min_max->y;
  multipliers = min_max->multipliers;
  return outcome == MinMax::Outcome::kConverged ? RecruitmentStatus::kConverged
                                                : RecruitmentStatus::kMaxIterations;
}

void RecruitmentSolver::Workspace::states() {
  const Criterion& criterion = settings.criterion;
  for (int i = 0; i < m; ++i) {
    const auto index = static_cast<std::size_t>(i);
    MuscleState state = MuscleState::kBetween;
    if (criterion.min_max) {
      const int what = min_max->held[index];
      if (what >= 0) state = MuscleState::kAtLevel;
      if (what == kAtLower) state = MuscleState::kAtMinimum;
      if (what == kAtUpper) state = MuscleState::kAtStrength;
    } else if (x[i] <= problem.lower[i]) {
      state = MuscleState::kAtMinimum;
    } else if (x[i] >= problem.upper[i]) {
      state = MuscleState::kAtStrength;
    }
    result.states[index] = state;
  }
}

void RecruitmentSolver::Workspace::objective() {
  const Criterion& criterion = settings.criterion;
  result.levels.clear();
  if (criterion.min_max) {
    const double unit = problem.load_scale * problem.weight_scale;
    result.objective = unit * largest_level(problem, x, y);
    if (result.converged()) {
      for (double t : min_max->levels) result.levels.push_back(unit * t);
    }
    return;
  }
  const double p = criterion.exponent;
  double sum = 0.0;
  for (int i = 0; i < m; ++i) sum += problem.weight[i] * std::pow(std::max(x[i], 0.0), p);
  for (int j = 0; j < n; ++j) sum += problem.price[j] * std::pow(std::abs(y[j]), p);
  result.objective = problem.weight_scale * std::pow(problem.load_scale, p) * sum;
}

void RecruitmentSolver::Workspace::results(RecruitmentStatus status, const RecruitmentFrame& frame) {
  const Criterion& criterion = settings.criterion;
  if (status == RecruitmentStatus::kInfeasible) {
    x = simplex.values.head(m);
    y = simplex.values.segment(m, n) - simplex.values.tail(n);
    multipliers = simplex.multipliers;
  }
  result.kkt = kkt_residuals(problem, criterion, x, y, multipliers);
  if (status == RecruitmentStatus::kConverged && !(result.kkt.largest() <= settings.tolerance)) {
    status = RecruitmentStatus::kMaxIterations;
  }
  result.status = status;
  states();
  result.activities = problem.load_scale * x;
  result.forces = result.activities.cwiseProduct(frame.strengths);
  for (int i = 0; i < m; ++i) {
    // Bounds as they were given, without the rounding of the scale.
    const MuscleState state = result.states[static_cast<std::size_t>(i)];
    if (state == MuscleState::kAtStrength) result.forces[i] = frame.strengths[i];
    if (state == MuscleState::kAtMinimum) result.forces[i] = frame.minima.size() > 0 ? frame.minima[i] : 0.0;
  }
  const double p = criterion.min_max ? 1.0 : criterion.exponent;
  result.unmet_coordinates.clear();
  for (int j = 0; j < n; ++j) {
    result.reserves[j] = problem.load_scale * y[j] * problem.reserve[j] / problem.row_scale[j];
    result.unmet[j] = frame.loads[j] - frame.moment_arms.row(j).dot(result.forces) - result.reserves[j];
    result.multipliers[j] = multipliers[j] * problem.multiplier_scale(j, p);
    const double off = std::abs(result.unmet[j]) * problem.row_scale[j] / problem.load_scale;
    if (status == RecruitmentStatus::kInfeasible && off > 0.1 * kUnmet) {
      result.unmet_coordinates.push_back(j);
    }
  }
  std::sort(result.unmet_coordinates.begin(), result.unmet_coordinates.end(), [&](int a, int b) {
    const double of_a = std::abs(result.unmet[a]) * problem.row_scale[a];
    const double of_b = std::abs(result.unmet[b]) * problem.row_scale[b];
    return of_a != of_b ? of_a > of_b : a < b;
  });
  objective();
}

void RecruitmentSolver::Workspace::keep_warm_start() {
  if (!result.converged()) return;
  next.multipliers = result.multipliers;
  next.basis = simplex.basis;
  next.at_upper = simplex.at_upper;
}

const Recruitment& RecruitmentSolver::Workspace::solve(const RecruitmentFrame& frame, const WarmStart* warm) {
  require_valid(frame, setup, settings);
  if (warm != nullptr && warm->empty()) warm = nullptr;
  if (warm != nullptr && (warm->multipliers.size() != n || warm->basis.size() != next.basis.size() ||
                          warm->at_upper.size() != next.at_upper.size())) {
    throw std::invalid_argument("recruitment: warm start of a problem of another size: must be of " +
                                std::to_string(n) + " coordinates and " + std::to_string(m) + " muscles");
  }
  problem.set_frame(frame, settings.upper_bounds);
  sensitivity_ready = false;
  result.iterations = 0;
  RecruitmentStatus status;
  if (settings.criterion.min_max) {
    status = solve_min_max();
  } else if (settings.criterion.exponent == 1.0) {
    status = solve_linear(warm);
  } else {
    status = solve_power(warm);
  }
  results(status, frame);
  keep_warm_start();
  return result;
}

void RecruitmentSolver::Workspace::prepare_sensitivity() {
  if (sensitivity_ready) return;
  if (!result.converged()) {
    throw std::logic_error("recruitment: no derivatives of a result that is " + std::string(name(result.status)));
  }
  if (settings.criterion.min_max) {
    sensitivity.at_linear(problem, x, min_max->system);
  } else if (settings.criterion.exponent == 1.0) {
    sensitivity.at_linear(problem, x, system);
  } else {
    sensitivity.at_power(problem, x, multipliers, slope, reserve_slope);
  }
  sensitivity_ready = true;
}

RecruitmentSolver::RecruitmentSolver(RecruitmentSetup setup, RecruitmentSettings settings)
    : work_(std::make_unique<Workspace>(std::move(setup), settings)) {}
RecruitmentSolver::~RecruitmentSolver() = default;
RecruitmentSolver::RecruitmentSolver(RecruitmentSolver&&) noexcept = default;
RecruitmentSolver& RecruitmentSolver::operator=(RecruitmentSolver&&) noexcept = default;

const Recruitment& RecruitmentSolver::solve(const RecruitmentFrame& frame) {
  return work_->solve(frame, nullptr);
}
const Recruitment& RecruitmentSolver::solve(const RecruitmentFrame& frame, const WarmStart& warm) {
  return work_->solve(frame, &warm);
}
const WarmStart& RecruitmentSolver::warm_start() const {
  return work_->result.converged() ? work_->next : work_->empty;
}
const Recruitment& RecruitmentSolver::result() const { return work_->result; }
const RecruitmentSetup& RecruitmentSolver::setup() const { return work_->setup; }
const RecruitmentSettings& RecruitmentSolver::settings() const { return work_->settings; }

bool RecruitmentSolver::sensitivity_is_regular() {
  work_->prepare_sensitivity();
  return work_->sensitivity.regular();
}

void RecruitmentSolver::forces_by_loads(Eigen::Ref<RowMatrix> forces, Eigen::Ref<RowMatrix> reserves) {
  Workspace& w = *work_;
  w.prepare_sensitivity();
  if (forces.rows() != w.m || forces.cols() != w.n || reserves.rows() != w.n || reserves.cols() != w.n) {
    throw std::invalid_argument("recruitment: forces_by_loads: forces must be (" + std::to_string(w.m) + ", " +
                                std::to_string(w.n) + ") and reserves (n, n)");
  }
  for (int j = 0; j < w.n; ++j) {
    w.change.setZero();
    w.change[j] = 1.0;
    w.sensitivity.along(w.change, Eigen::Map<const RowMatrix>(nullptr, 0, w.m),
                        Eigen::Map<const Vector>(nullptr, 0), w.df, w.de);
    forces.col(j) = w.df;
    reserves.col(j) = w.de;
  }
}

void RecruitmentSolver::forces_along(const Eigen::Ref<const RowMatrix>& loads,
                                     const Eigen::Ref<const RowMatrix>& moment_arms,
                                     const Eigen::Ref<const RowMatrix>& strengths,
                                     Eigen::Ref<RowMatrix> forces, Eigen::Ref<RowMatrix> reserves) {
  Workspace& w = *work_;
  w.prepare_sensitivity();
  const Eigen::Index k = loads.rows();
  const auto fits = [](const auto& given, Eigen::Index rows, Eigen::Index columns) {
    return given.rows() == rows && given.cols() == columns;
  };
  if (!fits(loads, k, w.n) || !(moment_arms.rows() == 0 || fits(moment_arms, k * w.n, w.m)) ||
      !(strengths.rows() == 0 || fits(strengths, k, w.m)) || !fits(forces, k, w.m) ||
      !fits(reserves, k, w.n)) {
    throw std::invalid_argument("recruitment: forces_along: for k directions, loads must be (k, n), moment_arms "
                                "(k n, m), strengths (k, m), forces (k, m), reserves (k, n)");
  }
  for (Eigen::Index d = 0; d < k; ++d) {
    const auto arms = moment_arms.rows() > 0
                          ? Eigen::Map<const RowMatrix>(moment_arms.data() + d * w.n * w.m, w.n, w.m)
                          : Eigen::Map<const RowMatrix>(nullptr, 0, w.m);
    const auto grown = strengths.rows() > 0 ? Eigen::Map<const Vector>(strengths.data() + d * w.m, w.m)
                                            : Eigen::Map<const Vector>(nullptr, 0);
    w.change = loads.row(d).transpose();
    w.sensitivity.along(w.change, arms, grown, w.df, w.de);
    forces.row(d) = w.df.transpose();
    reserves.row(d) = w.de.transpose();
  }
}

std::string RecruitmentSolver::message() const {
  const Recruitment& r = work_->result;
  std::ostringstream text;
  text << name(r.status) << ": " << advice(r.status);
  if (r.unmet_coordinates.empty()) return text.str();
  text << " Not met:";
  for (int j : r.unmet_coordinates) {
    text << ' ' << work_->setup.coordinate_name(j) << " by " << r.unmet[j] << ';';
  }
  std::string said = text.str();
  said.back() = '.';
  return said;
}

}  // namespace condyle::recruitment
