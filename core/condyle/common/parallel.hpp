// SPDX-License-Identifier: Apache-2.0
// One way to spread independent work over threads.
#pragma once

#include <cstddef>
#include <functional>

namespace condyle {

/// Calls `body(i)` once for every i in [0, count), on `threads` threads (0: one per hardware thread).
///
/// Which thread runs which i is not defined, so a body writes only what belongs to its i; results are then the same
/// bytes for any number of threads.
/// @throws whatever the first failing body (by i) threw, after all threads have stopped.
/// @throws std::invalid_argument if threads < 0.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace condyle
