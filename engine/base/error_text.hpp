#pragma once
/// The message of an exception for a user.

#include <exception>
#include <string>
#include <string_view>

namespace cvtflow::engine {

/// what(), which our own exceptions make for users; of the standard library's: "PATH: reason" for a failure of std::filesystem, and for
/// those that only a mistake of this program's can cause (an index out of range, an empty variant) that it is one.
[[nodiscard]] std::string error_text(const std::exception& error);

/// The text with its control characters spelt out ("\x1b"), also those of two bytes in UTF-8 (U+0080 to U+009F): a terminal shows what a
/// file contains without executing it. Line breaks and tabs are kept.
[[nodiscard]] std::string visible(std::string_view text);
/// Whether it holds a control character, line breaks and tabs included.
[[nodiscard]] bool has_control(std::string_view text) noexcept;

}  // namespace cvtflow::engine
