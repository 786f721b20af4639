#pragma once
/// "Did you mean …?"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::engine {

/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, replacements and swaps of neighbours. In bytes.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, the first of several. Empty if none is near: farther than 2 edits or a third of the word, whichever
/// is more.
[[nodiscard]] std::string closest(std::string_view word, const std::vector<std::string>& candidates);

/// ` (did you mean "suggestion"?)`, or nothing for an empty suggestion.
[[nodiscard]] std::string did_you_mean(const std::string& suggestion);
/// ` (did you mean "one" or "another"?)`, or nothing for none.
[[nodiscard]] std::string did_you_mean(const std::vector<std::string>& suggestions);

}  // namespace cvtflow::engine
