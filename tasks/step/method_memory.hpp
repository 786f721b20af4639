#pragma once
/// What a method remembers (StepMethod::save), read back: it comes from files and hosts, and may be anything.

#include <cstddef>
#include <span>

namespace cvtflow::tasks {

/// The next numbers of a memory, which then begins behind them. @throws std::invalid_argument if there are fewer
[[nodiscard]] std::span<const double> pop_front(std::span<const double>& memory, std::size_t count);

/// The next number as one of first … last. @throws std::invalid_argument if it is out of range
[[nodiscard]] int pop_integer(std::span<const double>& memory, int first, int last);

}  // namespace cvtflow::tasks
