// SPDX-License-Identifier: Apache-2.0
// The fast contact's kernel, written once and compiled once for each instruction set:
// fast_kernel_<set>.cpp defines CONDYLE_FAST_KERNEL, the function's name, and includes this file.
// Everything is static: nothing of it may be shared between those compilations.
//
// Per pose: balls of faces are culled by the field at their centres, parents before leaves. A leaf
// whose centre is inside is expected to be loaded; of the others φ alone is evaluated first, to
// drop the groups of faces that are not. What remains gets φ, ∇φ, ∇²φ, the law, and the sums.
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
  vd energy, volume, area, pressure_sum, pressure_moment[3], max_depth, peak_pressure, max_facing;
  vd force[3], dyad[9], S[6], Sq[9], qSq[6];
  double border_area;
};

struct Placements {
  vd R[9], p[3];
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
CONDYLE_INLINE void place(const Placements& X_FT, const vd c[3], int n, Points& points) {
  for (int a = 0; a < 3; ++a) {
    const vd* R = X_FT.R + 3 * a;
    // Not fused: a point is in the same place with every instruction set.
    store(points.q[a] + n, R[0] * c[0] + R[1] * c[1] + R[2] * c[2] + X_FT.p[a]);
  }
}

CONDYLE_INLINE int padded(int count) { return (count + kGroup - 1) / kGroup * kGroup; }

// Places, locates and evaluates φ at the centres of balls `first` + index[i] (index null: i
// itself). Ball i may touch the body where may[i] < 0; its centre is inside where
// work.field.value[i] < 0.
static void test_balls(const FieldView& field, const Placements& X_FT, const Cluster* balls,
                       const std::int32_t* index, int count, Work& work, double* may) {
  Points& points = work.points;
  double* phi = work.field.value;
  vd reach[kBatch / kGroup];
  for (int n = 0; n < count; n += kGroup) {
    double centre[3][kGroup], radius[kGroup];
    for (int l = 0; l < kGroup; ++l) {
      const int i = n + l < count ? n + l : count - 1;
      const Cluster& ball = balls[index != nullptr ? index[i] : i];
      for (int a = 0; a < 3; ++a) centre[a][l] = ball.centre[a];
      radius[l] = ball.radius;
    }
    const vd c[3] = {load(centre[0]), load(centre[1]), load(centre[2])};
    place(X_FT, c, n, points);
    reach[n / kGroup] = fma(load(radius), splat(kLipschitz), splat(kSlack));
  }
  locate(field, padded(count), points);
  values(field, points, padded(count), phi);
  for (int n = 0; n < count; n += kGroup) {
    store(may + n, load(phi + n) - reach[n / kGroup]);
    if (points.inside[n / kGroup] == kAllLanes) continue;
    for (int l = 0; l < kGroup; ++l) {  // a ball about a point beyond the grid may reach into it
      if (points.inside[n / kGroup] >> l & 1) continue;
      double beyond = 0.0, r[kGroup];  // in spacings
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
CONDYLE_INLINE void place_groups(const FacesView& faces, const Placements& X_FT,
                                 const std::int32_t* groups, int count, Points& points) {
  for (int g = 0; g < count; ++g) {
    const int f = groups[g];
    const vd c[3] = {load(faces.x + f), load(faces.y + f), load(faces.z + f)};
    place(X_FT, c, g * kGroup, points);
  }
}

// Adds the terms of S = A(pH − p′ggᵀ) at the group of points from n on.
CONDYLE_INLINE void add_stiffness(const FieldBatch& f, int n, const vd q[3], const vd g[3], vd Ap,
                                  vd Ar, Accumulators& s) {
  const vd gx = Ar * g[0], gy = Ar * g[1], gz = Ar * g[2];
  const vd xx = fms(Ap, load(f.hessian[0] + n), gx * g[0]);
  const vd yy = fms(Ap, load(f.hessian[1] + n), gy * g[1]);
  const vd zz = fms(Ap, load(f.hessian[2] + n), gz * g[2]);
  const vd xy = fms(Ap, load(f.hessian[3] + n), gx * g[1]);
  const vd xz = fms(Ap, load(f.hessian[4] + n), gx * g[2]);
  const vd yz = fms(Ap, load(f.hessian[5] + n), gy * g[2]);
  const vd unique[6] = {xx, yy, zz, xy, xz, yz};
  for (int i = 0; i < 6; ++i) s.S[i] = s.S[i] + unique[i];
  // Row i of S[q] is s_i × q; column j of [q]ᵀS[q] is p_j × q with p_j column j of S[q].
  const vd row[3][3] = {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
  vd P[3][3];
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

// Adds the group of faces from f on, the points from n on, of which the `counting` lanes count.
template <bool kStiffness>
CONDYLE_INLINE void add_faces(const FacesView& faces, int f, const Work& work, int n, int counting,
                              const LawView& law, const Placements& X_FT, Accumulators& s) {
  const vd depth = chosen(counting, splat(0.0) - load(work.field.value + n));
  const vd area = chosen(counting, load(faces.area + f));
  vd pressure = splat(law.modulus) * depth, energy = splat(0.5) * pressure * depth;
  vd rate = splat(law.modulus);
  if (law.batch != nullptr) {
    double d[kGroup], w[kGroup], p[kGroup], r[kGroup];
    store(d, depth);
    law.batch(law.law, f, d, kGroup, w, p, r);
    energy = load(w), pressure = load(p), rate = load(r);
  }
  const vd Ap = area * pressure;
  s.energy = fma(area, energy, s.energy);
  s.volume = fma(area, depth, s.volume);
  s.area = s.area + area;
  s.pressure_sum = s.pressure_sum + Ap;
  s.max_depth = larger(depth, s.max_depth);
  s.peak_pressure = larger(pressure, s.peak_pressure);
  vd g[3], q[3], force[3], facing = splat(0.0);
  for (int a = 0; a < 3; ++a) {
    g[a] = load(work.field.gradient[a] + n);
    q[a] = load(work.points.q[a] + n);
    s.pressure_moment[a] = fma(Ap, q[a], s.pressure_moment[a]);
    force[a] = splat(0.0) - Ap * g[a];
    s.force[a] = s.force[a] + force[a];
  }
  const double* const normal[3] = {faces.nx + f, faces.ny + f, faces.nz + f};
  for (int a = 0; a < 3; ++a) {  // n·g with both in T: g_T = R_FTᵀ g
    const vd g_T = fma(X_FT.R[a], g[0], fma(X_FT.R[3 + a], g[1], X_FT.R[6 + a] * g[2]));
    facing = fma(load(normal[a]), g_T, facing);
    for (int b = 0; b < 3; ++b) s.dyad[3 * a + b] = fma(force[a], q[b], s.dyad[3 * a + b]);
  }
  s.max_facing = larger(chosen(counting, facing), s.max_facing);
  if constexpr (kStiffness) add_stiffness(work.field, n, q, g, Ap, area * rate, s);
}

// Evaluates up to kBatch/kGroup groups in full and adds what is loaded.
template <bool kStiffness>
static void add_groups(const FieldView& field, const FacesView& faces, const LawView& law,
                       const Placements& X_FT, const std::int32_t* groups, int count, Work& work,
                       Accumulators& sums) {
  place_groups(faces, X_FT, groups, count, work.points);
  locate(field, count * kGroup, work.points);
  derivatives<kStiffness>(field, work.points, count * kGroup, work.field);
  for (int g = 0; g < count; ++g) {
    const int f = groups[g], n = g * kGroup;
    const int loaded = negative_lanes(load(work.field.value + n)) & work.points.inside[g];
    if (loaded == 0) continue;
    const int border = border_lanes(field, work.points, n, loaded);
    for (int l = 0; border != 0 && l < kGroup; ++l) {
      if (border >> l & 1) sums.border_area += faces.area[f + l];
    }
    add_faces<kStiffness>(faces, f, work, n, loaded & ~border, law, X_FT, sums);
  }
}

// Tests a batch of leaves and adds what is loaded of them.
template <bool kStiffness>
static void add_leaves(const FieldView& field, const FacesView& faces, const ClustersView& clusters,
                       const LawView& law, const Placements& X_FT, const std::int32_t* leaves,
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
  int near = 0;  // of the unsure groups, those that have a face near the surface
  for (int u = 0; u < unsure; u += kMost) {
    const int most = unsure - u < kMost ? unsure - u : kMost;
    place_groups(faces, X_FT, work.unsure + u, most, work.points);
    for (int g = 0; g < most; ++g) {
      if (near_lanes(field, work.points, g * kGroup) != 0) work.unsure[near++] = work.unsure[u + g];
    }
  }
  for (int u = 0; u < near; u += kMost) {
    const int most = near - u < kMost ? near - u : kMost;
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
                const LawView& law, const Placements& X_FT, Accumulators& sums) {
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

CONDYLE_INLINE void reduce(const vd* from, int count, double* to) {
  for (int i = 0; i < count; ++i) to[i] = lane_sum(from[i]);
}

}  // namespace

void CONDYLE_FAST_KERNEL(const FieldView& field, const FacesView& faces,
                         const ClustersView& clusters, const LawView& law,
                         const PlacementView& X_FT, bool stiffness, Sums& sums) {
  Accumulators s;
  std::memset(&s, 0, sizeof s);
  s.max_facing = splat(-1.0);
  Placements placement;
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
