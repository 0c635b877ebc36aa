// SPDX-License-Identifier: Apache-2.0
#include "condyle/recruitment/kkt.hpp"

#include <algorithm>
#include <cmath>

namespace condyle::recruitment {
namespace {

using In = Eigen::Ref<const Vector>;

// x^(p − 1); 1 for p = 1, also at 0.
double marginal_power(double x, double p) {
  if (p == 1.0) return 1.0;
  if (p == 2.0) return x;
  return p == 3.0 ? x * x : std::pow(x, p - 1.0);
}

double price_of(const ScaledProblem& s, const In& multipliers, int i) {
  double z = 0.0;
  for (int j = 0; j < s.n; ++j) z += s.A(j, i) * multipliers[j];
  return z;
}

double primal(const ScaledProblem& s, const In& x, const In& y) {
  const double largest = std::max(x.maxCoeff(), 1e-300);
  double off = 0.0;
  for (int j = 0; j < s.n; ++j) {
    off = std::max(off, std::abs(s.b[j] - s.A.row(j).dot(x) - s.reserve[j] * y[j]));
  }
  off /= s.b.cwiseAbs().maxCoeff() + largest;
  for (int i = 0; i < s.m; ++i) {
    off = std::max(off, std::max(s.lower[i] - x[i], x[i] - s.upper[i]) / largest);
  }
  return off;
}

void powers(const ScaledProblem& s, double p, const In& x, const In& y, const In& multipliers,
            KktResiduals& out) {
  double price = 1e-300;
  for (int i = 0; i < s.m; ++i) {
    price = std::max(price, p * s.weight[i] * marginal_power(std::max(x[i], 0.0), p));
  }
  for (int j = 0; j < s.n; ++j) price = std::max(price, s.reserve[j] * std::abs(multipliers[j]));
  const double largest = std::max(x.maxCoeff(), 1e-300);
  for (int i = 0; i < s.m; ++i) {
    if (s.upper[i] == s.lower[i]) continue;
    const double marginal = p * s.weight[i] * marginal_power(std::max(x[i], 0.0), p);
    const double d = (marginal - price_of(s, multipliers, i)) / price;
    if (d > 0.0) {
      out.complementarity = std::max(out.complementarity, std::min(d, (x[i] - s.lower[i]) / largest));
    } else if (std::isinf(s.upper[i])) {
      out.stationarity = std::max(out.stationarity, -d);
    } else {
      out.complementarity = std::max(out.complementarity, std::min(-d, (s.upper[i] - x[i]) / largest));
    }
  }
  for (int j = 0; j < s.n; ++j) {
    if (s.reserve[j] == 0.0) continue;
    const double z = s.reserve[j] * multipliers[j];
    const double marginal = p * s.price[j] * marginal_power(std::abs(y[j]), p);
    const bool kink = p == 1.0 && y[j] == 0.0;
    const double off = kink ? std::abs(z) - marginal : std::abs(std::copysign(marginal, y[j]) - z);
    out.stationarity = std::max(out.stationarity, off / price);
  }
}

void levels(const ScaledProblem& s, const In& x, const In& y, const In& multipliers, KktResiduals& out) {
  const double t = largest_level(s, x, y);
  const double largest = std::max(x.maxCoeff(), 1e-300);
  if (!(t > 0.0)) return;
  double sum = 0.0;
  for (int i = 0; i < s.m; ++i) {
    if (s.upper[i] == s.lower[i]) continue;
    const double share = price_of(s, multipliers, i) / s.weight[i];
    const double top = std::max(s.lower[i], std::min(s.upper[i], t / s.weight[i]));
    const bool level = t / s.weight[i] > s.lower[i] && t / s.weight[i] < s.upper[i];
    if (share > 0.0 && level) sum += share;
    const double room = share > 0.0 ? top - x[i] : x[i] - s.lower[i];
    out.complementarity = std::max(out.complementarity, std::min(std::abs(share), room / largest));
  }
  for (int j = 0; j < s.n; ++j) {
    if (s.reserve[j] == 0.0) continue;
    const double share = s.reserve[j] * std::abs(multipliers[j]) / s.price[j];
    const double signed_level = std::copysign(s.price[j] * y[j], y[j] * multipliers[j]);
    sum += share;
    out.complementarity = std::max(out.complementarity, std::min(share, 1.0 - signed_level / t));
  }
  out.stationarity = std::abs(sum - 1.0);
}

}  // namespace

double KktResiduals::largest() const {
  return std::max({primal, stationarity, complementarity});
}

double largest_level(const ScaledProblem& s, const In& x, const In& y) {
  double t = 0.0;
  const double noise = 1e-13 * x.maxCoeff();
  for (int i = 0; i < s.m; ++i) {
    if (x[i] > s.lower[i] + noise) t = std::max(t, s.weight[i] * x[i]);
  }
  for (int j = 0; j < s.n; ++j) {
    if (s.reserve[j] > 0.0) t = std::max(t, s.price[j] * std::abs(y[j]));
  }
  return t;
}

KktResiduals kkt_residuals(const ScaledProblem& problem, const Criterion& criterion, const In& x,
                           const In& y, const In& multipliers) {
  KktResiduals out;
  out.primal = primal(problem, x, y);
  if (criterion.min_max) {
    levels(problem, x, y, multipliers, out);
  } else {
    powers(problem, criterion.exponent, x, y, multipliers, out);
  }
  return out;
}

}  // namespace condyle::recruitment
