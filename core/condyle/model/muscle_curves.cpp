// SPDX-License-Identifier: Apache-2.0
#include "condyle/model/muscle_curves.hpp"

#include <cmath>

namespace condyle::model {
namespace {

// Each bell: height, centre, and a width that is linear in the length.
struct Bell {
  double height, centre, width, width_slope;
};
constexpr Bell kBells[] = {
    {0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465},
    {0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188},
    {0.1, 1.0, 0.353553390593274, 0.0},
};
// The second bell's width vanishes at 0.15: below 0.2 no fibre works, and the curve is held at what it is there.
constexpr double kShortest = 0.2;

constexpr double kD1 = -0.3211346127989808, kD2 = -8.149, kD3 = -0.374, kD4 = 0.8825327733249912;
constexpr double kPassiveShape = 4.0, kPassiveStrain = 0.6;

}  // namespace

CurvePoint active_force_length(double normalised_length) {
  const double l = normalised_length < kShortest ? kShortest : normalised_length;
  CurvePoint sum;
  for (const Bell& bell : kBells) {
    const double width = bell.width + bell.width_slope * l;
    const double x = (l - bell.centre) / width;
    const double value = bell.height * std::exp(-0.5 * x * x);
    sum.value += value;
    sum.slope -= value * x * (1.0 - bell.width_slope * x) / width;
  }
  if (normalised_length < kShortest) sum.slope = 0.0;
  return sum;
}

CurvePoint force_velocity(double normalised_velocity) {
  const double x = kD2 * normalised_velocity + kD3;
  const double value = kD1 * std::asinh(x) + kD4;
  if (value <= 0.0) return {};
  return {value, kD1 * kD2 / std::sqrt(x * x + 1.0)};
}

CurvePoint passive_force_length(double normalised_length) {
  if (normalised_length <= kShortest) return {};
  const double rate = kPassiveShape / kPassiveStrain;
  const double offset = std::exp(rate * (kShortest - 1.0));
  const double scale = 1.0 / (std::exp(kPassiveShape) - offset);
  const double grown = std::exp(rate * (normalised_length - 1.0));
  return {(grown - offset) * scale, rate * grown * scale};
}

}  // namespace condyle::model
