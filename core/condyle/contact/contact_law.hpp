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

namespace condyle::contact {

/// Pressure proportional to depth: W = K d²/2, p = K d. Total force is then K times the overlap
/// volume. Source: Marra et al. 2015, J Biomech Eng 137(2):020904; 2017, where K = 9.3e9 N/m³
/// stands for polyethylene.
struct LinearVolumeLaw {
  double modulus = 9.3e9;  ///< K, the pressure modulus [N/m³]
};

/// W and its first two derivatives at one depth.
struct LawValue {
  double energy = 0.0;         ///< W(d) [J/m²]
  double pressure = 0.0;       ///< p = W′(d) [Pa]
  double pressure_rate = 0.0;  ///< W″(d) [Pa/m]
};

/// Name and parameters, for metadata and reports. A parameter's name carries its unit.
struct LawDescription {
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;
};

/// Any of the laws, as a small value.
class ContactLaw {
 public:
  using Variant = std::variant<LinearVolumeLaw>;

  /// @throws std::invalid_argument naming a parameter that is out of range (modulus: finite and >
  /// 0).
  ContactLaw(const Variant& law = LinearVolumeLaw{});  // NOLINT: a law converts to "any law"

  /// W, p and p′ at a depth; all zero at d <= 0 (where p′ is the value from the side of no
  /// contact).
  LawValue at(double depth) const {
    if (!(depth > 0.0)) return {};
    return std::visit([depth](const auto& law) { return value(law, depth); }, law_);
  }

  LawDescription describe() const;

  /// The law itself, for kernels that have a version for each law.
  const Variant& variant() const { return law_; }

 private:
  static LawValue value(const LinearVolumeLaw& law, double d) {
    return {0.5 * law.modulus * d * d, law.modulus * d, law.modulus};
  }

  Variant law_;
};

}  // namespace condyle::contact
