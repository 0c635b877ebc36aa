// SPDX-License-Identifier: Apache-2.0
// Counts what operator new is asked for. It replaces operator new, so that a program may include it
// once, and does little else.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace condyle::test {

inline std::atomic<long> allocations{0};

/// Allocations, of all threads, while body() runs.
template <typename Body>
long count_allocations(const Body& body) {
  const long before = allocations;
  body();
  return allocations - before;
}

}  // namespace condyle::test

// The aligned forms, too: Eigen and threads may ask for them.
void* operator new(std::size_t size) {
  ++condyle::test::allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t align) {
  ++condyle::test::allocations;
  const auto boundary = static_cast<std::size_t>(align);
  if (void* memory = std::aligned_alloc(boundary, (size + boundary - 1) / boundary * boundary)) {
    return memory;
  }
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
