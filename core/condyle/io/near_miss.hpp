// SPDX-License-Identifier: Apache-2.0
// For messages: which of the names that there are was probably meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace condyle::io {

/// The candidate with the fewest insertions, deletions, replacements and swaps of neighbours between it and `word`, cases
/// being alike; the first of several. Empty where none is near: more than a third of the word's letters (at least one)
/// would have to change.
/// Source of the distance: Damerau 1964, Commun ACM 7:171–176 (optimal string alignment).
std::string near_miss(std::string_view word, std::span<const std::string> candidates);

/// ", did you mean 'NAME'?" after a near miss, else nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// "a, b, c"; no more than `most` of them, then "… and 7 more".
std::string listed(std::span<const std::string> names, std::size_t most = 12);

}  // namespace condyle::io
