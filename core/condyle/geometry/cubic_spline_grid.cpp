// SPDX-License-Identifier: Apache-2.0
#include "condyle/geometry/cubic_spline_grid.hpp"

#include <algorithm>
#include <cmath>

namespace condyle::geometry {
namespace {

// One axis of the prefilter: `lines` adjacent lines of `length` nodes, `stride` apart along the
// line. Lines run side by side so that the recursions of all of them vectorise.
void prefilter_lines(double* c, std::size_t lines, int length, std::size_t stride) {
  static const double kPole = std::sqrt(3.0) - 2.0;
  constexpr double kGain = 6.0;  // (1 − z)(1 − 1/z)
  const int n = length;
  // |pole|^40 < 2e-23: below rounding, so longer lines need no longer start-up sum.
  const int horizon = std::min(n, 40);
  const auto node = [&](int i) { return c + static_cast<std::size_t>(i) * stride; };
  for (std::size_t l = 0; l < lines; ++l) {
    double sum = node(0)[l], power = kPole;
    for (int i = 1; i < horizon; ++i, power *= kPole) sum += power * node(i)[l];
    node(0)[l] = sum * kGain;
  }
  for (int i = 1; i < n; ++i) {
    double* here = node(i);
    const double* before = node(i - 1);
    for (std::size_t l = 0; l < lines; ++l) here[l] = kGain * here[l] + kPole * before[l];
  }
  const double end = kPole / (kPole * kPole - 1.0);
  for (std::size_t l = 0; l < lines; ++l) {
    node(n - 1)[l] = end * (node(n - 1)[l] + kPole * node(n - 2)[l]);
  }
  for (int i = n - 2; i >= 0; --i) {
    double* here = node(i);
    const double* after = node(i + 1);
    for (std::size_t l = 0; l < lines; ++l) here[l] = kPole * (after[l] - here[l]);
  }
}

}  // namespace

CubicWeights cubic_weights(double t) {
  const double s = 1.0 - t;
  CubicWeights b;
  b.w = {s * s * s / 6.0, (4.0 + t * t * (3.0 * t - 6.0)) / 6.0,
         (4.0 + s * s * (3.0 * s - 6.0)) / 6.0, t * t * t / 6.0};
  b.d1 = {-0.5 * s * s, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), 0.5 * t * t};
  b.d2 = {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t};
  return b;
}

bool CubicSplineGrid::locate(const Vector3& p, std::array<int, 3>& cell, Vector3& fraction) const {
  for (int a = 0; a < 3; ++a) {
    const double u = (p[a] - origin[a]) / spacing;
    if (!(u >= 1.0 && u < nodes[static_cast<std::size_t>(a)] - 2)) return false;
    cell[static_cast<std::size_t>(a)] = static_cast<int>(u);
    fraction[a] = u - cell[static_cast<std::size_t>(a)];
  }
  return true;
}

void CubicSplineGrid::interpolate(std::vector<double> samples) {
  const auto nx = static_cast<std::size_t>(nodes[0]), ny = static_cast<std::size_t>(nodes[1]);
  double* c = samples.data();
  for (std::size_t row = 0; row < ny * static_cast<std::size_t>(nodes[2]); ++row) {
    prefilter_lines(c + row * nx, 1, nodes[0], 1);
  }
  for (int k = 0; k < nodes[2]; ++k) {
    prefilter_lines(c + static_cast<std::size_t>(k) * nx * ny, nx, nodes[1], nx);
  }
  prefilter_lines(c, nx * ny, nodes[2], nx * ny);
  coefficients.assign(samples.begin(), samples.end());
}

double CubicSplineGrid::value(const Vector3& p) const {
  std::array<int, 3> cell;
  Vector3 t;
  if (!locate(p, cell, t)) return 0.0;
  const CubicWeights x = cubic_weights(t[0]), y = cubic_weights(t[1]), z = cubic_weights(t[2]);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const float* c = &coefficients[index(cell[0] - 1, cell[1] - 1 + static_cast<int>(j),
                                           cell[2] - 1 + static_cast<int>(k))];
      sum += z.w[k] * y.w[j] * (x.w[0] * c[0] + x.w[1] * c[1] + x.w[2] * c[2] + x.w[3] * c[3]);
    }
  }
  return sum;
}

FieldValue CubicSplineGrid::evaluate(const Vector3& p) const {
  FieldValue field;
  std::array<int, 3> cell;
  Vector3 t;
  if (!locate(p, cell, t)) return field;
  const CubicWeights x = cubic_weights(t[0]), y = cubic_weights(t[1]), z = cubic_weights(t[2]);
  Vector3& g = field.gradient;
  Matrix3& H = field.hessian;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const float* c = &coefficients[index(cell[0] - 1, cell[1] - 1 + static_cast<int>(j),
                                           cell[2] - 1 + static_cast<int>(k))];
      double s = 0.0, s1 = 0.0, s2 = 0.0;  // along x: value, first and second derivative
      for (std::size_t i = 0; i < 4; ++i) {
        s += x.w[i] * c[i];
        s1 += x.d1[i] * c[i];
        s2 += x.d2[i] * c[i];
      }
      field.value += z.w[k] * y.w[j] * s;
      g += Vector3(z.w[k] * y.w[j] * s1, z.w[k] * y.d1[j] * s, z.d1[k] * y.w[j] * s);
      H(0, 0) += z.w[k] * y.w[j] * s2;
      H(1, 1) += z.w[k] * y.d2[j] * s;
      H(2, 2) += z.d2[k] * y.w[j] * s;
      H(0, 1) += z.w[k] * y.d1[j] * s1;
      H(0, 2) += z.d1[k] * y.w[j] * s1;
      H(1, 2) += z.d1[k] * y.d1[j] * s;
    }
  }
  g /= spacing;
  H /= spacing * spacing;
  H(1, 0) = H(0, 1);
  H(2, 0) = H(0, 2);
  H(2, 1) = H(1, 2);
  return field;
}

}  // namespace condyle::geometry
