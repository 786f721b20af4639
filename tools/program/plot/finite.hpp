#pragma once
/// Figures of a channel that is undefined (NaN) at some outputs: only finite numbers count.

#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace cvtflow::tools {

/// Positions of the least and of the largest finite value of a range; both its first position where none is finite.
/// @param value of an element
template <class Iterator, class Value>
[[nodiscard]] std::pair<Iterator, Iterator> finite_extremes(Iterator first, Iterator last, const Value& value) {
    std::pair<Iterator, Iterator> found{first, first};
    for (Iterator at = first; at != last; ++at) {
        if (!std::isfinite(value(*at))) continue;
        if (!(value(*found.first) <= value(*at)) || !std::isfinite(value(*found.first))) found.first = at;
        if (!(value(*found.second) > value(*at)) || !std::isfinite(value(*found.second))) found.second = at;
    }
    return found;
}

/// NaN where no number is finite.
struct FiniteFigures {
    double mean = std::numeric_limits<double>::quiet_NaN(), least = mean, largest = mean;  ///< [unit of the numbers]

    /// numbers [any unit]
    explicit FiniteFigures(std::span<const double> numbers) {
        double sum = 0.0;
        long count = 0;
        for (const double number : numbers) {
            if (std::isfinite(number)) sum += number, ++count;
        }
        if (count == 0) return;
        const auto [low, high] = finite_extremes(numbers.begin(), numbers.end(), [](double number) { return number; });
        mean = sum / static_cast<double>(count), least = *low, largest = *high;
    }
};

}  // namespace cvtflow::tools
