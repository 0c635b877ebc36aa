// SPDX-License-Identifier: Apache-2.0
#include "condyle/contact/contact_pair.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "condyle/contact/fast_integral.hpp"
#include "condyle/geometry/distance_field_cache.hpp"

namespace condyle::contact {
namespace {

using geometry::TriangleMesh;

// A surface's faces with their layers. @param what names the surface in errors.
SurfaceFaces faces_of(const TriangleMesh& mesh, const std::vector<Layer>& layers,
                      const ContactLaw& law, const std::string& what) {
  SurfaceFaces faces = surface_faces(mesh);
  if (layers.empty()) return faces;
  const auto refuse = [&](const std::string& text) {
    throw std::invalid_argument("layers of " + what + ": " + text);
  };
  if (!law.has_layer()) refuse("the law " + law.describe().name + " has no elastic layer");
  if (layers.size() != static_cast<std::size_t>(faces.count())) {
    refuse(std::to_string(layers.size()) + " for " + std::to_string(faces.count()) +
           " faces: must be one a face");
  }
  for (std::size_t f = 0; f < layers.size(); ++f) {
    const auto require = [&](double value, const char* name, const char* unit) {
      if (std::isfinite(value) && value > 0.0) return;
      refuse("face " + std::to_string(f) + ": " + name + " is " + std::to_string(value) + " " +
             unit + ": must be finite and above 0");
    };
    require(layers[f].modulus, "modulus", "Pa");
    require(layers[f].thickness, "thickness", "m");
  }
  faces.layers = layers;
  return faces;
}

// The distance of one body, in the way the settings ask for; integrals of several surfaces share it.
class BodyDistance {
 public:
  BodyDistance(const TriangleMesh& mesh, const PairSettings& settings) {
    if (settings.evaluation == Evaluation::kExact) {
      exact_ = std::make_shared<const geometry::SignedDistance>(mesh);
    } else {
      fast_ = geometry::load_or_build_distance_field(mesh, settings.field, settings.cache_directory,
                                                     settings.threads)
                  .field;
    }
  }

  std::unique_ptr<const SurfaceIntegral> integral(SurfaceFaces faces, const ContactLaw& law) const {
    if (exact_) return make_exact_integral(exact_, std::move(faces), law);
    return make_fast_integral(fast_, std::move(faces), law);
  }

 private:
  std::shared_ptr<const geometry::SignedDistance> exact_;
  std::shared_ptr<const geometry::DistanceField> fast_;
};

}  // namespace

Evaluation evaluation_from_name(std::string_view text) {
  if (text == "exact") return Evaluation::kExact;
  if (text == "fast") return Evaluation::kFast;
  throw std::invalid_argument("evaluation is '" + std::string(text) +
                              "': must be 'exact' or 'fast'");
}

std::string_view name(Evaluation evaluation) {
  return evaluation == Evaluation::kExact ? "exact" : "fast";
}

Integration integration_from_name(std::string_view text) {
  if (text == "fixed" || text == "insert") return Integration::kFixed;
  if (text == "moving" || text == "femur") return Integration::kMoving;
  if (text == "both") return Integration::kBoth;
  throw std::invalid_argument("integration is '" + std::string(text) +
                              "': must be 'fixed' (of a knee: 'insert'), 'moving' ('femur') or "
                              "'both'");
}

std::string_view name(Integration integration) {
  switch (integration) {
    case Integration::kFixed:
      return "fixed";
    case Integration::kMoving:
      return "moving";
    case Integration::kBoth:
      break;
  }
  return "both";
}

ContactPair::ContactPair(std::vector<Compartment> compartments)
    : compartments_(std::move(compartments)) {
  if (compartments_.empty()) {
    throw std::invalid_argument("contact pair: no compartment: must have at least one");
  }
  for (const Compartment& compartment : compartments_) {
    if (!compartment.over_fixed && !compartment.over_moving) {
      throw std::invalid_argument("contact pair: a compartment without an integral");
    }
  }
}

CompartmentLoads ContactPair::evaluate(const Pose& pose, std::size_t compartment,
                                       Derivatives derivatives) const {
  const auto& [over_fixed, over_moving] = compartments_[compartment];
  const RigidTransform X_TF = transform_TF(pose);
  const bool stiffness = derivatives == Derivatives::kStiffness;
  const auto of_fixed = [&] {
    return loads_of_moving_distance(over_fixed->sums(X_TF.inverse(), derivatives), pose, stiffness);
  };
  const auto of_moving = [&] {
    return loads_of_fixed_distance(over_moving->sums(X_TF, derivatives), pose, stiffness);
  };
  if (!over_moving) return of_fixed();
  if (!over_fixed) return of_moving();
  return mean(of_fixed(), of_moving());
}

FacePressure ContactPair::face_pressure(const Pose& pose, std::size_t compartment) const {
  const auto& [over_fixed, over_moving] = compartments_[compartment];
  const RigidTransform X_TF = transform_TF(pose);
  return over_fixed ? over_fixed->face_pressure(X_TF.inverse()) : over_moving->face_pressure(X_TF);
}

ContactPair make_contact_pair(const TriangleMesh& moving, const std::vector<TriangleMesh>& fixed,
                              const ContactLaw& law, const PairSettings& settings,
                              const PairLayers& layers) {
  geometry::require_well_formed(moving, "moving surface");
  if (!layers.fixed.empty() && layers.fixed.size() != fixed.size()) {
    throw std::invalid_argument("layers: " + std::to_string(layers.fixed.size()) + " lists for " +
                                std::to_string(fixed.size()) +
                                " compartments: must be one a compartment");
  }
  std::vector<SurfaceFaces> fixed_faces;
  for (std::size_t c = 0; c < fixed.size(); ++c) {
    const std::string what = "compartment " + std::to_string(c);
    geometry::require_well_formed(fixed[c], what.c_str());
    fixed_faces.push_back(faces_of(
        fixed[c], layers.fixed.empty() ? std::vector<Layer>{} : layers.fixed[c], law, what));
  }
  const SurfaceFaces moving_faces = faces_of(moving, layers.moving, law, "moving surface");

  std::vector<ContactPair::Compartment> compartments(fixed.size());
  if (settings.integration != Integration::kMoving) {
    const BodyDistance distance(moving, settings);
    for (std::size_t c = 0; c < fixed.size(); ++c) {
      compartments[c].over_fixed = distance.integral(std::move(fixed_faces[c]), law);
    }
  }
  if (settings.integration != Integration::kFixed) {
    for (std::size_t c = 0; c < fixed.size(); ++c) {
      compartments[c].over_moving = BodyDistance(fixed[c], settings).integral(moving_faces, law);
    }
  }
  return ContactPair(std::move(compartments));
}

}  // namespace condyle::contact
