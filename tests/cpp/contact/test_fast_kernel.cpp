// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "condyle/contact/fast_dispatch.hpp"
#include "condyle/contact/fast_faces.hpp"
#include "condyle/contact/fast_kernel.hpp"
#include "contact/fast_fixture.hpp"

namespace condyle::contact {
namespace {

// W = c d³/3, so that p = c d² and p′ = 2 c d.
void square_law(const void* law, int, const double* d, int n, double* energy, double* pressure,
                double* rate) {
  const double c = *static_cast<const double*>(law);
  for (int i = 0; i < n; ++i) {
    energy[i] = c * d[i] * d[i] * d[i] / 3.0;
    pressure[i] = c * d[i] * d[i];
    rate[i] = 2.0 * c * d[i];
  }
}

TEST_CASE("[oracle] a kernel takes any law, a group of depths at a time") {
  const test::TorusPair pair;
  const SurfaceFaces& compartment = pair.compartments[kMedial];
  const fast::SortedFaces faces(compartment);
  const RigidTransform X_FT = transform_TF(pair.pose).inverse();
  fast::PlacementView placement;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) placement.R[3 * a + b] = X_FT.R(a, b);
    placement.p[a] = X_FT.p[a];
  }
  const double c = 6.6e12;  // [N/m⁴]
  double energy = 0.0, pressure_sum = 0.0, peak = 0.0;
  Vector3 force = Vector3::Zero();
  Matrix3 S = Matrix3::Zero();
  for (Eigen::Index f = 0; f < compartment.count(); ++f) {
    const auto at = pair.field->evaluate(X_FT * Vector3(compartment.centroids.row(f)));
    if (!(at.value < 0.0)) continue;
    const double d = -at.value, A = compartment.areas[f];
    energy += A * c * d * d * d / 3.0;
    pressure_sum += A * c * d * d;
    peak = std::max(peak, c * d * d);
    force -= A * c * d * d * at.gradient;
    S += A * c * (d * d * at.hessian - 2.0 * d * at.gradient * at.gradient.transpose());
  }
  for (const InstructionSet set :
       {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (set > best_instruction_set()) continue;
    fast::Sums sums;
    fast::kernel_for(set)(fast::field_view(*pair.field), faces.faces(), faces.clusters(),
                          fast::LawView{0.0, &c, &square_law}, placement, true, sums);
    // Single precision in the kernel's field.
    CHECK(std::abs(sums.energy - energy) < 2e-6 * energy);
    CHECK(std::abs(sums.pressure_sum - pressure_sum) < 2e-6 * pressure_sum);
    CHECK(std::abs(sums.peak_pressure - peak) < 2e-6 * peak);
    CHECK((Vector3(sums.force[0], sums.force[1], sums.force[2]) - force).norm() <
          2e-6 * force.norm());
    CHECK(std::abs(sums.S[0] - S(0, 0)) < 2e-6 * S.norm());
    CHECK(std::abs(sums.S[5] - S(1, 2)) < 2e-6 * S.norm());
  }
}

}  // namespace
}  // namespace condyle::contact
