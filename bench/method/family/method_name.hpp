#pragma once
/// Names of methods with parameters: a family and letters with numbers, such as rkc-s37-e10.

#include <map>
#include <optional>
#include <string_view>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// Values by letter, if the name is `family` followed by -<letter><number> once or more, each letter one of `letters` and at most once,
/// each number finite, in plain digits (no exponent); nothing otherwise.
[[nodiscard]] std::optional<std::map<char, double>> name_values(std::string_view name, std::string_view family, std::string_view letters);

}  // namespace cvtflow::bench
