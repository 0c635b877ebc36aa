// SPDX-License-Identifier: Apache-2.0
// Limits of a parameter, and the one way to say that a value is outside them.
#pragma once

#include <string>

namespace condyle::contact {

/// A parameter's name and unit (may be empty) in messages.
struct ParameterName {
  std::string name;
  std::string unit;
};

/// @throws std::invalid_argument "<name> is <value> <unit>: must be finite and greater than
/// <bound>" unless so.
void require_above(const ParameterName& parameter, double value, double bound);

/// @throws std::invalid_argument "<name> is <value> <unit>: must be finite and at least <bound>"
/// unless so; `why`, if not empty, is added after a semicolon.
void require_at_least(const ParameterName& parameter, double value, double bound,
                      const std::string& why = {});

/// @throws std::invalid_argument "<name> is <value> <unit>: must be between <low> and <high>, both
/// excluded" unless so.
void require_between(const ParameterName& parameter, double value, double low, double high);

/// A number with the digits that matter in a message.
std::string short_text(double value);

}  // namespace condyle::contact
