// SPDX-License-Identifier: Apache-2.0
// The hot loop of the fast contact: plain arrays in, sums out, so that each instruction set can
// have its own compilation.
//
// In the femoral frame the arm of a centroid about Fo is its own position q, so with f = −A p g and
// S = A (p H − p′ g gᵀ) (g = ∇φ, H = ∇²φ; p, p′ pressure and its rate at d = −φ) the twist
// derivative of the wrench is
//
//   ∂F/∂v = ΣS,   ∂F/∂ω = −ΣS[q] − [Σf],   ∂M/∂v = −(ΣS[q])ᵀ + [Σf],   ∂M/∂ω = Σ[q]ᵀS[q] − Σ(f qᵀ −
// (q·f) I),
//
// and the kernel needs to sum only S, S[q], [q]ᵀS[q] (symmetric), f and f qᵀ. M = Σ q×f is in the
// last one.
//
// No Eigen and no standard containers here or in the kernels: an inline function compiled for
// AVX-512 must not become the copy that the linker keeps for everybody.
#pragma once

#include <cstddef>
#include <cstdint>

namespace condyle::contact::fast {

/// Faces are treated in groups of as many as an instruction set has lanes: four or eight. A leaf is
/// the smallest run that is culled as a whole, a parent a run of leaves. Sizes chosen by measurement
/// (tests/benchmarks): smaller leaves cull tighter but test more balls.
inline constexpr int kLargestGroup = 8;
inline constexpr int kLeafFaces = 16;
inline constexpr int kParentLeaves = 8;

/// The field's spline (geometry::CubicSplineGrid) and border flags.
struct FieldView {
  const float* coefficients;
  const std::uint8_t* border_nodes;
  const std::uint8_t* border_cells;
  std::int64_t row, plane;  ///< strides along y and z; x is contiguous
  double inverse_spacing;   ///< [1/m]
  double offset[3];         ///< u = q·inverse_spacing + offset, in nodes
  double last[3];           ///< a point is in the grid where 1 <= u <= last
  float near;  ///< a coefficient at least this large has no point of φ < 0 nearest to its node [m]
};

/// Sorted faces, structure of arrays; padding faces have no area.
struct FacesView {
  const double *x, *y, *z;     ///< centroids in T [m]
  const double *nx, *ny, *nz;  ///< unit normals in T
  const double* area;          ///< [m²]
};

/// A run of faces within a ball.
struct Cluster {
  double centre[3];  ///< in T [m]
  double radius;     ///< [m]
};

/// Two levels of clusters: leaf i holds the faces from i·kLeafFaces on, parent i the leaves from
/// i·kParentLeaves on.
struct ClustersView {
  const Cluster *parents, *leaves;
  std::int32_t parent_count, leaf_count, face_count;  ///< face_count a multiple of kLargestGroup
};

/// Pressure law in a kernel: linear (p = K d) if `batch` is null, else whatever `batch` computes
/// for the n faces from first_face on.
struct LawView {
  double modulus;
  const void* law;
  void (*batch)(const void* law, int first_face, const double* depth, int n, double* energy,
                double* pressure, double* rate);
};

/// Placement of T in F: q = R_FT c + p_FTo.
struct PlacementView {
  double R[9];  ///< R_FT, row by row
  double p[3];  ///< To in F [m]
};

/// Everything summed over the loaded faces, components in F.
struct Sums {
  double energy, volume, area, border_area, pressure_sum;
  double pressure_moment[3];  ///< Σ A p q
  double max_depth, peak_pressure;
  double max_facing;  ///< largest n·g of a loaded face, or 0 or −1 where that is larger
  double force[3];    ///< Σ f
  double dyad[9];     ///< Σ f qᵀ, row by row
  double S[6];        ///< xx, yy, zz, xy, xz, yz
  double Sq[9];       ///< ΣS[q], row by row
  double qSq[6];      ///< Σ[q]ᵀS[q], as S
};

/// One side at one pose. `sums` is overwritten. S, Sq and qSq are zero unless `stiffness`.
using Kernel = void (*)(const FieldView&, const FacesView&, const ClustersView&, const LawView&,
                        const PlacementView&, bool stiffness, Sums& sums);

void kernel_baseline(const FieldView&, const FacesView&, const ClustersView&, const LawView&,
                     const PlacementView&, bool stiffness, Sums& sums);
void kernel_avx2(const FieldView&, const FacesView&, const ClustersView&, const LawView&,
                 const PlacementView&, bool stiffness, Sums& sums);
void kernel_avx512(const FieldView&, const FacesView&, const ClustersView&, const LawView&,
                   const PlacementView&, bool stiffness, Sums& sums);

}  // namespace condyle::contact::fast
