// SPDX-License-Identifier: Apache-2.0
// The search for the library. Nothing is ever opened with success in this program, so every case
// starts anew.
#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "condyle/surrogate/onnx_session.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"

using condyle::surrogate::onnxruntime_entry_point;
using condyle::surrogate::onnxruntime_library;
using condyle::surrogate::set_library_path;
namespace fs = std::filesystem;

namespace {

const fs::path kHere = fs::read_symlink("/proc/self/exe").parent_path();

/// A file that exists and is no library; gone with this object.
class DummyFile {
 public:
  explicit DummyFile(fs::path path) : path_(std::move(path)) {
    fs::create_directories(path_.parent_path());
    std::ofstream(path_) << "not a library\n";
  }
  ~DummyFile() { fs::remove(path_); }
  DummyFile(const DummyFile&) = delete;
  DummyFile& operator=(const DummyFile&) = delete;
  std::string name() const { return path_.string(); }

 private:
  fs::path path_;
};

struct Environment {
  explicit Environment(const std::string& value) {
    setenv("CONDYLE_ONNXRUNTIME", value.c_str(), 1);
  }
  ~Environment() { unsetenv("CONDYLE_ONNXRUNTIME"); }
};

struct NoChoice {
  NoChoice() {
    unsetenv("CONDYLE_ONNXRUNTIME");
    set_library_path({});
  }
};

template <typename Error>
std::string message() {
  try {
    onnxruntime_entry_point();
  } catch (const Error& error) {
    return error.what();
  }
  return "no such error";
}

}  // namespace

TEST_CASE_FIXTURE(NoChoice, "without any choice the system's loader is asked [property]") {
  CHECK(onnxruntime_library() == "libonnxruntime.so.1");
}

TEST_CASE_FIXTURE(NoChoice,
                  "the order is: environment, beside the program, the path set [property]") {
  const DummyFile set(kHere / "elsewhere" / "libonnxruntime.so.1.2.3");
  set_library_path(set.name());
  CHECK(onnxruntime_library() == set.name());
  {
    const DummyFile beside(kHere / "libonnxruntime.so.1.9.0");
    CHECK(onnxruntime_library() == beside.name());
    const DummyFile named(kHere / "elsewhere" / "named.so");
    {
      const Environment variable(named.name());
      CHECK(onnxruntime_library() == named.name());
    }
    const Environment empty("");
    CHECK(onnxruntime_library() == beside.name());
  }
  CHECK(onnxruntime_library() == set.name());
}

TEST_CASE_FIXTURE(NoChoice, "a path set that does not exist is passed over [property]") {
  set_library_path("/nowhere/libonnxruntime.so.1.2.3");
  CHECK(onnxruntime_library() == "libonnxruntime.so.1");
}

TEST_CASE_FIXTURE(NoChoice, "versions are numbers: 1.31.1 is above 1.9.0 [property]") {
  const DummyFile old(kHere / "libonnxruntime.so.1.9.0");
  const DummyFile current(kHere / "libonnxruntime.so.1.31.1");
  const DummyFile backup(kHere / "libonnxruntime.so.1.99.0.bak");
  CHECK(onnxruntime_library() == current.name());
}

TEST_CASE_FIXTURE(NoChoice, "the environment may name a folder [property]") {
  const DummyFile plain(kHere / "folder" / "libonnxruntime.so");
  const Environment variable((kHere / "folder").string());
  CHECK(onnxruntime_library() == plain.name());
}

TEST_CASE_FIXTURE(NoChoice, "an environment variable that names nothing is an error [error]") {
  const Environment variable("/nowhere/libonnxruntime.so.1");
  const std::string expected =
      "CONDYLE_ONNXRUNTIME is '/nowhere/libonnxruntime.so.1': no onnxruntime library there";
  CHECK(message<std::invalid_argument>() == expected);
  CHECK_THROWS_WITH_AS(onnxruntime_library(), expected.c_str(), std::invalid_argument);
}

TEST_CASE_FIXTURE(NoChoice,
                  "what is found but cannot be opened is an error, not passed over [error]") {
  const DummyFile dummy(kHere / "libonnxruntime.so.1.31.1");
  const std::string text = message<std::runtime_error>();
  CHECK(text.starts_with("onnxruntime: " + dummy.name() + " cannot be used: "));
  CHECK(text.ends_with("; set CONDYLE_ONNXRUNTIME to a libonnxruntime.so.1.x.y"));
  // Whoever needs the library gets the same error, every time it asks.
  for (int i = 0; i < 2; ++i) {
    CHECK_THROWS_WITH_AS(condyle::surrogate::onnxruntime_version(), text.c_str(),
                         std::runtime_error);
  }
}

TEST_CASE_FIXTURE(NoChoice, "a library without the entry point is an error [error]") {
  const Environment variable("libc.so.6");
  // A relative name is a file of the working folder, never a library that the loader would search
  // for.
  CHECK(message<std::invalid_argument>() ==
        "CONDYLE_ONNXRUNTIME is 'libc.so.6': no onnxruntime library there");
  for (const char* libc : {"/lib/x86_64-linux-gnu/libc.so.6", "/lib64/libc.so.6",
                           "/lib/aarch64-linux-gnu/libc.so.6"}) {
    if (!fs::exists(libc)) continue;
    const Environment other(libc);
    CHECK(message<std::runtime_error>().find("it has no function OrtGetApiBase") !=
          std::string::npos);
    return;
  }
  MESSAGE("skipped: no libc.so.6 in a known place");
}
