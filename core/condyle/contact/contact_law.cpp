// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_law.hpp"

#include <cmath>
#include <stdexcept>

#include "condyle/contact/parameter_limits.hpp"

namespace condyle::contact {
namespace {

// Name of a law as users write it.
constexpr const char* name_of(const LinearVolumeLaw&) { return "linear_volume"; }
constexpr const char* name_of(const ThinLayerLinearLaw&) { return "thin_layer_linear"; }
constexpr const char* name_of(const ThinLayerLogarithmicLaw&) { return "thin_layer_logarithmic"; }
constexpr const char* name_of(const PowerLaw&) { return "power"; }
constexpr const char* name_of(const TableLaw&) { return "table"; }

// Checks a law's parameters; the layer of a law that has one.
Layer checked_layer(const LinearVolumeLaw& law) {
  require_above({"modulus", "N/m^3"}, law.modulus, 0.0);
  return {};
}
Layer checked_layer(const ThinLayerLinearLaw& law) { return layer_of(law.layer); }
Layer checked_layer(const ThinLayerLogarithmicLaw& law) { return layer_of(law.layer); }
Layer checked_layer(const PowerLaw& law) {
  require_above({"coefficient", "Pa/m^n"}, law.coefficient, 0.0);
  require_at_least({"exponent", ""}, law.exponent, 1.0,
                   "below 1 the pressure rate is infinite at touch");
  return {};
}
Layer checked_layer(const TableLaw&) { return {}; }  // a table cannot be built wrong

using Parameters = std::vector<std::pair<std::string, double>>;

Parameters layer_parameters(const ElasticLayer& layer) {
  return {{"youngs_modulus_Pa", layer.youngs_modulus},
          {"poissons_ratio", layer.poissons_ratio},
          {"thickness_m", layer.thickness}};
}

Parameters parameters(const LinearVolumeLaw& law) { return {{"modulus_N_per_m3", law.modulus}}; }
Parameters parameters(const ThinLayerLinearLaw& law) { return layer_parameters(law.layer); }
Parameters parameters(const ThinLayerLogarithmicLaw& law) { return layer_parameters(law.layer); }
Parameters parameters(const PowerLaw& law) {
  return {{"coefficient_Pa_per_m^n", law.coefficient}, {"exponent", law.exponent}};
}
Parameters parameters(const TableLaw& law) {
  Parameters points;
  for (std::size_t i = 0; i < law.depth().size(); ++i) {
    points.emplace_back("depth_" + std::to_string(i) + "_m", law.depth()[i]);
    points.emplace_back("pressure_" + std::to_string(i) + "_Pa", law.pressure()[i]);
  }
  return points;
}

// (1 − s) ln(1 − s) + s = Σ s^k / (k(k − 1)), k = 2, 3, …: the closed form loses 2/s of its digits
// to cancellation, so a small s takes the series. At the bound the first term left out is 2e-19 of
// the sum, and the closed form is good to 70 eps.
double logarithmic_energy(double s) {
  constexpr double kSeriesBound = 0.03;
  constexpr int kLastTerm = 12;
  if (s > kSeriesBound) return (1.0 - s) * std::log1p(-s) + s;
  double sum = 0.0;
  for (int k = kLastTerm; k >= 2; --k) sum = sum * s + 1.0 / (k * (k - 1.0));
  return sum * s * s;
}

}  // namespace

ContactLaw::ContactLaw(const Variant& law) : law_(law) {
  std::visit(
      [this](const auto& any) {
        try {
          layer_ = checked_layer(any);
        } catch (const std::invalid_argument& error) {
          throw std::invalid_argument(std::string("contact law ") + name_of(any) + ": " +
                                      error.what());
        }
      },
      law_);
}

LawDescription ContactLaw::describe() const {
  return std::visit(
      [](const auto& any) {
        return LawDescription{name_of(any), parameters(any)};
      },
      law_);
}

LawValue ContactLaw::value(const ThinLayerLogarithmicLaw&, const Layer& layer, double d) {
  const double M = layer.modulus, h = layer.thickness;
  const double s = std::fmin(d / h, kLogarithmicRange);
  LawValue at_s{M * h * logarithmic_energy(s), -M * std::log1p(-s), M / (h * (1.0 - s))};
  const double beyond = d - s * h;
  if (d / h > kLogarithmicRange) {
    at_s.energy += beyond * (at_s.pressure + 0.5 * beyond * at_s.pressure_rate);
    at_s.pressure += beyond * at_s.pressure_rate;
  }
  return at_s;
}

LawValue ContactLaw::value(const PowerLaw& law, const Layer&, double d) {
  const double n = law.exponent;
  const double rate = law.coefficient * std::pow(d, n - 1.0);
  return {rate * d * d / (n + 1.0), rate * d, n * rate};
}

}  // namespace condyle::contact
