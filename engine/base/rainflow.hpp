#pragma once
/// Rainflow counting of a load history: which cycles a varying load is made of, for fatigue. ASTM E1049-85 (2017), section 5.4.4.

#include <cstddef>
#include <span>
#include <vector>

namespace cvtflow::engine {

struct RainflowCycle {
    double range = 0.0;      ///< between its two reversals [unit of the load]
    double mean = 0.0;       ///< of its two reversals [unit of the load]
    double count = 0.0;      ///< 1, or 0.5 for half a cycle [1]
    std::size_t first = 0;   ///< index in the history of its earlier reversal
    std::size_t second = 0;  ///< of its later one
};

/// Indices of a history's reversals: its first point, every peak and valley (of equal neighbours the first), its last point.
[[nodiscard]] std::vector<std::size_t> reversals(std::span<const double> history);

/// Cycles in the order in which they are counted; halves that remain come last. A history without reversals has none. history [any unit]
[[nodiscard]] std::vector<RainflowCycle> rainflow(std::span<const double> history);

/// Cycles of like range: class k of `classes` has ranges in (k, k + 1] · largest/classes.
struct RainflowClass {
    double from = 0.0, to = 0.0;  ///< of the ranges [unit of the load]
    double count = 0.0;           ///< cycles, halves as 0.5 [1]
    double mean = 0.0;            ///< of the means, weighted by counts; 0 without cycles [unit of the load]
    double largest = 0.0;         ///< largest range [unit of the load]
};
/// @param classes at least 1
[[nodiscard]] std::vector<RainflowClass> rainflow_classes(std::span<const RainflowCycle> cycles, int classes);

}  // namespace cvtflow::engine
