// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), by which results and caches name what they come from: a hash in metadata
// outlives the program, and anyone can recompute it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace condyle {

/// Takes bytes piece by piece.
class Sha256 {
 public:
  void update(const void* data, std::size_t size);
  /// 64 lower-case hexadecimal digits of all bytes taken. @pre called once, and last.
  std::string finish();

 private:
  void compress();

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> block_{};
  std::size_t filled_ = 0;
  std::uint64_t total_ = 0;
};

/// Of a whole text or file's content.
std::string sha256(std::string_view bytes);

}  // namespace condyle
