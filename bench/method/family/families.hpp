#pragma once
/// The tables of the laboratory: classical ones, extrapolation methods, and families whose polynomials are computed.

#include <map>
#include <optional>
#include <string_view>

#include "bench/method/product_names.hpp"
#include "engine/method/catalogue.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

// Names of methods with parameters: a family and letters with numbers, such as rkc-s37-e10.

/// Values by letter, if the name is `family` followed by -<letter><number> once or more, each letter one of `letters` and at most once,
/// each number finite, in plain digits (no exponent); nothing otherwise.
[[nodiscard]] std::optional<std::map<char, double>> name_values(std::string_view name, std::string_view family, std::string_view letters);

/// rk38, dopri65, dopri87, euler-x2 …, gbs4 …: tables of numbers, with their orders.
[[nodiscard]] std::vector<StagePlan> further_tables();
/// Some members of each family, with their orders.
[[nodiscard]] std::vector<StagePlan> family_examples();
/// rkc, serk2, fitted; members are made with their orders.
[[nodiscard]] std::span<const MethodFamily> families() noexcept;

// Runge-Kutta-Chebyshev methods of order 2 with any number of stages.
// Source: Sommeijer, Shampine, Verwer, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl. Math. 88 (1998) 315-326.

inline constexpr int min_rkc_stages = 2;
inline constexpr int max_rkc_stages = 400;
inline constexpr double rkc_damping = 2.0 / 13.0;  ///< [1]
inline constexpr double max_rkc_damping = 100.0;   ///< [1]

/// The plan named rkc-s<stages>, or rkc-s<stages>-e<damping> if the damping is not the usual one. Stable on the real axis up to about
/// 0.653 stages² (damping 2/13), 0.35 stages² (10), 0.27 stages² (20); more damping widens the region along the imaginary axis.
/// Three state slots and two slope slots take turns, whatever the number of stages.
/// @param damping ε ≥ 0; for small ε, |R| ≤ 1 - ε/3 inside the interval; damping [1]
/// @throws std::invalid_argument outside the limits above
[[nodiscard]] StagePlan rkc(int stages, double damping = rkc_damping);

/// Method of a name such as "rkc-s37" or "rkc-s37-e10"; nothing if it is no such name or out of the limits.
[[nodiscard]] std::optional<StagePlan> rkc_by_name(std::string_view name);

/// Length of its real interval. damping [1]
[[nodiscard]] double rkc_reach(int stages, double damping);

}  // namespace cvtflow::bench
