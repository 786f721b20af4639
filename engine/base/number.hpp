#pragma once
/// Numbers as text, with a decimal point in every locale. std::strtod, std::stod, printf and streams follow the locale of the host: under
/// de_DE "0.1" is 0 for them.

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace cvtflow::engine {

/// The number that the whole text is.
[[nodiscard]] inline std::optional<double> number_of(std::string_view text) noexcept {
    double number = 0.0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

}  // namespace cvtflow::engine
