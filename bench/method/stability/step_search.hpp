#pragma once
/// The search for the step at which disturbances begin to grow, by prediction and measurement alike.

#include <functional>
#include <limits>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// Growth in a step that still counts as none. growth_factor_tolerance [1]
inline constexpr double growth_factor_tolerance = 1e-3;
/// A method without a limit on its test equation that is stable with this step counts as stable with any step: beyond, what grows by
/// itself grows so much in a step that it cannot be distinguished from instability [s].
inline constexpr double longest_tried = 8e-6;

/// First step tried of a method without limit [s].
inline constexpr double without_expectation = 1e-6;

/// Two steps, stable and not; the second one infinite if none was unstable.
struct Bracket {
    double stable = 0.0, unstable = std::numeric_limits<double>::infinity();  ///< stable [s]
};

/// @param expected start of the search [s]; infinite or 0: at lengths up to longest_tried
[[nodiscard]] Bracket bracketed(double expected, const std::function<bool(double)>& stable);

}  // namespace cvtflow::bench
