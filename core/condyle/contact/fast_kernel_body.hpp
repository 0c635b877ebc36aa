// SPDX-License-Identifier: Apache-2.0
// The fast contact's kernel, written once and compiled once for each instruction set:
// fast_kernel_<set>.cpp defines CONDYLE_FAST_KERNEL, the function's name, and includes this file.
// Everything is static: nothing of it may be shared between those compilations.
//
// Per pose: balls of faces are culled by the field at their centres, parents before leaves. A leaf
// whose centre is inside is expected to be loaded; of the others φ alone is evaluated first, to
// drop the groups of four faces that are not. What remains gets φ, ∇φ, ∇²φ, the law, and the sums.
// All of it in batches, in an order that depends on the pose only.
#include "condyle/contact/fast_field.hpp"
#include "condyle/contact/fast_kernel.hpp"
#include "condyle/contact/fast_vector.hpp"

namespace condyle::contact::fast {
namespace {

// |∇s| of the spline exceeds 1 a little where it rounds a crease; a ball is culled only beyond
// doubt.
constexpr double kLipschitz = 1.1;
constexpr double kSlack = 1e-5;  // [m]

struct Accumulators {
  v4 energy, volume, area, pressure_sum, pressure_moment[3], max_depth, peak_pressure, max_facing;
  v4 force[3], dyad[9], S[6], Sq[9], qSq[6];
  double border_area;
};

struct Placement4 {
  v4 R[9], p[3];
};

// Everything a pose needs; on the stack.
struct Work {
  Points points;
  FieldBatch field;
  std::int32_t leaves[kBatch * kParentLeaves];
  std::int32_t unsure[kBatch * kLeafFaces / kGroup];  // first faces of groups to evaluate φ at
  std::int32_t groups[kBatch * kLeafFaces / kGroup];  // first faces of groups to evaluate in full
};

// Points n … n + 3 of a batch from their positions in T.
CONDYLE_INLINE void place(const Placement4& X_FT, const v4 c[3], int n, Points& points) {
  for (int a = 0; a < 3; ++a) {
    const v4* R = X_FT.R + 3 * a;
    store(points.q[a] + n, fma(R[0], c[0], fma(R[1], c[1], fma(R[2], c[2], X_FT.p[a]))));
  }
}

CONDYLE_INLINE int padded(int count) { return (count + kGroup - 1) / kGroup * kGroup; }

// Places, locates and evaluates φ at the centres of balls `first` + index[i] (index null: i
// itself). Ball i may touch the body where may[i] < 0; its centre is inside where
// work.field.value[i] < 0.
static void test_balls(const FieldView& field, const Placement4& X_FT, const Cluster* balls,
                       const std::int32_t* index, int count, Work& work, double* may) {
  Points& points = work.points;
  double* phi = work.field.value;
  v4 reach[kBatch / kGroup];
  for (int n = 0; n < count; n += kGroup) {
    const Cluster* b[kGroup];
    for (int l = 0; l < kGroup; ++l) {
      const int i = n + l < count ? n + l : count - 1;
      b[l] = balls + (index != nullptr ? index[i] : i);
    }
    v4 c[3];
    for (int a = 0; a < 3; ++a) {
      c[a] = make(b[0]->centre[a], b[1]->centre[a], b[2]->centre[a], b[3]->centre[a]);
    }
    place(X_FT, c, n, points);
    reach[n / kGroup] = fma(make(b[0]->radius, b[1]->radius, b[2]->radius, b[3]->radius),
                            splat(kLipschitz), splat(kSlack));
  }
  locate(field, padded(count), points);
  values(field, points, padded(count), phi);
  for (int n = 0; n < count; n += kGroup) {
    store(may + n, load(phi + n) - reach[n / kGroup]);
    if (points.inside[n / kGroup] == 15) continue;
    for (int l = 0; l < kGroup; ++l) {  // a ball about a point beyond the grid may reach into it
      if (points.inside[n / kGroup] >> l & 1) continue;
      double beyond = 0.0, r[4];  // in spacings
      for (int a = 0; a < 3; ++a) {
        const double u = points.q[a][n + l] * field.inverse_spacing + field.offset[a];
        beyond = 1.0 - u > beyond ? 1.0 - u : beyond;
        beyond = u - field.last[a] > beyond ? u - field.last[a] : beyond;
      }
      store(r, reach[n / kGroup]);
      may[n + l] = beyond - r[l] * field.inverse_spacing;
      phi[n + l] = 1.0;
    }
  }
}

// Faces of up to kBatch/kGroup groups.
CONDYLE_INLINE void place_groups(const FacesView& faces, const Placement4& X_FT,
                                 const std::int32_t* groups, int count, Points& points) {
  for (int g = 0; g < count; ++g) {
    const int f = groups[g];
    const v4 c[3] = {load(faces.x + f), load(faces.y + f), load(faces.z + f)};
    place(X_FT, c, g * kGroup, points);
  }
}

// Adds the terms of S = A(pH − p′ggᵀ) at the four points from n on.
CONDYLE_INLINE void add_stiffness(const FieldBatch& f, int n, const v4 q[3], const v4 g[3], v4 Ap,
                                  v4 Ar, Accumulators& s) {
  const v4 gx = Ar * g[0], gy = Ar * g[1], gz = Ar * g[2];
  const v4 xx = fms(Ap, load(f.hessian[0] + n), gx * g[0]);
  const v4 yy = fms(Ap, load(f.hessian[1] + n), gy * g[1]);
  const v4 zz = fms(Ap, load(f.hessian[2] + n), gz * g[2]);
  const v4 xy = fms(Ap, load(f.hessian[3] + n), gx * g[1]);
  const v4 xz = fms(Ap, load(f.hessian[4] + n), gx * g[2]);
  const v4 yz = fms(Ap, load(f.hessian[5] + n), gy * g[2]);
  const v4 unique[6] = {xx, yy, zz, xy, xz, yz};
  for (int i = 0; i < 6; ++i) s.S[i] = s.S[i] + unique[i];
  // Row i of S[q] is s_i × q; column j of [q]ᵀS[q] is p_j × q with p_j column j of S[q].
  const v4 row[3][3] = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
  v4 P[3][3];
  for (int i = 0; i < 3; ++i) {
    P[i][0] = fms(row[i][1], q[2], row[i][2] * q[1]);
    P[i][1] = fms(row[i][2], q[0], row[i][0] * q[2]);
    P[i][2] = fms(row[i][0], q[1], row[i][1] * q[0]);
    for (int j = 0; j < 3; ++j) s.Sq[3 * i + j] = s.Sq[3 * i + j] + P[i][j];
  }
  s.qSq[0] = s.qSq[0] + fms(P[1][0], q[2], P[2][0] * q[1]);
  s.qSq[1] = s.qSq[1] + fms(P[2][1], q[0], P[0][1] * q[2]);
  s.qSq[2] = s.qSq[2] + fms(P[0][2], q[1], P[1][2] * q[0]);
  s.qSq[3] = s.qSq[3] + fms(P[1][1], q[2], P[2][1] * q[1]);
  s.qSq[4] = s.qSq[4] + fms(P[1][2], q[2], P[2][2] * q[1]);
  s.qSq[5] = s.qSq[5] + fms(P[2][2], q[0], P[0][2] * q[2]);
}

// Adds the faces from `f` on, the points from n on. Lanes that are not loaded have area and depth
// 0.
template <bool kStiffness>
CONDYLE_INLINE void add_faces(const Work& work, int n, v4 depth, v4 area,
                              const double* const n_T[3], const LawView& law,
                              const Placement4& X_FT, Accumulators& s) {
  v4 pressure = splat(law.modulus) * depth, energy = splat(0.5) * pressure * depth;
  v4 rate = splat(law.modulus);
  if (law.batch != nullptr) {
    double d[4], w[4], p[4], r[4];
    store(d, depth);
    law.batch(law.law, d, 4, w, p, r);
    energy = load(w), pressure = load(p), rate = load(r);
  }
  const v4 Ap = area * pressure;
  s.energy = fma(area, energy, s.energy);
  s.volume = fma(area, depth, s.volume);
  s.area = s.area + area;
  s.pressure_sum = s.pressure_sum + Ap;
  s.max_depth = larger(depth, s.max_depth);
  s.peak_pressure = larger(pressure, s.peak_pressure);
  v4 g[3], q[3], force[3], facing = splat(0.0);
  for (int a = 0; a < 3; ++a) {
    g[a] = load(work.field.gradient[a] + n);
    q[a] = load(work.points.q[a] + n);
    s.pressure_moment[a] = fma(Ap, q[a], s.pressure_moment[a]);
    force[a] = splat(0.0) - Ap * g[a];
    s.force[a] = s.force[a] + force[a];
  }
  for (int a = 0; a < 3; ++a) {  // n·g with both in T: g_T = R_FTᵀ g
    const v4 g_T = fma(X_FT.R[a], g[0], fma(X_FT.R[3 + a], g[1], X_FT.R[6 + a] * g[2]));
    facing = fma(load(n_T[a]), g_T, facing);
    for (int b = 0; b < 3; ++b) s.dyad[3 * a + b] = fma(force[a], q[b], s.dyad[3 * a + b]);
  }
  s.max_facing = larger(facing, s.max_facing);
  if constexpr (kStiffness) add_stiffness(work.field, n, q, g, Ap, area * rate, s);
}

// Adds the group from face f on, the points from n on, of which only the `counting` lanes count.
template <bool kStiffness>
static void add_partly(const FacesView& faces, int f, const LawView& law, const Placement4& X_FT,
                       const Work& work, int n, int counting, Accumulators& sums) {
  double area[4], depth[4], normal[3][4];
  const double* const from[3] = {faces.nx + f, faces.ny + f, faces.nz + f};
  for (int l = 0; l < kGroup; ++l) {
    const bool counts = (counting >> l & 1) != 0;
    area[l] = counts ? faces.area[f + l] : 0.0;
    depth[l] = counts ? -work.field.value[n + l] : 0.0;
    for (int a = 0; a < 3; ++a) normal[a][l] = counts ? from[a][l] : 0.0;
  }
  const double* const n_T[3] = {normal[0], normal[1], normal[2]};
  add_faces<kStiffness>(work, n, load(depth), load(area), n_T, law, X_FT, sums);
}

// Evaluates up to kBatch/kGroup groups in full and adds what is loaded.
template <bool kStiffness>
static void add_groups(const FieldView& field, const FacesView& faces, const LawView& law,
                       const Placement4& X_FT, const std::int32_t* groups, int count, Work& work,
                       Accumulators& sums) {
  place_groups(faces, X_FT, groups, count, work.points);
  locate(field, count * kGroup, work.points);
  derivatives<kStiffness>(field, work.points, count * kGroup, work.field);
  for (int g = 0; g < count; ++g) {
    const int f = groups[g], n = g * kGroup;
    const v4 phi = load(work.field.value + n);
    const int loaded = negative_lanes(phi) & work.points.inside[g];
    if (loaded == 0) continue;
    const int border = border_lanes(field, work.points, n, loaded);
    if (loaded == 15 && border == 0) {
      const double* const n_T[3] = {faces.nx + f, faces.ny + f, faces.nz + f};
      add_faces<kStiffness>(work, n, splat(0.0) - phi, load(faces.area + f), n_T, law, X_FT, sums);
      continue;
    }
    for (int l = 0; l < kGroup; ++l) {
      if (border >> l & 1) sums.border_area += faces.area[f + l];
    }
    add_partly<kStiffness>(faces, f, law, X_FT, work, n, loaded & ~border, sums);
  }
}

// Tests a batch of leaves and adds what is loaded of them.
template <bool kStiffness>
static void add_leaves(const FieldView& field, const FacesView& faces, const ClustersView& clusters,
                       const LawView& law, const Placement4& X_FT, const std::int32_t* leaves,
                       int count, Work& work, Accumulators& sums) {
  constexpr int kMost = kBatch / kGroup;
  double may[kBatch];
  test_balls(field, X_FT, clusters.leaves, leaves, count, work, may);
  int unsure = 0, groups = 0;
  for (int i = 0; i < count; ++i) {
    if (!(may[i] < 0.0)) continue;
    const int begin = leaves[i] * kLeafFaces;
    const int end =
        begin + kLeafFaces < clusters.face_count ? begin + kLeafFaces : clusters.face_count;
    const bool expected = work.field.value[i] < 0.0;
    for (int f = begin; f < end; f += kGroup) {
      if (expected) {
        work.groups[groups++] = f;
      } else {
        work.unsure[unsure++] = f;
      }
    }
  }
  for (int u = 0; u < unsure; u += kMost) {
    const int most = unsure - u < kMost ? unsure - u : kMost;
    place_groups(faces, X_FT, work.unsure + u, most, work.points);
    locate(field, most * kGroup, work.points);
    values(field, work.points, most * kGroup, work.field.value);
    for (int g = 0; g < most; ++g) {
      const int loaded =
          negative_lanes(load(work.field.value + g * kGroup)) & work.points.inside[g];
      if (loaded != 0) work.groups[groups++] = work.unsure[u + g];
    }
  }
  for (int g = 0; g < groups; g += kMost) {
    add_groups<kStiffness>(field, faces, law, X_FT, work.groups + g,
                           groups - g < kMost ? groups - g : kMost, work, sums);
  }
}

template <bool kStiffness>
static void run(const FieldView& field, const FacesView& faces, const ClustersView& clusters,
                const LawView& law, const Placement4& X_FT, Accumulators& sums) {
  Work work;
  for (int p = 0; p < clusters.parent_count; p += kBatch) {
    const int parents = clusters.parent_count - p < kBatch ? clusters.parent_count - p : kBatch;
    double may[kBatch];
    test_balls(field, X_FT, clusters.parents + p, nullptr, parents, work, may);
    int leaves = 0;
    for (int i = 0; i < parents; ++i) {
      if (!(may[i] < 0.0)) continue;
      const int begin = (p + i) * kParentLeaves;
      for (int l = begin; l < begin + kParentLeaves && l < clusters.leaf_count; ++l) {
        work.leaves[leaves++] = l;
      }
    }
    for (int l = 0; l < leaves; l += kBatch) {
      add_leaves<kStiffness>(field, faces, clusters, law, X_FT, work.leaves + l,
                             leaves - l < kBatch ? leaves - l : kBatch, work, sums);
    }
  }
}

CONDYLE_INLINE void reduce(const v4* from, int count, double* to) {
  for (int i = 0; i < count; ++i) to[i] = lane_sum(from[i]);
}

}  // namespace

void CONDYLE_FAST_KERNEL(const FieldView& field, const FacesView& faces,
                         const ClustersView& clusters, const LawView& law,
                         const PlacementView& X_FT, bool stiffness, Sums& sums) {
  Accumulators s;
  std::memset(&s, 0, sizeof s);
  s.max_facing = splat(-1.0);
  Placement4 placement;
  for (int i = 0; i < 9; ++i) placement.R[i] = splat(X_FT.R[i]);
  for (int i = 0; i < 3; ++i) placement.p[i] = splat(X_FT.p[i]);
  if (stiffness) {
    run<true>(field, faces, clusters, law, placement, s);
  } else {
    run<false>(field, faces, clusters, law, placement, s);
  }
  sums.energy = lane_sum(s.energy);
  sums.volume = lane_sum(s.volume);
  sums.area = lane_sum(s.area);
  sums.border_area = s.border_area;
  sums.pressure_sum = lane_sum(s.pressure_sum);
  sums.max_depth = lane_maximum(s.max_depth);
  sums.peak_pressure = lane_maximum(s.peak_pressure);
  sums.max_facing = lane_maximum(s.max_facing);
  reduce(s.pressure_moment, 3, sums.pressure_moment);
  reduce(s.force, 3, sums.force);
  reduce(s.dyad, 9, sums.dyad);
  reduce(s.S, 6, sums.S);
  reduce(s.Sq, 9, sums.Sq);
  reduce(s.qSq, 6, sums.qSq);
}

}  // namespace condyle::contact::fast
