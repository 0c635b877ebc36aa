// SPDX-License-Identifier: Apache-2.0
// The closed forms inside tests/data/tiny_surrogate.onnx, stated again; its script,
// make_tiny_surrogate.py, explains them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "condyle/contact/contact_model.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"
#include "support/random_pose.hpp"

namespace condyle::test {

inline const std::filesystem::path kTestData = CONDYLE_TEST_DATA;

/// A file of tests/data; makes sure that the library the project was built with can be found.
inline std::filesystem::path surrogate_file(const char* name) {
  surrogate::set_library_path(CONDYLE_ONNXRUNTIME_LIBRARY);
  return kTestData / name;
}

inline Vector6 six(double a, double b, double c, double d, double e, double f) {
  return (Vector6() << a, b, c, d, e, f).finished();
}

inline const Vector6 kDirection[] = {six(3.5, -210.0, 12.5, 4.25, -0.375, 0.625),
                                     six(-7.5, -190.0, -6.5, -5.75, 0.875, 0.3125)};
inline const double kOffset[] = {8.75, 7.8125};
inline const Vector6 kScale[] = {six(-13.5, 421.0, 36.5, 10.25, 1.125, -2.75),
                                 six(17.25, 383.0, -42.5, -9.125, -0.625, -3.375)};
inline const Vector6 kError[] = {six(1.25, 6.5, 2.75, 0.11, 0.05, 0.07),
                                 six(1.75, 5.5, 3.25, 0.13, 0.03, 0.09)};
inline const Vector6 kCentre = six(0.0025, 0.0405, -0.0005, 0.01, 0.02, -0.55);
inline const Vector6 kHalfWidth = six(0.0125, 0.0025, 0.0035, 0.06, 0.17, 0.65);

inline contact::ContactLoads tiny_loads(const Pose& pose) {
  contact::ContactLoads loads;
  for (int side = 0; side < kSides; ++side) {
    const double depth = std::max(kDirection[side].dot(pose) + kOffset[side], 0.0);
    loads.wrench[side] = kScale[side] * depth * depth;
    loads.stiffness[side] = 2.0 * depth * kScale[side] * kDirection[side].transpose();
    loads.error[side] = kError[side];
  }
  const double farthest = (pose - kCentre).cwiseAbs().cwiseQuotient(kHalfWidth).maxCoeff();
  loads.trust = 1.0 - std::clamp(farthest - 1.0, 0.0, 1.0);
  return loads;
}

/// Poses about the file's domain, up to twice its width: in and out of contact, trusted and not.
inline std::vector<Pose> poses_about_domain(std::size_t count, std::uint64_t seed) {
  Draw draw(seed);
  std::vector<Pose> poses(count);
  for (Pose& pose : poses) {
    for (int i = 0; i < 6; ++i) pose[i] = kCentre[i] + draw(-2.1, 2.1) * kHalfWidth[i];
  }
  return poses;
}

/// A changed copy of a file, removed with this object.
class ChangedFile {
 public:
  ChangedFile(const std::filesystem::path& original, const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("condyle_" + name)) {
    std::ifstream stream(original, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  }
  ~ChangedFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ChangedFile(const ChangedFile&) = delete;
  ChangedFile& operator=(const ChangedFile&) = delete;

  /// Replaces the first `from` by `to`, of the same length; false where there is none.
  bool replace(const std::string& from, const std::string& to) {
    const auto at = bytes_.find(from);
    if (at == std::string::npos || from.size() != to.size()) return false;
    bytes_.replace(at, from.size(), to);
    return true;
  }
  void truncate(std::size_t size) { bytes_.resize(size); }
  std::size_t size() const { return bytes_.size(); }

  const std::filesystem::path& write() const {
    std::ofstream(path_, std::ios::binary) << bytes_;
    return path_;
  }

 private:
  std::filesystem::path path_;
  std::string bytes_;
};

}  // namespace condyle::test
