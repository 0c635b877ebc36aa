// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/parameter_limits.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace condyle::contact {
namespace {

[[noreturn]] void refuse(const ParameterName& parameter, double value, const std::string& limit) {
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  throw std::invalid_argument(parameter.name + " is " + short_text(value) + unit + ": must be " +
                              limit);
}

}  // namespace

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

void require_above(const ParameterName& parameter, double value, double bound) {
  if (std::isfinite(value) && value > bound) return;
  refuse(parameter, value, "finite and greater than " + short_text(bound));
}

void require_at_least(const ParameterName& parameter, double value, double bound,
                      const std::string& why) {
  if (std::isfinite(value) && value >= bound) return;
  refuse(parameter, value,
         "finite and at least " + short_text(bound) + (why.empty() ? "" : "; " + why));
}

void require_between(const ParameterName& parameter, double value, double low, double high) {
  if (value > low && value < high) return;
  refuse(parameter, value,
         "between " + short_text(low) + " and " + short_text(high) + ", both excluded");
}

}  // namespace condyle::contact
