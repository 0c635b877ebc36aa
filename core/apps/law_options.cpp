// SPDX-License-Identifier: Apache-2.0
#include "law_options.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "condyle/io/table.hpp"

namespace condyle::apps {
namespace {

/// A law by name, and the options that are its parameters, every one needed unless it says so.
struct Law {
  const char* name;
  std::vector<std::string_view> options;
};

const std::array<Law, 5>& laws() {
  static const std::vector<std::string_view> layer{"--youngs-modulus-mpa", "--poissons-ratio",
                                                   "--thickness-mm"};
  static const std::array<Law, 5> all{{{"linear_volume", {"--modulus"}},
                                       {"thin_layer_linear", layer},
                                       {"thin_layer_logarithmic", layer},
                                       {"power", {"--coefficient", "--exponent"}},
                                       {"table", {"--law-table"}}}};
  return all;
}

/// (option, whether it was given), each option of a parameter once.
std::vector<std::pair<std::string_view, bool>> given(const LawOptions& o) {
  return {{"--modulus", o.modulus.has_value()},
          {"--youngs-modulus-mpa", o.youngs_modulus_mpa.has_value()},
          {"--poissons-ratio", o.poissons_ratio.has_value()},
          {"--thickness-mm", o.thickness_mm.has_value()},
          {"--coefficient", o.coefficient.has_value()},
          {"--exponent", o.exponent.has_value()},
          {"--law-table", !o.law_table.empty()}};
}

const Law& find_law(const std::string& name) {
  std::string known;
  for (const Law& law : laws()) {
    if (name == law.name) return law;
    known += (known.empty() ? "" : ", ") + std::string(law.name);
  }
  throw std::invalid_argument("--law is '" + name + "': must be one of " + known);
}

void require_options_of(const Law& law, const LawOptions& options) {
  for (const auto& [option, is_given] : given(options)) {
    const bool belongs =
        std::find(law.options.begin(), law.options.end(), option) != law.options.end();
    if (is_given && !belongs) {
      throw std::invalid_argument(std::string(option) + " does not go with --law " + law.name);
    }
    if (!is_given && belongs && option != "--modulus") {  // which has a default
      throw std::invalid_argument(std::string("--law ") + law.name + " needs " +
                                  std::string(option));
    }
  }
}

contact::ElasticLayer layer(const LawOptions& options) {
  return {1e6 * *options.youngs_modulus_mpa, *options.poissons_ratio, 1e-3 * *options.thickness_mm};
}

/// The column of one of two names, in SI.
std::vector<double> column(const io::Table& table, const char* si, const char* other,
                           double scale) {
  const auto has = [&](std::string_view name) {
    return std::find(table.names.begin(), table.names.end(), name) != table.names.end();
  };
  if (has(si) && has(other)) {
    throw std::invalid_argument(table.source + ": has both columns " + si + " and " + other);
  }
  if (!has(other)) return table.column(si);
  std::vector<double> values = table.column(other);
  for (double& value : values) value *= scale;
  return values;
}

contact::TableLaw read_table_law(const std::string& file) {
  const io::Table table = io::read_table(file);
  const std::vector<double> depth = column(table, "depth_m", "depth_mm", 1e-3);
  const std::vector<double> pressure = column(table, "pressure_Pa", "pressure_MPa", 1e6);
  try {
    return {depth, pressure};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(file + ": " + error.what());
  }
}

}  // namespace

void add_law_options(CLI::App& command, LawOptions& options, const std::string& group) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    command.add_option(name, value, help)->group(group);
  };
  add("--law", options.law,
      "linear_volume (default), thin_layer_linear, thin_layer_logarithmic, power or table");
  add("--modulus", options.modulus, "K in p = K d [N/m^3] (default: 9.3e9)");
  add("--youngs-modulus-mpa", options.youngs_modulus_mpa, "E of a thin layer");
  add("--poissons-ratio", options.poissons_ratio, "Of a thin layer");
  add("--thickness-mm", options.thickness_mm, "Of a thin layer");
  add("--coefficient", options.coefficient, "c in p = c d^n [Pa/m^n]");
  add("--exponent", options.exponent, "n in p = c d^n");
  add("--law-table", options.law_table, "CSV: depth_mm,pressure_MPa (or depth_m,pressure_Pa)");
}

std::optional<std::string> first_given(const LawOptions& options) {
  if (!options.law.empty()) return "--law";
  for (const auto& [option, is_given] : given(options)) {
    if (is_given) return std::string(option);
  }
  return std::nullopt;
}

contact::ContactLaw read_law(const LawOptions& options) {
  const Law& law = find_law(options.law.empty() ? laws().front().name : options.law);
  require_options_of(law, options);
  const std::string_view name = law.name;
  if (name == "thin_layer_linear") {
    return contact::ContactLaw(contact::ThinLayerLinearLaw{layer(options)});
  }
  if (name == "thin_layer_logarithmic") {
    return contact::ContactLaw(contact::ThinLayerLogarithmicLaw{layer(options)});
  }
  if (name == "power") {
    return contact::ContactLaw(contact::PowerLaw{*options.coefficient, *options.exponent});
  }
  if (name == "table") return contact::ContactLaw(read_table_law(options.law_table));
  contact::LinearVolumeLaw linear;
  linear.modulus = options.modulus.value_or(linear.modulus);
  return contact::ContactLaw(linear);
}

}  // namespace condyle::apps
