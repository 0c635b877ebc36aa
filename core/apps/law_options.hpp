// SPDX-License-Identifier: Apache-2.0
// The contact law that a user names on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "condyle/contact/contact_law.hpp"

namespace condyle::apps {

/// What the options of a law were set to; one not given is empty.
struct LawOptions {
  std::string law;                // none: linear_volume
  std::optional<double> modulus;  // [N/m³]
  std::optional<double> youngs_modulus_mpa;
  std::optional<double> poissons_ratio;
  std::optional<double> thickness_mm;
  std::optional<double> coefficient;  // [Pa/mⁿ]
  std::optional<double> exponent;
  std::string law_table;  // file
};

/// Adds --law and the options of its parameters, in a group of that name.
void add_law_options(CLI::App& command, LawOptions& options, const std::string& group);

/// The law of the options.
/// @throws std::invalid_argument naming the law and the option that is missing or does not belong
/// to it, or the parameter, its value and its limit.
contact::ContactLaw read_law(const LawOptions& options);

/// The first option that was given, or nothing.
std::optional<std::string> first_given(const LawOptions& options);

}  // namespace condyle::apps
