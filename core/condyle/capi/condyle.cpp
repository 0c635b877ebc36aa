// SPDX-License-Identifier: Apache-2.0
// Every function here ends in guarded(): no exception passes into C.
#include "condyle/capi/condyle.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "condyle/surrogate/hybrid_contact_model.hpp"
#include "condyle/surrogate/onnx_contact_model.hpp"

namespace {

using condyle::Matrix6;
using condyle::Pose;
using condyle::SideOfBody;
using condyle::contact::ContactLoads;
using condyle::contact::ContactModel;
using condyle::contact::Derivatives;
using condyle::contact::LoadSpans;
using condyle::surrogate::HybridContactModel;
using condyle::surrogate::OnnxContactModel;
using condyle::surrogate::Runtime;

/// The reference returned something else than 0.
class ReferenceFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// No std::string: keeping a message must not fail, not even for want of memory.
constexpr std::size_t kErrorSize = 1024;
thread_local char last_error[kErrorSize] = "";

condyle_status fail(condyle_status status, std::string_view message) noexcept {
  const std::size_t kept = std::min(message.size(), kErrorSize - 1);
  std::memcpy(last_error, message.data(), kept);
  last_error[kept] = '\0';
  return status;
}

/// Runs body and turns what it throws into a status.
template <typename Body>
condyle_status guarded(const Body& body) noexcept {
  try {
    body();
    return CONDYLE_OK;
  } catch (const ReferenceFailed& error) {
    return fail(CONDYLE_REFERENCE_FAILED, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(CONDYLE_INVALID_ARGUMENT, error.what());
  } catch (const std::bad_alloc&) {
    return fail(CONDYLE_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return fail(CONDYLE_RUNTIME_ERROR, error.what());
  } catch (...) {
    return fail(CONDYLE_RUNTIME_ERROR, "unknown error");
  }
}

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) throw std::invalid_argument(std::string(name) + " is null");
}

/// The caller's function as a contact model.
class Callback final : public ContactModel {
 public:
  Callback(condyle_reference reference, void* user_data, SideOfBody side)
      : reference_(reference), user_data_(user_data), side_(side) {}

  SideOfBody side_of_body() const override { return side_; }

  ContactLoads evaluate(const Pose& pose, Derivatives derivatives) const override {
    ContactLoads loads;
    const bool stiffness = derivatives == Derivatives::kStiffness;
    const int status = reference_(user_data_, pose.data(), loads.wrench.front().data(),
                                  stiffness ? loads.stiffness.front().data() : nullptr);
    if (status != 0) {
      throw ReferenceFailed("the reference returned " + std::to_string(status) +
                            ": must be 0 for success");
    }
    return loads;
  }

 private:
  condyle_reference reference_;
  void* user_data_;
  SideOfBody side_;
};

/// A file's JSON texts as such, anything else as text.
nlohmann::json parsed(const std::string& text) {
  if (!text.starts_with('{') && !text.starts_with('[')) return text;
  nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  return value.is_discarded() ? nlohmann::json(text) : value;
}

std::string describe(const OnnxContactModel& model, bool hybrid) {
  nlohmann::ordered_json said;
  said["file"] = model.file().string();
  said["library_version"] = CONDYLE_VERSION;
  said["outputs"] = nlohmann::json::array({"wrench"});
  if (model.has_stiffness()) said["outputs"] = {"wrench", "stiffness", "error", "trust"};
  said["runtime"] = name(model.runtime());
  said["instruction_set"] = model.instruction_set();
  said["fused_refusal"] = model.fused_refusal();
  said["hybrid"] = hybrid;
  for (const auto& [key, text] : model.metadata()) said["metadata"][key] = parsed(text);
  return said.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// n numbers at a pointer; none for null, whose size must then be 0.
std::span<double> values(double* first, std::size_t size, const char* name) {
  if (first == nullptr && size != 0) {
    throw std::invalid_argument(std::string(name) + " is null, its size " + std::to_string(size));
  }
  if (first != nullptr && size == 0) {
    throw std::invalid_argument(std::string(name) + "_size is 0: null if it is not wanted");
  }
  return {first, size};
}

std::vector<Pose> read_poses(const double* poses, std::size_t size) {
  std::vector<Pose> read(size / CONDYLE_POSE_SIZE);
  for (std::size_t i = 0; i < read.size(); ++i) {
    std::copy_n(poses + CONDYLE_POSE_SIZE * i, CONDYLE_POSE_SIZE, read[i].data());
  }
  return read;
}

}  // namespace

struct condyle_model {
  std::shared_ptr<const ContactModel> contact;
  std::shared_ptr<const HybridContactModel> hybrid;  // contact again, if it is one
  std::string description;
};

namespace {

condyle_model* create(const char* path, const char* runtime, condyle_reference reference,
                      void* user_data) {
  auto made = std::make_unique<condyle_model>();
  const Runtime wanted =
      runtime == nullptr ? Runtime::kAuto : condyle::surrogate::runtime_from_name(runtime);
  const auto surrogate = std::make_shared<const OnnxContactModel>(path, wanted);
  made->contact = surrogate;
  made->description = describe(*surrogate, reference != nullptr);
  if (reference != nullptr) {
    made->hybrid = std::make_shared<const HybridContactModel>(
        surrogate, std::make_shared<Callback>(reference, user_data, surrogate->side_of_body()));
    made->contact = made->hybrid;
  }
  return made.release();
}

condyle_status create_checked(const char* path, const char* runtime, bool hybrid,
                              condyle_reference reference, void* user_data,
                              condyle_model** model) noexcept {
  if (model != nullptr) *model = nullptr;
  return guarded([&] {
    require(model, "model");
    require(path, "path");
    if (hybrid && reference == nullptr) throw std::invalid_argument("reference is null");
    *model = create(path, runtime, reference, user_data);
  });
}

}  // namespace

extern "C" {

const char* condyle_version(void) { return CONDYLE_VERSION; }

const char* condyle_last_error(void) { return last_error; }

condyle_status condyle_create(const char* path, const char* runtime, condyle_model** model) {
  return create_checked(path, runtime, false, nullptr, nullptr, model);
}

condyle_status condyle_create_hybrid(const char* path, const char* runtime,
                                     condyle_reference reference, void* user_data,
                                     condyle_model** model) {
  return create_checked(path, runtime, true, reference, user_data, model);
}

void condyle_destroy(condyle_model* model) { delete model; }

condyle_status condyle_evaluate(const condyle_model* model, const double* pose, double* wrench,
                                double* stiffness, double* error, double* trust) {
  return guarded([&] {
    require(model, "model");
    require(pose, "pose");
    require(wrench, "wrench");
    const ContactLoads loads = model->contact->evaluate(
        Eigen::Map<const Pose>(pose),
        stiffness != nullptr ? Derivatives::kStiffness : Derivatives::kNone);
    std::copy_n(loads.wrench.front().data(), CONDYLE_WRENCH_SIZE, wrench);
    if (stiffness != nullptr) {
      std::copy_n(loads.stiffness.front().data(), CONDYLE_STIFFNESS_SIZE, stiffness);
    }
    if (error != nullptr) std::copy_n(loads.error.front().data(), CONDYLE_WRENCH_SIZE, error);
    if (trust != nullptr) *trust = loads.trust;
  });
}

condyle_status condyle_evaluate_batch(const condyle_model* model, const double* poses,
                                      size_t poses_size, int threads,
                                      const condyle_batch* results) {
  return guarded([&] {
    require(model, "model");
    require(results, "results");
    if (poses_size % CONDYLE_POSE_SIZE != 0) {
      throw std::invalid_argument("poses_size is " + std::to_string(poses_size) +
                                  ": must be a multiple of 6");
    }
    if (poses_size == 0) return;
    require(poses, "poses");
    require(results->wrench, "wrench");
    const std::vector<Pose> read = read_poses(poses, poses_size);
    const LoadSpans loads{
        .wrench = values(results->wrench, results->wrench_size, "wrench"),
        .stiffness = values(results->stiffness, results->stiffness_size, "stiffness"),
        .error = values(results->error, results->error_size, "error"),
        .trust = values(results->trust, results->trust_size, "trust"),
        .implausible_depth = {}};
    loads.require_rows(read.size());
    // A reference is the caller's code: one pose after the other, in the caller's thread.
    model->contact->evaluate_into(read, model->hybrid ? 1 : threads, loads);
  });
}

const char* condyle_describe(const condyle_model* model) {
  return model == nullptr ? nullptr : model->description.c_str();
}

condyle_status condyle_reference_calls(const condyle_model* model, uint64_t* calls) {
  return guarded([&] {
    require(model, "model");
    require(calls, "calls");
    *calls = model->hybrid ? model->hybrid->reference_calls() : 0;
  });
}

}  // extern "C"
