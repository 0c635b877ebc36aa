// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/problem.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace condyle::recruitment {
namespace {

template <typename Value>
[[noreturn]] void refuse(const std::string& what, Value value, std::string_view limit) {
  std::ostringstream text;
  text << "recruitment: " << what << " = " << value << ": must be " << limit;
  throw std::invalid_argument(text.str());
}

void require_size(const char* field, Eigen::Index size, int needed, bool may_be_empty) {
  if (size == needed || (may_be_empty && size == 0)) return;
  refuse(std::string("size of ") + field, size, std::to_string(needed));
}

// `least` itself is allowed where `closed`.
template <typename Values, typename Name>
void require_at_least(const char* field, const Values& values, bool closed, const Name& name_of) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double v = values[i];
    if (std::isfinite(v) && (closed ? v >= 0.0 : v > 0.0)) continue;
    refuse(std::string(field) + " of " + name_of(static_cast<int>(i)), v,
           closed ? "finite and at least 0" : "finite and more than 0");
  }
}

}  // namespace

std::string RecruitmentSetup::coordinate_name(int j) const {
  const auto index = static_cast<std::size_t>(j);
  return index < coordinate_names.size() ? coordinate_names[index]
                                         : "coordinate " + std::to_string(j);
}

std::string RecruitmentSetup::muscle_name(int i) const {
  const auto index = static_cast<std::size_t>(i);
  return index < muscle_names.size() ? muscle_names[index] : "muscle " + std::to_string(i);
}

std::string_view name(RecruitmentStatus status) {
  switch (status) {
    case RecruitmentStatus::kConverged: return "converged";
    case RecruitmentStatus::kInfeasible: return "infeasible";
    case RecruitmentStatus::kMaxIterations: return "max_iterations";
  }
  return "unknown";
}

std::string_view advice(RecruitmentStatus status) {
  switch (status) {
    case RecruitmentStatus::kConverged: return "The optimality conditions hold to the tolerance.";
    case RecruitmentStatus::kInfeasible:
      return "No muscle forces within their bounds carry the loads: look at the named coordinates' loads, signs and "
             "moment arms, add a reserve there, or turn upper bounds off.";
    case RecruitmentStatus::kMaxIterations:
      return "The optimality conditions do not hold to the tolerance: allow more iterations, or choose an exponent "
             "between 1.05 and 8 (1 and min–max have methods of their own).";
  }
  return "";
}

void require_valid(const RecruitmentSetup& setup, const RecruitmentSettings& settings) {
  const int n = setup.coordinates, m = setup.muscles;
  if (n < 1 || n > kMaxCoordinates) {
    refuse("coordinates", n, "from 1 to " + std::to_string(kMaxCoordinates));
  }
  if (m < 1) refuse("muscles", m, "at least 1");
  require_size("coordinate_names", static_cast<Eigen::Index>(setup.coordinate_names.size()), n, true);
  require_size("muscle_names", static_cast<Eigen::Index>(setup.muscle_names.size()), m, true);
  require_size("weights", setup.weights.size(), m, true);
  require_size("reserve_strengths", setup.reserve_strengths.size(), n, true);
  require_size("reserve_prices", setup.reserve_prices.size(), n, true);
  const auto muscle = [&](int i) { return setup.muscle_name(i); };
  const auto coordinate = [&](int j) { return setup.coordinate_name(j); };
  require_at_least("weight", setup.weights, false, muscle);
  require_at_least("reserve strength", setup.reserve_strengths, true, coordinate);
  require_at_least("reserve price", setup.reserve_prices, false, coordinate);
  const double p = settings.criterion.exponent;
  if (!settings.criterion.min_max && !(std::isfinite(p) && p >= 1.0)) {
    refuse("exponent", p, "finite and at least 1");
  }
  if (settings.max_iterations < 1) refuse("max_iterations", settings.max_iterations, "at least 1");
  if (!(settings.tolerance > 0.0 && settings.tolerance < 1.0)) {
    refuse("tolerance", settings.tolerance, "between 0 and 1");
  }
}

void require_valid(const RecruitmentFrame& frame, const RecruitmentSetup& setup,
                   const RecruitmentSettings& settings) {
  const int n = setup.coordinates, m = setup.muscles;
  require_size("moment_arms' rows", frame.moment_arms.rows(), n, false);
  require_size("moment_arms' columns", frame.moment_arms.cols(), m, false);
  require_size("loads", frame.loads.size(), n, false);
  require_size("strengths", frame.strengths.size(), m, false);
  require_size("minima", frame.minima.size(), m, true);
  for (int j = 0; j < n; ++j) {
    if (!std::isfinite(frame.loads[j])) {
      refuse("load of " + setup.coordinate_name(j), frame.loads[j], "finite");
    }
  }
  // One pass over the sum: a product with 0 is 0 but for inf and nan.
  if (!((frame.moment_arms.array() * 0.0).sum() == 0.0)) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < m; ++i) {
        const double r = frame.moment_arms(j, i);
        if (!std::isfinite(r)) {
          refuse("moment arm of " + setup.muscle_name(i) + " about " + setup.coordinate_name(j), r, "finite");
        }
      }
    }
  }
  const auto muscle = [&](int i) { return setup.muscle_name(i); };
  require_at_least("strength", frame.strengths, true, muscle);
  require_at_least("minimum", frame.minima, true, muscle);
  for (int i = 0; i < frame.minima.size(); ++i) {
    const double least = frame.minima[i], most = frame.strengths[i];
    if (least > 0.0 && (most == 0.0 || (settings.upper_bounds && least > most))) {
      std::ostringstream limit;
      limit << "at most its strength, " << most;
      refuse("minimum of " + setup.muscle_name(i), least, limit.str());
    }
  }
}

}  // namespace condyle::recruitment
