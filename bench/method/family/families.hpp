#pragma once
/// The tables of the laboratory: classical ones, extrapolation methods, and families whose polynomials are computed.

#include <map>
#include <optional>
#include <string_view>

#include "bench/method/product_names.hpp"
#include "engine/method/catalogue.hpp"

namespace cvtflow::bench {

// Names of methods with parameters: a family and letters with numbers, such as rkc-s37-e10.

/// Values by letter, if the name is `family` followed by -<letter><number> once or more, each letter one of `letters` and at most once,
/// each number finite, in plain digits (no exponent); nothing otherwise.
[[nodiscard]] std::optional<std::map<char, double>> name_values(std::string_view name, std::string_view family, std::string_view letters);

/// rk38, dopri65, dopri87, euler-x2 …, gbs4 …: tables of numbers, with their orders.
[[nodiscard]] std::vector<StagePlan> further_tables();
/// Some members of each family, with their orders.
[[nodiscard]] std::vector<StagePlan> family_examples();
/// rkc, rock2, rock4, serk2, fitted; members are made with their orders.
[[nodiscard]] std::span<const MethodFamily> families() noexcept;

}  // namespace cvtflow::bench
