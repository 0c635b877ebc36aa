// SPDX-License-Identifier: Apache-2.0
// The one file that includes onnxruntime. Its API table is filled by hand (ORT_API_MANUAL_INIT)
// from the library that onnxruntime_library.hpp opens, so nothing links against it.
#include "condyle/surrogate/onnx_session.hpp"

#define ORT_API_MANUAL_INIT
#include <onnxruntime_cxx_api.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "condyle/surrogate/onnx_file.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"

namespace condyle::surrogate {
namespace {

// The oldest table that has every function called below with the layout of the headers; also the
// oldest wheel we accept.
constexpr int kOldestApi = 17;

/// onnxruntime's own messages may span lines; ours do not.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// "1.31.1" → 31: the library's newest API. Asking for more than it has would make it print to
/// stderr.
int newest_api(std::string_view version) {
  int minor = 0;
  if (version.starts_with("1.")) {
    version.remove_prefix(2);
    std::from_chars(version.data(), version.data() + version.size(), minor);
  }
  return minor;
}

/// The library, opened, and the one environment of the process. Never destroyed: a session may be
/// the last to go.
struct Runtime {
  Runtime() {
    using EntryPoint = const OrtApiBase* (*)();
    const auto* base = reinterpret_cast<EntryPoint>(onnxruntime_entry_point())();
    version = base->GetVersionString();
    const int api_version = std::min(newest_api(version), ORT_API_VERSION);
    const OrtApi* api = api_version < kOldestApi ? nullptr : base->GetApi(api_version);
    if (api == nullptr) {
      throw std::runtime_error("onnxruntime: " + onnxruntime_library() + " is version " + version +
                               ": must be 1." + std::to_string(kOldestApi) + " or newer");
    }
    Ort::InitApi(api);
    // Fatal only: what goes wrong arrives as an exception, and a library prints nothing.
    environment.emplace(ORT_LOGGING_LEVEL_FATAL, "condyle");
  }
  std::string version;
  // Optional, since an empty Ort::Env calls the API table when it goes, and there may be none.
  std::optional<Ort::Env> environment;
};

Runtime& runtime() {
  static Runtime* const only = new Runtime;
  return *only;
}

Ort::Session open(const std::filesystem::path& file) {
  const std::vector<char> bytes = read_bytes(file);
  Runtime& shared = runtime();
  Ort::SessionOptions options;
  options.SetIntraOpNumThreads(1);
  options.SetInterOpNumThreads(1);
  options.SetExecutionMode(ORT_SEQUENTIAL);
  options.SetGraphOptimizationLevel(ORT_ENABLE_ALL);
  options.AddConfigEntry("session.intra_op.allow_spinning", "0");
  options.AddConfigEntry("session.inter_op.allow_spinning", "0");
  try {
    return Ort::Session(*shared.environment, bytes.data(), bytes.size(), options);
  } catch (const Ort::Exception& error) {
    throw std::invalid_argument(file.string() + ": not an ONNX model that onnxruntime " +
                                shared.version +
                                " can run (truncated?): " + one_line(error.what()));
  }
}

const char* type_name(ONNXTensorElementDataType type) {
  switch (type) {
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_DOUBLE:
      return "float64";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT:
      return "float32";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT16:
      return "float16";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT64:
      return "int64";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_INT32:
      return "int32";
    case ONNX_TENSOR_ELEMENT_DATA_TYPE_BOOL:
      return "bool";
    default:
      return "other";
  }
}

TensorSignature tensor_signature(const char* name, const Ort::TypeInfo& type) {
  TensorSignature signature{name, "other", {}};
  if (type.GetONNXType() != ONNX_TYPE_TENSOR) return signature;
  const auto tensor = type.GetTensorTypeAndShapeInfo();
  signature.type = type_name(tensor.GetElementType());
  signature.shape = tensor.GetShape();
  return signature;
}

FileSignature read_signature(const Ort::Session& session) {
  Ort::AllocatorWithDefaultOptions allocator;
  FileSignature signature;
  for (std::size_t i = 0; i < session.GetInputCount(); ++i) {
    signature.inputs.push_back(tensor_signature(session.GetInputNameAllocated(i, allocator).get(),
                                                session.GetInputTypeInfo(i)));
  }
  for (std::size_t i = 0; i < session.GetOutputCount(); ++i) {
    signature.outputs.push_back(tensor_signature(session.GetOutputNameAllocated(i, allocator).get(),
                                                 session.GetOutputTypeInfo(i)));
  }
  const Ort::ModelMetadata metadata = session.GetModelMetadata();
  for (const auto& key : metadata.GetCustomMetadataMapKeysAllocated(allocator)) {
    signature.metadata[key.get()] =
        metadata.LookupCustomMetadataMapAllocated(key.get(), allocator).get();
  }
  return signature;
}

}  // namespace

std::string onnxruntime_version() { return runtime().version; }

struct OnnxSession::Impl {
  explicit Impl(const std::filesystem::path& file)
      : session(open(file)), signature(read_signature(session)) {}

  /// Input and output memory for one run at a time, bound to the session.
  struct Workspace {
    Workspace(Ort::Session& session, const FileSignature& file, std::size_t capacity)
        : signature(file), binding(session), poses(capacity * 6) {
      for (const auto& output : signature.outputs) {
        std::size_t size = capacity;
        for (std::size_t d = 1; d < output.shape.size(); ++d) {
          size *= static_cast<std::size_t>(output.shape[d]);
        }
        outputs.emplace_back(size);
        pointers.push_back(outputs.back().data());
      }
    }

    /// Binds the memory as tensors of `rows` rows, unless it is already.
    void bind(std::size_t rows) {
      if (rows == bound_rows) return;
      const auto memory = Ort::MemoryInfo::CreateCpu(OrtArenaAllocator, OrtMemTypeDefault);
      const auto tensor = [&](std::vector<double>& values, std::vector<std::int64_t> shape) {
        shape.front() = static_cast<std::int64_t>(rows);
        return Ort::Value::CreateTensor<double>(memory, values.data(), values.size(), shape.data(),
                                                shape.size());
      };
      binding.ClearBoundInputs();
      binding.ClearBoundOutputs();
      const auto& input = signature.inputs.front();
      binding.BindInput(input.name.c_str(), tensor(poses, input.shape));
      for (std::size_t i = 0; i < outputs.size(); ++i) {
        const auto& output = signature.outputs[i];
        binding.BindOutput(output.name.c_str(), tensor(outputs[i], output.shape));
      }
      bound_rows = rows;
    }

    const FileSignature& signature;
    Ort::IoBinding binding;
    std::size_t bound_rows = 0;
    std::vector<double> poses;
    std::vector<std::vector<double>> outputs;
    std::vector<const double*> pointers;
  };

  /// Workspaces that no run holds: of one row, and of kMaxRows. As many as runs were ever under way
  /// together.
  struct Pool {
    std::mutex mutex;
    std::vector<std::unique_ptr<Workspace>> idle;
  };

  /// A workspace held for one run, given back at its end.
  class Loan {
   public:
    Loan(Impl& impl, std::size_t capacity) : pool_(capacity == 1 ? impl.single : impl.batch) {
      {
        const std::lock_guard lock(pool_.mutex);
        if (!pool_.idle.empty()) {
          workspace_ = std::move(pool_.idle.back());
          pool_.idle.pop_back();
        }
      }
      if (!workspace_) {
        workspace_ = std::make_unique<Workspace>(impl.session, impl.signature, capacity);
      }
    }
    ~Loan() {
      const std::lock_guard lock(pool_.mutex);
      pool_.idle.push_back(std::move(workspace_));
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    Workspace& operator*() const { return *workspace_; }

   private:
    Pool& pool_;
    std::unique_ptr<Workspace> workspace_;
  };

  Ort::Session session;
  FileSignature signature;
  Ort::RunOptions options;
  Pool single;
  Pool batch;
};

OnnxSession::OnnxSession(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}
OnnxSession::~OnnxSession() = default;
OnnxSession::OnnxSession(OnnxSession&&) noexcept = default;
OnnxSession& OnnxSession::operator=(OnnxSession&&) noexcept = default;

const FileSignature& OnnxSession::signature() const { return impl_->signature; }

void OnnxSession::run(std::span<const Pose> poses, const Read& read) const {
  const Impl::Loan loan(*impl_, poses.size() == 1 ? 1 : kMaxRows);
  Impl::Workspace& workspace = *loan;
  try {
    workspace.bind(poses.size());
    std::memcpy(workspace.poses.data(), poses.data(), poses.size_bytes());
    impl_->session.Run(impl_->options, workspace.binding);
  } catch (const Ort::Exception& error) {
    workspace.bound_rows = 0;
    throw std::runtime_error("onnxruntime: " + one_line(error.what()));
  }
  read(workspace.pointers);
}

}  // namespace condyle::surrogate
