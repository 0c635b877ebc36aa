// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/elastic_layer.hpp"

#include "condyle/contact/parameter_limits.hpp"

namespace condyle::contact {
namespace {

void require_ratio_and_thickness(double poissons_ratio, double thickness) {
  // At 0.5 a confined layer is rigid.
  require_between({"poissons_ratio", ""}, poissons_ratio, -1.0, 0.5);
  require_above({"thickness", "m"}, thickness, 0.0);
}

// M/E.
double confinement(double poissons_ratio) {
  return (1.0 - poissons_ratio) / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
}

}  // namespace

Layer layer_of(const ElasticLayer& layer) {
  require_above({"youngs_modulus", "Pa"}, layer.youngs_modulus, 0.0);
  require_ratio_and_thickness(layer.poissons_ratio, layer.thickness);
  return {layer.youngs_modulus * confinement(layer.poissons_ratio), layer.thickness};
}

double pressure_modulus(const ElasticLayer& layer) {
  const Layer thin = layer_of(layer);
  return thin.modulus / thin.thickness;
}

double youngs_modulus(double modulus, double poissons_ratio, double thickness) {
  require_above({"modulus", "N/m^3"}, modulus, 0.0);
  require_ratio_and_thickness(poissons_ratio, thickness);
  return modulus * thickness / confinement(poissons_ratio);
}

}  // namespace condyle::contact
