// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/row_operators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace condyle::surrogate {
namespace {

/// An operand at one row, seen element by element.
class Elements {
 public:
  Elements(const RowOperand& operand, const std::vector<RowSpan>& spans, std::size_t row)
      : data_(operand.slot < 0 ? operand.constants.data() : at(spans[slot(operand)], row)),
        index_(operand.index.empty() ? nullptr : operand.index.data()) {}
  const double* contiguous() const { return index_ == nullptr ? data_ : nullptr; }
  double operator[](std::size_t s) const { return data_[index_ == nullptr ? s : index_[s]]; }

 private:
  static std::size_t slot(const RowOperand& operand) {
    return static_cast<std::size_t>(operand.slot);
  }
  static const double* at(const RowSpan& span, std::size_t row) {
    return span.data + row * span.stride;
  }
  const double* data_;
  const std::size_t* index_;
};

double* row_of(const std::vector<RowSpan>& spans, int slot, std::size_t row) {
  const RowSpan& span = spans[static_cast<std::size_t>(slot)];
  return span.data + row * span.stride;
}

class PickStep final : public RowStep {
 public:
  PickStep(std::vector<RowPick> picks, int out) : picks_(std::move(picks)), out_(out) {}
  void run(std::size_t rows, const std::vector<RowSpan>& spans) const override {
    for (std::size_t row = 0; row < rows; ++row) {
      double* to = row_of(spans, out_, row);
      for (const RowPick& pick : picks_) *to++ = row_of(spans, pick.slot, row)[pick.element];
    }
  }

 private:
  std::vector<RowPick> picks_;
  int out_;
};

template <typename Function>
class UnaryStep final : public RowStep {
 public:
  UnaryStep(RowOperand a, std::size_t size, int out) : a_(std::move(a)), size_(size), out_(out) {}
  void run(std::size_t rows, const std::vector<RowSpan>& spans) const override {
    for (std::size_t row = 0; row < rows; ++row) {
      double* to = row_of(spans, out_, row);
      const Elements a(a_, spans, row);
      for (std::size_t s = 0; s < size_; ++s) to[s] = Function{}(a[s]);
    }
  }

 private:
  RowOperand a_;
  std::size_t size_;
  int out_;
};

template <typename Function>
class BinaryStep final : public RowStep {
 public:
  BinaryStep(RowOperand a, RowOperand b, std::size_t size, int out)
      : a_(std::move(a)), b_(std::move(b)), size_(size), out_(out) {}
  void run(std::size_t rows, const std::vector<RowSpan>& spans) const override {
    for (std::size_t row = 0; row < rows; ++row) {
      double* to = row_of(spans, out_, row);
      const Elements a(a_, spans, row), b(b_, spans, row);
      const double* pa = a.contiguous();
      const double* pb = b.contiguous();
      if (pa != nullptr && pb != nullptr) {  // a loop that compilers vectorise
        for (std::size_t s = 0; s < size_; ++s) to[s] = Function{}(pa[s], pb[s]);
      } else {
        for (std::size_t s = 0; s < size_; ++s) to[s] = Function{}(a[s], b[s]);
      }
    }
  }

 private:
  RowOperand a_, b_;
  std::size_t size_;
  int out_;
};

class WhereStep final : public RowStep {
 public:
  WhereStep(RowOperand condition, RowOperand a, RowOperand b, std::size_t size, int out)
      : condition_(std::move(condition)),
        a_(std::move(a)),
        b_(std::move(b)),
        size_(size),
        out_(out) {}
  void run(std::size_t rows, const std::vector<RowSpan>& spans) const override {
    for (std::size_t row = 0; row < rows; ++row) {
      double* to = row_of(spans, out_, row);
      const Elements condition(condition_, spans, row), a(a_, spans, row), b(b_, spans, row);
      for (std::size_t s = 0; s < size_; ++s) to[s] = condition[s] != 0.0 ? a[s] : b[s];
    }
  }

 private:
  RowOperand condition_, a_, b_;
  std::size_t size_;
  int out_;
};

using Groups = std::vector<std::vector<std::size_t>>;

/// start, then accumulated = f(accumulated, element), then finish(accumulated, count).
template <typename Reduction>
class ReduceStep final : public RowStep {
 public:
  ReduceStep(int slot, Groups groups, int out)
      : slot_(slot), groups_(std::move(groups)), out_(out) {}
  void run(std::size_t rows, const std::vector<RowSpan>& spans) const override {
    for (std::size_t row = 0; row < rows; ++row) {
      double* to = row_of(spans, out_, row);
      const double* from = row_of(spans, slot_, row);
      for (const auto& group : groups_) {
        double value = Reduction::start();
        for (const std::size_t element : group) value = Reduction::add(value, from[element]);
        *to++ = Reduction::finish(value, group.size());
      }
    }
  }

 private:
  int slot_;
  Groups groups_;
  int out_;
};

struct Sum {
  static double start() { return 0.0; }
  static double add(double value, double x) { return value + x; }
  static double finish(double value, std::size_t) { return value; }
};
struct Mean : Sum {
  static double finish(double value, std::size_t n) { return value / static_cast<double>(n); }
};
struct SumSquare : Sum {
  static double add(double value, double x) { return value + x * x; }
};
struct L2 : SumSquare {
  static double finish(double value, std::size_t) { return std::sqrt(value); }
};
// What is not a number stays: it compares as neither larger nor smaller.
double larger(double a, double b) { return a > b || std::isnan(a) ? a : b; }
double smaller(double a, double b) { return a < b || std::isnan(a) ? a : b; }
struct Max : Sum {
  static double start() { return -std::numeric_limits<double>::infinity(); }
  static double add(double value, double x) { return larger(value, x); }
};
struct Min : Sum {
  static double start() { return std::numeric_limits<double>::infinity(); }
  static double add(double value, double x) { return smaller(value, x); }
};

/// The weights stand in panels of a few outputs, so that what the kernel writes, rounded up, fits a
/// small buffer whatever the number of outputs.
class MultiplyStep final : public RowStep {
 public:
  MultiplyStep(int slot, std::size_t columns, std::size_t inputs, std::size_t outputs,
               const std::vector<double>& weight, const std::vector<double>& bias, int out)
      : slot_(slot),
        columns_(columns),
        inputs_(inputs),
        outputs_(outputs),
        out_(out),
        bias_(bias.empty() ? std::vector<double>(outputs) : bias) {
    for (std::size_t first = 0; first < outputs; first += kPanel) {
      const std::size_t used = std::min(kPanel, outputs - first);
      std::vector<double> panel(inputs * kPanel);
      for (std::size_t k = 0; k < inputs; ++k) {
        std::copy_n(&weight[k * outputs + first], used, &panel[k * kPanel]);
      }
      panels_.push_back(std::move(panel));
    }
  }

  void run(std::size_t rows, const std::vector<RowSpan>& spans) const override {
    for (std::size_t row = 0; row < rows; ++row) {
      const double* in = row_of(spans, slot_, row);
      double* to = row_of(spans, out_, row);
      for (std::size_t c = 0; c < columns_; ++c, in += inputs_, to += outputs_) {
        multiply(in, to);
      }
    }
  }

 private:
  static constexpr std::size_t kPanel = 2 * kDenseStep;

  void multiply(const double* in, double* to) const {
    alignas(64) double sums[kPanel];
    std::size_t m = 0;
    for (const auto& panel : panels_) {
      kernels_.multiply(panel.data(), static_cast<int>(inputs_), kPanel, in, 0, 1, sums, 0);
      const std::size_t end = std::min(m + kPanel, outputs_);
      for (std::size_t j = 0; m < end; ++m, ++j) to[m] = sums[j] + bias_[m];
    }
  }

  int slot_;
  std::size_t columns_, inputs_, outputs_;
  int out_;
  std::vector<double> bias_;
  std::vector<std::vector<double>> panels_;  // each (inputs, kPanel)
  const DenseKernels& kernels_ = dense_kernels();
};

template <typename Function>
std::unique_ptr<RowStep> make_unary(Function, RowOperand a, std::size_t size, int out) {
  return std::make_unique<UnaryStep<Function>>(std::move(a), size, out);
}

template <typename Function>
std::unique_ptr<RowStep> make_binary(Function, RowOperand a, RowOperand b, std::size_t size,
                                     int out) {
  return std::make_unique<BinaryStep<Function>>(std::move(a), std::move(b), size, out);
}

double truth(bool value) { return value ? 1.0 : 0.0; }

}  // namespace

std::unique_ptr<RowStep> pick_step(std::vector<RowPick> picks, int out) {
  return std::make_unique<PickStep>(std::move(picks), out);
}

std::unique_ptr<RowStep> unary_step(const std::string& op, RowOperand a, std::size_t size,
                                    int out) {
  const auto make = [&](auto f) { return make_unary(f, std::move(a), size, out); };
  if (op == "Abs") return make([](double x) { return std::abs(x); });
  if (op == "Neg") return make([](double x) { return -x; });
  if (op == "Sqrt") return make([](double x) { return std::sqrt(x); });
  if (op == "Exp") return make([](double x) { return std::exp(x); });
  if (op == "Log") return make([](double x) { return std::log(x); });
  if (op == "Tanh") return make([](double x) { return std::tanh(x); });
  if (op == "Relu") return make([](double x) { return larger(x, 0.0); });
  if (op == "Sigmoid") return make([](double x) { return 1.0 / (1.0 + std::exp(-x)); });
  if (op == "Reciprocal") return make([](double x) { return 1.0 / x; });
  if (op == "Identity") return make([](double x) { return x; });
  if (op == "Not") return make([](double x) { return truth(x == 0.0); });
  return nullptr;
}

std::unique_ptr<RowStep> binary_step(const std::string& op, RowOperand a, RowOperand b,
                                     std::size_t size, int out) {
  const auto make = [&](auto f) { return make_binary(f, std::move(a), std::move(b), size, out); };
  if (op == "Add") return make([](double x, double y) { return x + y; });
  if (op == "Sub") return make([](double x, double y) { return x - y; });
  if (op == "Mul") return make([](double x, double y) { return x * y; });
  if (op == "Div") return make([](double x, double y) { return x / y; });
  if (op == "Pow") return make([](double x, double y) { return std::pow(x, y); });
  if (op == "Max") return make([](double x, double y) { return larger(x, y); });
  if (op == "Min") return make([](double x, double y) { return smaller(x, y); });
  if (op == "Less") return make([](double x, double y) { return truth(x < y); });
  if (op == "LessOrEqual") return make([](double x, double y) { return truth(x <= y); });
  if (op == "Greater") return make([](double x, double y) { return truth(x > y); });
  if (op == "GreaterOrEqual") return make([](double x, double y) { return truth(x >= y); });
  if (op == "And") return make([](double x, double y) { return truth(x != 0.0 && y != 0.0); });
  if (op == "Or") return make([](double x, double y) { return truth(x != 0.0 || y != 0.0); });
  return nullptr;
}

std::unique_ptr<RowStep> where_step(RowOperand condition, RowOperand a, RowOperand b,
                                    std::size_t size, int out) {
  return std::make_unique<WhereStep>(std::move(condition), std::move(a), std::move(b), size, out);
}

std::unique_ptr<RowStep> reduce_step(const std::string& op, int slot, Groups groups, int out) {
  if (op == "ReduceSum") return std::make_unique<ReduceStep<Sum>>(slot, std::move(groups), out);
  if (op == "ReduceMean") return std::make_unique<ReduceStep<Mean>>(slot, std::move(groups), out);
  if (op == "ReduceMax") return std::make_unique<ReduceStep<Max>>(slot, std::move(groups), out);
  if (op == "ReduceMin") return std::make_unique<ReduceStep<Min>>(slot, std::move(groups), out);
  if (op == "ReduceL2") return std::make_unique<ReduceStep<L2>>(slot, std::move(groups), out);
  if (op == "ReduceSumSquare") {
    return std::make_unique<ReduceStep<SumSquare>>(slot, std::move(groups), out);
  }
  return nullptr;
}

std::unique_ptr<RowStep> multiply_step(int slot, std::size_t columns, std::size_t inputs,
                                       std::size_t outputs, const std::vector<double>& weight,
                                       const std::vector<double>& bias, int out) {
  return std::make_unique<MultiplyStep>(slot, columns, inputs, outputs, weight, bias, out);
}

}  // namespace condyle::surrogate
