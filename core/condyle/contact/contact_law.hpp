// SPDX-License-Identifier: Apache-2.0
// Contact laws: how much energy a unit of surface stores at a penetration depth.
//
// A law is a function W(d) [J/m²] with W(0) = 0 and W′(0) = 0. Its derivatives are the pressure
// p(d) = W′(d) [Pa] and the pressure rate p′(d) = W″(d) [Pa/m]. The contact energy of a pose is U =
// Σ A·W(d), and everything else is a derivative of it.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "condyle/contact/elastic_layer.hpp"

namespace condyle::contact {

/// Pressure proportional to depth: W = K d²/2, p = K d. Total force is then K times the overlap
/// volume. Source: Marra et al. 2015, J Biomech Eng 137(2):020904; 2017, where K = 9.3e9 N/m³
/// stands for polyethylene: for forces and kinematics, not for pressures (elastic_layer.hpp).
struct LinearVolumeLaw {
  double modulus = 9.3e9;  ///< K, the pressure modulus [N/m³]
};

/// Thin elastic layer under small strain: p = M d/h. The same as LinearVolumeLaw with K = M/h, said
/// in material and thickness. Source: Blankevoort et al. 1991; Bei & Fregly 2004
/// (elastic_layer.hpp).
struct ThinLayerLinearLaw {
  ElasticLayer layer;
};

/// Thin elastic layer that stiffens as it is squeezed (logarithmic strain): with s = d/h,
///   p = −M ln(1 − s),  W = M h [(1 − s) ln(1 − s) + s],
/// which is p = M s (1 + s/2 + …) for small s. The law ends where the layer would be squeezed to
/// nothing, and no knee gets there: beyond s = kLogarithmicRange the pressure goes on along its
/// tangent (p is C1, W the integral of it), so that a solver far off gets a finite answer. Results
/// at such a depth are beyond the law. Source: Bei & Fregly 2004 (elastic_layer.hpp).
struct ThinLayerLogarithmicLaw {
  ElasticLayer layer;
};

/// Depth over thickness up to which ThinLayerLogarithmicLaw is its formula.
inline constexpr double kLogarithmicRange = 0.9;

/// p = c dⁿ, W = c dⁿ⁺¹/(n + 1). n >= 1: below, the pressure rate at touch would be infinite.
struct PowerLaw {
  double coefficient = 0.0;  ///< c [Pa/mⁿ], > 0
  double exponent = 1.0;     ///< n, >= 1
};

/// W and its first two derivatives at one depth.
struct LawValue {
  double energy = 0.0;         ///< W(d) [J/m²]
  double pressure = 0.0;       ///< p = W′(d) [Pa]
  double pressure_rate = 0.0;  ///< W″(d) [Pa/m]
};

/// Measured pressures: linear between the user's points, on along the last slope beyond them. W is
/// the exact integral. p is continuous; p′ jumps at the points, where it is the shallower side's.
class TableLaw {
 public:
  /// @param depth [m], from 0, strictly rising. @param pressure [Pa], from 0, never falling, as
  /// many; the last above 0.
  /// @throws std::invalid_argument naming the point, its value and the limit.
  TableLaw(std::vector<double> depth, std::vector<double> pressure);

  /// @pre depth > 0.
  LawValue at(double depth) const;

  const std::vector<double>& depth() const { return depth_; }
  const std::vector<double>& pressure() const { return pressure_; }

 private:
  std::vector<double> depth_, pressure_, energy_;  // at the points
};

/// Name and parameters, for metadata and reports. A parameter's name carries its unit. A table's
/// parameters are all its points: depth_0_m, pressure_0_Pa, depth_1_m, …
struct LawDescription {
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;
};

/// Any of the laws, as a value.
class ContactLaw {
 public:
  using Variant = std::variant<LinearVolumeLaw, ThinLayerLinearLaw, ThinLayerLogarithmicLaw,
                               PowerLaw, TableLaw>;

  /// @throws std::invalid_argument naming the law and the parameter that is out of range, its value
  /// and the limit.
  ContactLaw(const Variant& law = LinearVolumeLaw{});  // NOLINT: a law converts to "any law"

  /// W, p and p′ at a depth; all zero at d <= 0 (where p′ is the value from the side of no
  /// contact).
  LawValue at(double depth) const { return at(depth, layer_); }

  /// The same with another layer than the law's own, for layers that vary from face to face. A law
  /// that has no layer ignores it.
  LawValue at(double depth, const Layer& layer) const {
    if (!(depth > 0.0)) return {};
    return std::visit([&](const auto& law) { return value(law, layer, depth); }, law_);
  }

  /// Whether the law is one of an elastic layer, which can differ from face to face.
  bool has_layer() const {
    return std::holds_alternative<ThinLayerLinearLaw>(law_) ||
           std::holds_alternative<ThinLayerLogarithmicLaw>(law_);
  }

  LawDescription describe() const;

  /// The law itself, for kernels that have a version for each law.
  const Variant& variant() const { return law_; }

 private:
  static LawValue value(const LinearVolumeLaw& law, const Layer&, double d) {
    return {0.5 * law.modulus * d * d, law.modulus * d, law.modulus};
  }
  static LawValue value(const ThinLayerLinearLaw&, const Layer& layer, double d) {
    return value(LinearVolumeLaw{layer.modulus / layer.thickness}, layer, d);
  }
  static LawValue value(const ThinLayerLogarithmicLaw&, const Layer& layer, double d);
  static LawValue value(const PowerLaw& law, const Layer&, double d);
  static LawValue value(const TableLaw& law, const Layer&, double d) { return law.at(d); }

  Variant law_;
  Layer layer_{};  // of a law that has one
};

}  // namespace condyle::contact
