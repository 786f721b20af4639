#pragma once
/// Texts that users and files give to the program and the program to them: names, numbers, spelling, control characters, messages of
/// exceptions.

#include <charconv>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace cvtflow::engine {

/// what(), which our exceptions make for users; of the standard library's: "PATH: reason" for a failure of std::filesystem, and for
/// those that only a mistake of this program's can cause (an index out of range, an empty variant) that it is one.
[[nodiscard]] std::string error_text(const std::exception& error);

/// The text with its control characters spelt out ("\x1b"), also those of two bytes in UTF-8 (U+0080 to U+009F): a terminal shows what a
/// file contains without executing it. Line breaks and tabs are kept.
[[nodiscard]] std::string visible(std::string_view text);

/// Defect of the name of a scene or a sweep, which may become part of a file's name: "contains '/'" …; empty: nothing.
[[nodiscard]] std::string name_problem(std::string_view name);

/// Defect of a text for people, which XML 1.0 must be able to hold; line breaks and tabs are allowed. Empty: nothing.
[[nodiscard]] std::string text_problem(std::string_view text);

/// The stem of a file's name as a name: what cannot be in one becomes '_'.
[[nodiscard]] std::string name_of_file(std::string_view stem);

/// Parts between spaces.
[[nodiscard]] std::vector<std::string> words_of(std::string_view text);
/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, replacements and swaps of neighbours. In bytes.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, the first of several. Empty if none is near: farther than 2 edits or a third of the word, whichever
/// is more.
[[nodiscard]] std::string closest(std::string_view word, const std::vector<std::string>& candidates);

/// ` (did you mean "suggestion"?)`, or nothing for an empty suggestion.
[[nodiscard]] std::string did_you_mean(const std::string& suggestion);
/// ` (did you mean "one" or "another"?)`, or nothing for none.
[[nodiscard]] std::string did_you_mean(const std::vector<std::string>& suggestions);

/// The number that the whole text is, with a decimal point in every locale. std::strtod, std::stod, printf and streams follow the locale of
/// the host: under de_DE "0.1" is 0 for them.
[[nodiscard]] inline std::optional<double> number_of(std::string_view text) noexcept {
    double number = 0.0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

}  // namespace cvtflow::engine
