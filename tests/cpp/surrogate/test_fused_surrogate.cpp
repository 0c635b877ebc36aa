// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "condyle/surrogate/fused_surrogate.hpp"
#include "condyle/surrogate/graph_template.hpp"
#include "condyle/surrogate/onnx_contact_model.hpp"
#include "surrogate/tiny_surrogate.hpp"

using namespace condyle::surrogate;
using namespace condyle::test;
using condyle::kLateral;
using condyle::kMedial;
using condyle::Pose;
using condyle::contact::ContactLoads;
using condyle::contact::Derivatives;

namespace {

/// Both architectures, full and wrench-only.
struct Architecture {
  const char* name;
  const char* full;
  const char* wrench_only;
};
constexpr Architecture kArchitectures[] = {
    {"two_stage", "tiny_two_stage.onnx", "tiny_two_stage_wrench.onnx"},
    {"potential", "tiny_potential.onnx", "tiny_potential_wrench.onnx"}};

OnnxFile full_file() { return read_onnx(kTestData / "tiny_two_stage.onnx"); }

std::string refusal(const OnnxFile& file) {
  try {
    const FusedSurrogate fused(file);
  } catch (const UnknownGraph& unknown) {
    return unknown.what();
  }
  return "accepted";
}

OnnxNode& maker_of(OnnxFile& file, const std::string& output) {
  for (OnnxNode& node : file.nodes) {
    if (node.outputs.front() == output) return node;
  }
  throw std::logic_error("no node makes " + output);
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

struct Outputs {
  explicit Outputs(std::size_t n) : wrench(12 * n), stiffness(72 * n), error(12 * n), trust(n) {}
  std::vector<double> wrench, stiffness, error, trust;
};

}  // namespace

void check_against_onnxruntime(const char* file) {
  CAPTURE(file);
  const OnnxContactModel fused(surrogate_file(file), Runtime::kFused);
  const OnnxContactModel other(surrogate_file(file), Runtime::kOnnxruntime);
  CHECK(fused.runtime() == Runtime::kFused);
  CHECK(fused.fused_refusal().empty());
  CHECK(other.runtime() == Runtime::kOnnxruntime);
  const auto poses = poses_about_domain(1500, 19);
  const std::size_t n = poses.size();
  Outputs a(n), b(n);
  fused.evaluate_into(poses, 1, {a.wrench, a.stiffness, a.error, a.trust, {}});
  other.evaluate_into(poses, 1, {b.wrench, b.stiffness, b.error, b.trust, {}});
  int loaded = 0, partly = 0;
  for (std::size_t i = 0; i < n; ++i) {
    loaded += a.wrench[12 * i + 1] > 0.0;
    partly += a.trust[i] > 0.0 && a.trust[i] < 1.0;
    // Where a net's Fy is within rounding of 0 the two may fall on either side of the gate.
    CHECK((a.wrench[12 * i + 1] > 0.0) == (b.wrench[12 * i + 1] > 0.0));
  }
  CHECK(loaded > 200);
  CHECK(loaded < 1300);
  CHECK(partly > 10);  // the ramp of trust is narrow
  const auto close = [](const std::vector<double>& x, const std::vector<double>& y) {
    double worst = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - y[i]));
    // Sums of some 30 products in another order: a few tens of ε of the largest.
    return worst <= 1e-13 * largest(y);
  };
  CHECK(close(a.wrench, b.wrench));
  CHECK(close(a.stiffness, b.stiffness));
  CHECK(close(a.error, b.error));
  CHECK(close(a.trust, b.trust));
}

TEST_CASE("the fused numbers are onnxruntime's [oracle]") {
  for (const auto& one : kArchitectures) check_against_onnxruntime(one.full);
}

TEST_CASE("stiffness is the derivative of the wrench [derivative]") {
  const OnnxContactModel model(surrogate_file("tiny_two_stage.onnx"), Runtime::kFused);
  int compared = 0;
  for (const Pose& pose : poses_about_domain(60, 5)) {
    const ContactLoads loads = model.evaluate(pose, Derivatives::kStiffness);
    for (int j = 0; j < 6; ++j) {
      const double step = 1e-5 * kHalfWidth[j];
      Pose forward = pose, backward = pose;
      forward[j] += step;
      backward[j] -= step;
      const ContactLoads after = model.evaluate(forward, Derivatives::kNone);
      const ContactLoads before = model.evaluate(backward, Derivatives::kNone);
      for (const auto side : {kMedial, kLateral}) {
        if (before.wrench[side][1] <= 0.0 || after.wrench[side][1] <= 0.0) continue;
        const condyle::Vector6 difference =
            (after.wrench[side] - before.wrench[side]) / (2.0 * step);
        const condyle::Vector6 column = loads.stiffness[side].col(j);
        // Rounding ε·3e3/(1e-5 half widths), truncation 1e-10·f''' of a net whose f''' is some
        // hundred times its slope: 1e-6 of the size.
        const double size = 3e3 / kHalfWidth[j];
        CHECK((column - difference).norm() <= 1e-6 * size);
        CHECK(column != difference);
        ++compared;
      }
    }
  }
  CHECK(compared > 150);
}

void check_same_bytes(const char* file, const char* architecture) {
  const FusedSurrogate fused(read_onnx(kTestData / file));
  const auto poses = poses_about_domain(101, 3);
  Outputs all(poses.size()), values(poses.size()), one(1);
  fused.evaluate(poses,
                 {all.wrench.data(), all.stiffness.data(), all.error.data(), all.trust.data()});
  fused.evaluate(poses, {values.wrench.data(), nullptr, values.error.data(), values.trust.data()});
  CHECK(all.wrench == values.wrench);
  CHECK(all.error == values.error);
  CHECK(all.trust == values.trust);
  int differing = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    fused.evaluate({&poses[i], 1},
                   {one.wrench.data(), one.stiffness.data(), one.error.data(), one.trust.data()});
    differing += std::memcmp(one.wrench.data(), &all.wrench[12 * i], 96) != 0;
    differing += std::memcmp(one.stiffness.data(), &all.stiffness[72 * i], 576) != 0;
    differing += one.trust[0] != all.trust[i];
  }
  CHECK(differing == 0);
  CHECK(fused.architecture() == architecture);
}

TEST_CASE("a pose is the same bytes alone, in a batch, with stiffness and without [property]") {
  for (const auto& one : kArchitectures) check_same_bytes(one.full, one.name);
}

TEST_CASE("a wrench-only file is fused too [property]") {
  for (const auto& one : kArchitectures) {
    const OnnxContactModel full(surrogate_file(one.full), Runtime::kFused);
    const OnnxContactModel alone(surrogate_file(one.wrench_only), Runtime::kFused);
    CHECK_FALSE(alone.has_stiffness());
    for (const Pose& pose : poses_about_domain(50, 8)) {
      const auto a = full.evaluate(pose, Derivatives::kNone);
      const auto b = alone.evaluate(pose, Derivatives::kNone);
      CHECK(a.wrench[kMedial] == b.wrench[kMedial]);
      CHECK(a.wrench[kLateral] == b.wrench[kLateral]);
      CHECK(std::isnan(b.trust));
    }
  }
}

TEST_CASE("a graph that is not exactly the known one is refused, with the place [error]") {
  CHECK(refusal(full_file()) == "accepted");
  const auto changed = [](const auto& change) {
    OnnxFile file = full_file();
    change(file);
    return refusal(file);
  };
  CHECK(changed([](OnnxFile& f) { maker_of(f, "net_I.hidden_2").op_type = "Sigmoid"; }) ==
        "net_I.hidden_2 is made by Sigmoid, not Tanh");
  CHECK(changed([](OnnxFile& f) { maker_of(f, "wrench").inputs[1] = "one"; }) ==
        "the inputs of wrench are others");
  CHECK(changed([](OnnxFile& f) {
          maker_of(f, "net_I.sums_1")
              .attributes.push_back(
                  {.name = "alpha", .kind = 1, .number = 2.0, .integer = 0, .integers = {}});
        }) == "the attributes of net_I.sums_1 are others");
  CHECK(changed([](OnnxFile& f) { f.initialisers.at("load_order").integers[0] = 5; }) ==
        "constant load_order is not what it has to be");
  CHECK(changed([](OnnxFile& f) { f.initialisers.at("zero").doubles[0] = 1e-3; }) ==
        "constant zero is not what it has to be");
  CHECK(changed([](OnnxFile& f) { f.initialisers.at("net_I.pose_tangent").doubles[2] += 1e-9; }) ==
        "constant net_I.pose_tangent is not what it has to be");
  // A weight between the two networks of the second stage.
  CHECK(changed([](OnnxFile& f) { f.initialisers.at("net_II_III.weight_2").doubles[7] = 1e-6; }) ==
        "net_II_III is not two networks side by side");
  CHECK(changed([](OnnxFile& f) {
          f.nodes.push_back(f.nodes.front());
        }).starts_with("value net_I.sums_1 is made twice"));
  CHECK(changed([](OnnxFile& f) { f.opsets[""] = 18; }) ==
        "its operators are not those of opset 17");
  CHECK(changed([](OnnxFile& f) { f.beyond = "functions of its own"; }) ==
        "the file has functions of its own");
  CHECK(changed([](OnnxFile& f) { maker_of(f, "trust").op_type = "Erf"; }) ==
        "Erf that makes trust: an operator that is not known here");
  CHECK(changed([](OnnxFile& f) { maker_of(f, "trust").domain = "my.own"; }) ==
        "Clip that makes trust: not a standard operator");
}

TEST_CASE("what is not fused goes to onnxruntime, which says why [property]") {
  const OnnxContactModel model(surrogate_file("tiny_surrogate.onnx"));
  CHECK(model.runtime() == Runtime::kOnnxruntime);
  CHECK(model.fused_refusal() == "there is no network net_I with hidden layers");
  CHECK(model.instruction_set().empty());
  const auto file = surrogate_file("tiny_surrogate.onnx");
  CHECK_THROWS_WITH_AS(OnnxContactModel(file, Runtime::kFused),
                       (file.string() + ": the fused runtime does not know its graph: there is no "
                                        "network net_I with hidden layers")
                           .c_str(),
                       std::invalid_argument);
  CHECK(runtime_from_name("fused") == Runtime::kFused);
  CHECK_THROWS_WITH_AS(runtime_from_name("gpu"),
                       "runtime is 'gpu': must be auto, fused or onnxruntime",
                       std::invalid_argument);
}
