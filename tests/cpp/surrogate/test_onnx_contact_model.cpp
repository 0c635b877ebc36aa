// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <thread>

#include "condyle/surrogate/onnx_contact_model.hpp"
#include "surrogate/tiny_surrogate.hpp"

using condyle::kLateral;
using condyle::kMedial;
using condyle::kSides;
using condyle::Matrix6;
using condyle::Pose;
using condyle::Vector6;
using condyle::contact::ContactLoads;
using condyle::contact::Derivatives;
using condyle::surrogate::OnnxContactModel;
using namespace condyle::test;

namespace {

// u is a dot product of six terms of up to ~10 plus one offset, rounded each: |Δu| ≤ 7·10·ε ≈
// 1.6e-14. Then |Δ(s·v²)| ≤ 2 s v Δu + ε·s·v² with v ≤ 3 and s ≤ 421: 4e-11; derivatives 2 s·|a|·Δu
// with |a| ≤ 210: 3e-9.
constexpr double kWrenchRounding = 1e-10;
constexpr double kStiffnessRounding = 1e-8;

/// Both sides well in contact.
Pose loaded_pose() {
  Pose pose = kCentre + 0.3 * kHalfWidth;
  pose[condyle::kY] -= 0.012;
  return pose;
}

OnnxContactModel tiny_model() { return OnnxContactModel(surrogate_file("tiny_surrogate.onnx")); }

bool same_bytes(const ContactLoads& a, const ContactLoads& b) {
  bool same = std::memcmp(&a.trust, &b.trust, sizeof a.trust) == 0;
  for (int side = 0; side < kSides; ++side) {
    same = same && std::memcmp(a.wrench[side].data(), b.wrench[side].data(), 48) == 0 &&
           std::memcmp(a.error[side].data(), b.error[side].data(), 48) == 0 &&
           std::memcmp(a.stiffness[side].data(), b.stiffness[side].data(), 288) == 0;
  }
  return same;
}

std::string refusal(const std::filesystem::path& file) {
  try {
    const OnnxContactModel model(file);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

template <typename Body>
std::string message_of(const Body& body) {
  try {
    body();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("loads are the file's closed forms, in and out of contact [oracle]") {
  const OnnxContactModel model = tiny_model();
  CHECK(model.side_of_body() == condyle::SideOfBody::kLeft);
  CHECK(model.has_stiffness());
  CHECK(model.metadata().at("condyle.units") == "m,rad,N,Nm");
  CHECK(model.file().filename() == "tiny_surrogate.onnx");
  int loaded = 0, free = 0, partly_trusted = 0;
  for (const Pose& pose : poses_about_domain(200, 11)) {
    const ContactLoads expected = tiny_loads(pose);
    const ContactLoads loads = model.evaluate(pose, Derivatives::kStiffness);
    for (int side = 0; side < kSides; ++side) {
      CHECK((loads.wrench[side] - expected.wrench[side]).cwiseAbs().maxCoeff() <= kWrenchRounding);
      CHECK((loads.stiffness[side] - expected.stiffness[side]).cwiseAbs().maxCoeff() <=
            kStiffnessRounding);
      CHECK(loads.error[side] == expected.error[side]);
      ++(expected.wrench[side].isZero() ? free : loaded);
    }
    CHECK(std::abs(loads.trust - expected.trust) <= 1e-14);
    CHECK_FALSE(loads.implausible_depth);
    partly_trusted += loads.trust > 0.0 && loads.trust < 1.0;
  }
  CHECK(loaded > 50);
  CHECK(free > 50);
  CHECK(partly_trusted > 20);
}

TEST_CASE("a side out of contact is exactly zero [property]") {
  const OnnxContactModel model = tiny_model();
  Pose pose = kCentre;
  pose[condyle::kY] += 0.02;
  const ContactLoads loads = model.evaluate(pose, Derivatives::kStiffness);
  for (int side = 0; side < kSides; ++side) {
    CHECK(loads.wrench[side] == Vector6::Zero());
    CHECK(loads.stiffness[side] == Matrix6::Zero());
  }
}

TEST_CASE("stiffness is the derivative of the wrench [derivative]") {
  const OnnxContactModel model = tiny_model();
  const Pose pose = loaded_pose();  // deep enough that no step crosses a gate
  const ContactLoads loads = model.evaluate(pose, Derivatives::kStiffness);
  for (int j = 0; j < 6; ++j) {
    // Central differences of a quadratic have no truncation: only rounding, ε·|wrench|/step ~
    // 2e-16·4e3/1e-4 = 1e-8.
    const double step = 1e-4;
    Pose forward = pose, backward = pose;
    forward[j] += step;
    backward[j] -= step;
    const ContactLoads after = model.evaluate(forward, Derivatives::kNone);
    const ContactLoads before = model.evaluate(backward, Derivatives::kNone);
    for (int side = 0; side < kSides; ++side) {
      const Vector6 difference = (after.wrench[side] - before.wrench[side]) / (2.0 * step);
      const Vector6 column = loads.stiffness[side].col(j);
      CHECK(column.norm() > 1.0);
      CHECK((column - difference).norm() <= 1e-6 + 1e-10 * column.norm());
      CHECK(column != difference);
    }
  }
}

TEST_CASE("stiffness is zero unless asked for [property]") {
  const OnnxContactModel model = tiny_model();
  const ContactLoads loads = model.evaluate(loaded_pose(), Derivatives::kNone);
  CHECK(loads.wrench[kMedial].norm() > 10.0);
  CHECK(loads.stiffness[kMedial] == Matrix6::Zero());
}

TEST_CASE("a batch is the same bytes for any number of threads [property]") {
  const OnnxContactModel model = tiny_model();
  const auto poses = poses_about_domain(3 * 1024 + 129, 23);
  std::vector<ContactLoads> expected(poses.size());
  model.evaluate_batch(poses, Derivatives::kStiffness, 1, expected);
  for (const int threads : {0, 2, 5}) {
    std::vector<ContactLoads> loads(poses.size());
    model.evaluate_batch(poses, Derivatives::kStiffness, threads, loads);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) differing += !same_bytes(loads[i], expected[i]);
    CHECK(differing == 0);
  }
}

TEST_CASE("arrays hold the bytes of a batch, whatever the number of threads [property]") {
  const OnnxContactModel model = tiny_model();
  const auto poses = poses_about_domain(2 * 1024 + 57, 29);
  const std::size_t n = poses.size();
  std::vector<ContactLoads> expected(n);
  model.evaluate_batch(poses, Derivatives::kStiffness, 1, expected);
  for (const int threads : {1, 3}) {
    std::vector<double> wrench(n * 12), stiffness(n * 72), error(n * 12), trust(n);
    model.evaluate_into(poses, threads, {wrench, stiffness, error, trust, {}});
    std::size_t differing = 0;
    for (std::size_t i = 0; i < n; ++i) {
      ContactLoads row;
      row.trust = trust[i];
      for (int side = 0; side < kSides; ++side) {
        const std::size_t at = kSides * i + static_cast<std::size_t>(side);
        row.wrench[side] = Vector6(&wrench[6 * at]);
        row.error[side] = Vector6(&error[6 * at]);
        row.stiffness[side] = Matrix6(&stiffness[36 * at]);
      }
      differing += !same_bytes(row, expected[i]);
    }
    CHECK(differing == 0);
  }
}

TEST_CASE("a batch is what its poses are one by one [property]") {
  const OnnxContactModel model = tiny_model();
  // Across the border of a piece, and a last piece of one.
  const auto poses = poses_about_domain(1025, 31);
  std::vector<ContactLoads> loads(poses.size());
  model.evaluate_batch(poses, Derivatives::kStiffness, 1, loads);
  for (const std::size_t i : {0u, 1u, 511u, 1022u, 1023u, 1024u}) {
    const ContactLoads alone = model.evaluate(poses[i], Derivatives::kStiffness);
    for (int side = 0; side < kSides; ++side) {
      // The two may sum in another order: twice the rounding.
      CHECK((alone.wrench[side] - loads[i].wrench[side]).cwiseAbs().maxCoeff() <=
            2.0 * kWrenchRounding);
      CHECK((alone.stiffness[side] - loads[i].stiffness[side]).cwiseAbs().maxCoeff() <=
            2.0 * kStiffnessRounding);
    }
    CHECK(alone.trust == loads[i].trust);
  }
  std::vector<ContactLoads> none;
  model.evaluate_batch({}, Derivatives::kStiffness, 3, none);
}

TEST_CASE("one model may be evaluated by many threads at once [property]") {
  const OnnxContactModel model = tiny_model();
  const auto poses = poses_about_domain(400, 41);
  std::vector<ContactLoads> alone(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    alone[i] = model.evaluate(poses[i], Derivatives::kStiffness);
  }
  std::vector<std::size_t> differing(4, 0);
  {
    std::vector<std::jthread> threads;
    for (auto& count : differing) {
      threads.emplace_back([&] {
        for (std::size_t i = 0; i < poses.size(); ++i) {
          count += !same_bytes(model.evaluate(poses[i], Derivatives::kStiffness), alone[i]);
        }
      });
    }
  }
  for (const std::size_t count : differing) CHECK(count == 0);
}

TEST_CASE("a wrench-only file gives the same wrench, unknown trust, and no stiffness [property]") {
  const OnnxContactModel full = tiny_model();
  const OnnxContactModel model(surrogate_file("tiny_surrogate_wrench.onnx"));
  CHECK_FALSE(model.has_stiffness());
  const ContactLoads loads = model.evaluate(loaded_pose(), Derivatives::kNone);
  const ContactLoads expected = full.evaluate(loaded_pose(), Derivatives::kNone);
  CHECK(loads.wrench[kLateral].norm() > 10.0);
  CHECK((loads.wrench[kLateral] - expected.wrench[kLateral]).cwiseAbs().maxCoeff() <=
        2.0 * kWrenchRounding);
  CHECK(std::isnan(loads.trust));
  CHECK(std::isnan(loads.error[kMedial][condyle::kY]));

  const std::string message =
      model.file().string() + ": stiffness was asked of a file that has the output wrench alone";
  CHECK(message_of([&] { model.evaluate(kCentre, Derivatives::kStiffness); }) == message);
  std::vector<ContactLoads> batch(1);
  CHECK(message_of([&] {
          model.evaluate_batch({&kCentre, 1}, Derivatives::kStiffness, 1, batch);
        }) == message);
}

TEST_CASE("a pose that is not finite is refused with its coordinate and row [error]") {
  const OnnxContactModel model = tiny_model();
  std::vector<Pose> poses = poses_about_domain(5, 3);
  poses[3][condyle::kThetaY] = std::numeric_limits<double>::quiet_NaN();
  std::vector<ContactLoads> loads(poses.size());
  CHECK(message_of([&] { model.evaluate(poses[3], Derivatives::kNone); }) ==
        "pose: theta_y is nan: must be finite");
  CHECK(message_of([&] { model.evaluate_batch(poses, Derivatives::kNone, 2, loads); }) ==
        "row 3: pose: theta_y is nan: must be finite");
  loads.pop_back();
  CHECK(message_of([&] { model.evaluate_batch(poses, Derivatives::kNone, 2, loads); }) ==
        "evaluate_batch: 4 results for 5 poses");
}

TEST_CASE("a file that breaks the contract is refused with its name and field [error]") {
  ChangedFile units(surrogate_file("tiny_surrogate.onnx"), "units.onnx");
  REQUIRE(units.replace("m,rad,N,Nm", "m,deg,N,Nm"));
  CHECK(refusal(units.write()) ==
        units.write().string() + ": metadata condyle.units is 'm,deg,N,Nm': must be 'm,rad,N,Nm'");
}

TEST_CASE("weights that are not finite are found when the file is read [error]") {
  ChangedFile damaged(surrogate_file("tiny_surrogate.onnx"), "damaged.onnx");
  const auto bytes = [](double value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  REQUIRE(damaged.replace(bytes(kScale[kLateral][2]), bytes(std::nan(""))));
  const std::string message = refusal(damaged.write());
  CHECK(message.starts_with(damaged.write().string() + ": constant "));
  CHECK(message.ends_with(" is not finite: the file's weights are damaged"));
}

TEST_CASE("an overflowing wrench is not trusted [property]") {
  const OnnxContactModel model = tiny_model();
  Pose pose = kCentre;
  pose[condyle::kY] = -1e160;  // v² overflows
  CHECK(model.evaluate(pose, Derivatives::kNone).trust == 0.0);
  const OnnxContactModel wrench_only(surrogate_file("tiny_surrogate_wrench.onnx"));
  CHECK(wrench_only.evaluate(pose, Derivatives::kNone).trust == 0.0);
}
