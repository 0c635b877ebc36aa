// SPDX-License-Identifier: Apache-2.0
// A thin elastic layer bonded to a rigid body: what its material and thickness make of a depth.
//
// A layer much thinner than the contact is wide cannot bulge sideways: it is in uniaxial strain,
// and its stress is the strain times the confined (aggregate) modulus
//     M = (1 − ν) E / ((1 + ν)(1 − 2ν)).
// Under a depth d much less than the thickness h the pressure is p = M d/h, so a pressure modulus
// K = p/d and a layer are convertible: K = M/h.
//
// The usual K = 9.3e9 N/m³ (Marra et al. 2015) was fitted for forces and kinematics, not for
// pressures: with ν = 0.46 (M = 4.62 E) it means E = 10 MPa in a layer of 5 mm and 20 MPa in one of
// 10 mm, where polyethylene has some 463–1000 MPa. Contact areas come out too large and pressures
// too low; name a law of the real layer where pressures matter.
//
// Sources: Bei & Fregly 2004, Med Eng Phys 26:777–789; Blankevoort et al. 1991, J Biomech
// 24:1019–1031.
#pragma once

namespace condyle::contact {

/// Isotropic layer bonded to a rigid body; there is no default material.
struct ElasticLayer {
  double youngs_modulus = 0.0;  ///< E [Pa], > 0
  double poissons_ratio = 0.0;  ///< ν, −1 < ν < 0.5
  double thickness = 0.0;       ///< h [m], > 0
};

/// A layer as the thin-layer laws see it, one face's for instance.
/// @pre both finite and > 0: evaluation does not check (layer_of gives such a one).
struct Layer {
  double modulus = 0.0;    ///< M, confined modulus [Pa]
  double thickness = 0.0;  ///< h [m]
};

/// M and h of a layer.
/// @throws std::invalid_argument naming the parameter, its value and its limits.
Layer layer_of(const ElasticLayer& layer);

/// K = M/h [N/m³] of a layer.
/// @throws std::invalid_argument as layer_of.
double pressure_modulus(const ElasticLayer& layer);

/// E [Pa] of the layer that has the pressure modulus K: the inverse of pressure_modulus.
/// @param modulus K [N/m³], > 0. @param poissons_ratio ν. @param thickness h [m].
/// @throws std::invalid_argument naming the parameter, its value and its limits.
double youngs_modulus(double modulus, double poissons_ratio, double thickness);

}  // namespace condyle::contact
