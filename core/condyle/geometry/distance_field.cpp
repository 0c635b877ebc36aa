// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "condyle/common/parallel.hpp"

namespace condyle::geometry {
namespace {

constexpr int kCoarsening = 4;          // coarse spacing / fine spacing
constexpr double kMaximumNodes = 60e6;  // 240 MB of coefficients, twice that while building

struct Sampled {
  CubicSplineGrid grid;
  std::vector<std::uint8_t> border;  // one flag a node
};

void require_range(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument("distance field: " + std::string(name) + " is " +
                                std::to_string(value) + " m: must be between " +
                                std::to_string(low) + " and " + std::to_string(high) + " m");
  }
}

CubicSplineGrid fine_grid(const Vector3& lowest, const Vector3& highest,
                          const DistanceFieldSettings& settings) {
  require_range("spacing", settings.spacing, 1e-5, 1e-2);
  require_range("margin", settings.margin, 0.0, 0.1);
  require_range("band_outside", settings.band_outside, 0.0, 0.1);
  require_range("band_inside", settings.band_inside, 0.0, 0.1);
  if (!lowest.allFinite() || !highest.allFinite() || !(lowest.array() <= highest.array()).all()) {
    throw std::invalid_argument("distance field: the bounding box is empty or not finite");
  }
  CubicSplineGrid grid;
  grid.spacing = settings.spacing;
  // The mirror condition at the grid's ends bends the spline there, and that dies away by 0.27 a
  // node: ten nodes beyond the margin, two of which the stencil takes, leave 1e-5 of a spacing's
  // tenth.
  const double reach = settings.margin + 10.0 * settings.spacing;
  grid.origin = lowest - Vector3::Constant(reach);
  double nodes = 1.0;
  for (int a = 0; a < 3; ++a) {
    const double cells = std::ceil((highest[a] - lowest[a] + 2.0 * reach) / settings.spacing);
    nodes *= cells + 1.0;
    if (nodes > kMaximumNodes) {
      throw std::invalid_argument("distance field: spacing " + std::to_string(settings.spacing) +
                                  " m over this bounding box needs more than 60 million nodes");
    }
    grid.nodes[static_cast<std::size_t>(a)] = static_cast<int>(cells) + 1;
  }
  return grid;
}

// Exact samples at the nodes of a grid that covers the fine one with its stencil to spare.
Sampled coarse_samples(const CubicSplineGrid& fine, const DistanceSampler& sampler, int threads) {
  Sampled coarse;
  coarse.grid.spacing = kCoarsening * fine.spacing;
  coarse.grid.origin = fine.origin - Vector3::Constant(1.5 * coarse.grid.spacing);
  for (std::size_t a = 0; a < 3; ++a) {
    coarse.grid.nodes[a] = (fine.nodes[a] + kCoarsening - 1) / kCoarsening + 5;
  }
  const auto [nx, ny, nz] = coarse.grid.nodes;
  std::vector<double> samples(coarse.grid.count());
  coarse.border.resize(coarse.grid.count());
  parallel_for(static_cast<std::size_t>(nz), threads, [&, nx = nx, ny = ny](std::size_t k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const DistanceSample s = sampler(coarse.grid.node_position(i, j, static_cast<int>(k)));
        const std::size_t n = coarse.grid.index(i, j, static_cast<int>(k));
        samples[n] = s.value;
        coarse.border[n] = s.on_border ? 1 : 0;
      }
    }
  });
  coarse.grid.interpolate(std::move(samples));
  return coarse;
}

bool nearest_flag(const Sampled& coarse, const Vector3& p) {
  std::array<int, 3> node;
  for (int a = 0; a < 3; ++a) {
    node[static_cast<std::size_t>(a)] =
        static_cast<int>(std::lround((p[a] - coarse.grid.origin[a]) / coarse.grid.spacing));
  }
  return coarse.border[coarse.grid.index(node[0], node[1], node[2])] != 0;
}

}  // namespace

DistanceField DistanceField::build(const Vector3& lowest, const Vector3& highest,
                                   const DistanceFieldSettings& settings,
                                   const DistanceSampler& sampler, int threads) {
  CubicSplineGrid fine = fine_grid(lowest, highest, settings);
  std::vector<std::uint8_t> border(fine.count());
  std::vector<double> samples(fine.count());
  const Sampled coarse = coarse_samples(fine, sampler, threads);

  // Two nodes of a stencil and four for what the coarse filling is wrong by to die away in (0.27 a
  // node), so that the band itself is as exact as if every node were.
  const double slack = 6.0 * settings.spacing;
  const auto [nx, ny, nz] = fine.nodes;
  parallel_for(static_cast<std::size_t>(nz), threads, [&, nx = nx, ny = ny](std::size_t k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const Vector3 p = fine.node_position(i, j, static_cast<int>(k));
        const std::size_t n = fine.index(i, j, static_cast<int>(k));
        const double rough = coarse.grid.value(p);
        const bool near =
            rough > -settings.band_inside - slack && rough < settings.band_outside + slack;
        const DistanceSample s = near ? sampler(p) : DistanceSample{rough, nearest_flag(coarse, p)};
        samples[n] = s.value;
        border[n] = s.on_border ? 1 : 0;
      }
    }
  });
  fine.interpolate(std::move(samples));
  return DistanceField(std::move(fine), std::move(border));
}

DistanceField::DistanceField(CubicSplineGrid spline, std::vector<std::uint8_t> border_nodes)
    : spline_(std::move(spline)), border_nodes_(std::move(border_nodes)) {
  const std::size_t count = spline_.count();
  if (spline_.coefficients.size() != count || border_nodes_.size() != count ||
      *std::min_element(spline_.nodes.begin(), spline_.nodes.end()) < 4) {
    throw std::invalid_argument("distance field: " + std::to_string(spline_.coefficients.size()) +
                                " coefficients and " + std::to_string(border_nodes_.size()) +
                                " flags for " + std::to_string(count) + " nodes");
  }
  border_cells_.assign(count, 0);
  for (int k = 0; k + 1 < spline_.nodes[2]; ++k) {
    for (int j = 0; j + 1 < spline_.nodes[1]; ++j) {
      for (int i = 0; i + 1 < spline_.nodes[0]; ++i) {
        std::uint8_t any = 0;
        for (int corner = 0; corner < 8; ++corner) {
          any |= border_nodes_[spline_.index(i + (corner & 1), j + ((corner >> 1) & 1),
                                             k + (corner >> 2))];
        }
        border_cells_[spline_.index(i, j, k)] = any;
      }
    }
  }
}

bool DistanceField::contains(const Vector3& p) const {
  std::array<int, 3> cell;
  Vector3 t;
  return spline_.locate(p, cell, t);
}

double DistanceField::value(const Vector3& p) const {
  return contains(p) ? spline_.value(p) : kOutside;
}

FieldValue DistanceField::evaluate(const Vector3& p) const {
  if (contains(p)) return spline_.evaluate(p);
  FieldValue outside;
  outside.value = kOutside;
  return outside;
}

bool DistanceField::on_border(const Vector3& p) const {
  std::array<int, 3> cell;
  Vector3 t;
  if (!spline_.locate(p, cell, t)) return false;
  if (border_cells_[spline_.index(cell[0], cell[1], cell[2])] == 0) return false;
  double share = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
    const double weight =
        (i ? t[0] : 1.0 - t[0]) * (j ? t[1] : 1.0 - t[1]) * (k ? t[2] : 1.0 - t[2]);
    if (border_nodes_[spline_.index(cell[0] + i, cell[1] + j, cell[2] + k)] != 0) share += weight;
  }
  return share >= 0.5;
}

}  // namespace condyle::geometry
