// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/onnxruntime_library.hpp"

#include <dlfcn.h>

#include <charconv>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "condyle/surrogate/module_folder.hpp"

namespace condyle::surrogate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "CONDYLE_ONNXRUNTIME";
constexpr const char* kSystemName = "libonnxruntime.so.1";
constexpr std::string_view kVersionedPrefix = "libonnxruntime.so.1.";

/// What the process knows about the library; one for all threads.
struct State {
  std::mutex mutex;
  fs::path explicit_path;
  std::string opened;  // empty until it is
  void* entry_point = nullptr;
};

State& state() {
  static State* const only = new State;  // never destroyed: models may outlive static destruction
  return *only;
}

/// "1.31.1" of libonnxruntime.so.1.31.1 as numbers, so that 1.31 comes after 1.9.
std::vector<int> version_numbers(std::string_view name) {
  std::vector<int> numbers;
  name.remove_prefix(kVersionedPrefix.size());
  while (!name.empty()) {
    int number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error != std::errc()) return {};
    numbers.push_back(number);
    name.remove_prefix(static_cast<std::size_t>(end - name.data()));
    if (!name.empty()) {
      if (name.front() != '.') return {};
      name.remove_prefix(1);
    }
  }
  return numbers;
}

/// The highest libonnxruntime.so.1.x.y in a folder, else a plain libonnxruntime.so.1 or .so there;
/// empty if none.
fs::path library_in(const fs::path& folder) {
  fs::path best;
  std::vector<int> best_version;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(kVersionedPrefix)) continue;
    std::vector<int> version = version_numbers(name);
    if (version > best_version) {
      best = entry->path();
      best_version = std::move(version);
    }
  }
  if (!best.empty()) return best;
  for (const char* name : {kSystemName, "libonnxruntime.so"}) {
    if (fs::exists(folder / name, error)) return folder / name;
  }
  return {};
}

fs::path named_by_environment(const char* value) {
  std::error_code error;
  const fs::path named = fs::absolute(value, error);
  const fs::path file = fs::is_directory(named, error) ? library_in(named) : named;
  if (file.empty() || !fs::exists(file, error)) {
    throw std::invalid_argument(std::string(kVariable) + " is '" + value +
                                "': no onnxruntime library there");
  }
  return file;
}

/// The search of the header's page, with the state's mutex held.
std::string find(const State& known) {
  const char* value = std::getenv(kVariable);
  if (value != nullptr && value[0] != '\0') return named_by_environment(value).string();
  const fs::path folder = module_folder();
  if (!folder.empty()) {
    const fs::path beside = library_in(folder);
    if (!beside.empty()) return beside.string();
  }
  std::error_code error;
  if (!known.explicit_path.empty() && fs::exists(known.explicit_path, error)) {
    return known.explicit_path.string();
  }
  return kSystemName;
}

[[noreturn]] void refuse(const std::string& library, const std::string& reason) {
  throw std::runtime_error("onnxruntime: " + library + " cannot be used: " + reason + "; set " +
                           kVariable + " to a libonnxruntime.so.1.x.y");
}

}  // namespace

void set_library_path(const fs::path& file) {
  State& known = state();
  const std::lock_guard lock(known.mutex);
  known.explicit_path = file;
}

std::string onnxruntime_library() {
  State& known = state();
  const std::lock_guard lock(known.mutex);
  return known.opened.empty() ? find(known) : known.opened;
}

void* onnxruntime_entry_point() {
  State& known = state();
  const std::lock_guard lock(known.mutex);
  if (known.entry_point != nullptr) return known.entry_point;
  const std::string library = find(known);
  // Local: its symbols must not meet those of another onnxruntime in the process (Python's
  // extension holds one).
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) refuse(library, dlerror());
  void* entry_point = dlsym(handle, "OrtGetApiBase");
  if (entry_point == nullptr) {
    dlclose(handle);
    refuse(library, "it has no function OrtGetApiBase");
  }
  Dl_info info{};
  known.opened = dladdr(entry_point, &info) != 0 ? info.dli_fname : library;
  known.entry_point = entry_point;
  return entry_point;
}

}  // namespace condyle::surrogate
