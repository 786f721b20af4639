#pragma once
/// Parts of the standard library that the core library uses and that of emscripten 3.1.6 (libc++ 13) lacks.

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iterator>
#include <string>
#include <system_error>
#include <type_traits>

namespace std {

#if !defined(__cpp_lib_bit_cast)
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}
#endif

namespace ranges {

struct itself {
    template <class Value>
    constexpr const Value& operator()(const Value& value) const noexcept {
        return value;
    }
};
template <class Range, class Test, class Key = itself>
constexpr auto find_if(Range&& range, Test test, Key key = {}) {
    return std::find_if(std::begin(range), std::end(range), [&](auto&& each) { return std::invoke(test, std::invoke(key, each)); });
}
template <class Range, class Value, class Key = itself>
constexpr auto find(Range&& range, const Value& value, Key key = {}) {
    return find_if(
        range, [&](const auto& each) { return each == value; }, key);
}
template <class Range, class Test>
constexpr bool any_of(Range&& range, Test test) {
    return find_if(range, test) != std::end(range);
}
template <class Range, class Test>
constexpr bool none_of(Range&& range, Test test) {
    return !any_of(range, test);
}
template <class Range, class Value>
constexpr auto count(Range&& range, const Value& value) {
    return std::count(std::begin(range), std::end(range), value);
}
template <class Range, class Output>
constexpr auto copy(Range&& range, Output output) {
    return std::copy(std::begin(range), std::end(range), output);
}
template <class Range, class Output, class Function>
constexpr auto transform(Range&& range, Output output, Function function) {
    return std::transform(std::begin(range), std::end(range), output, [&](auto&& each) { return std::invoke(function, each); });
}
/// Order of elements by what `key` takes of them.
template <class Order, class Key>
constexpr auto ordered_by(Order order, Key key) {
    return [=](const auto& a, const auto& b) { return std::invoke(order, std::invoke(key, a), std::invoke(key, b)); };
}
template <class Range, class Order = std::less<>, class Key = itself>
constexpr auto max_element(Range&& range, Order order = {}, Key key = {}) {
    return std::max_element(std::begin(range), std::end(range), ordered_by(order, key));
}
template <class Range, class Order = std::less<>, class Key = itself>
constexpr auto min_element(Range&& range, Order order = {}, Key key = {}) {
    return std::min_element(std::begin(range), std::end(range), ordered_by(order, key));
}
template <class Range, class Order = std::less<>, class Key = itself>
void stable_sort(Range&& range, Order order = {}, Key key = {}) {
    std::stable_sort(std::begin(range), std::end(range), ordered_by(order, key));
}

}  // namespace ranges

inline to_chars_result to_chars(char* first, char* last, double value, chars_format, int digits) {
    return {first + std::snprintf(first, static_cast<size_t>(last - first), "%.*g", digits, value), errc()};
}
/// The fewest digits that are read back as the number.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format format) {
    const auto size = static_cast<size_t>(last - first);
    int digits = 0, length = std::snprintf(first, size, "%.0e", value);
    while (digits < 17 && std::strtod(first, nullptr) != value) length = std::snprintf(first, size, "%.*e", ++digits, value);
    const char* exponent = std::strchr(first, 'e');
    if (format == chars_format::fixed && exponent != nullptr)
        length = std::snprintf(first, size, "%.*f", std::max(digits - std::atoi(exponent + 1), 0), value);
    return {first + length, errc()};
}

/// Doubles, as scenes write them: the callers have checked the form.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    const std::string text(first, last);
    if (text.empty() || text[0] == '+' || std::isspace(static_cast<unsigned char>(text[0]))) return {first, errc::invalid_argument};
    char* end = nullptr;
    const double read = std::strtod(text.c_str(), &end);
    if (end == text.c_str()) return {first, errc::invalid_argument};
    if (read > 1.7976931348623157e308 || read < -1.7976931348623157e308) return {first + (end - text.c_str()), errc::result_out_of_range};
    value = read;
    return {first + (end - text.c_str()), errc()};
}

}  // namespace std
