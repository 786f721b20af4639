#include "bench/study/tradeoff/relative_error.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

namespace cvtflow::bench {

void RelativeError::add(std::span<const double> is, std::span<const double> expected) noexcept {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        difference_ += (is[i] - expected[i]) * (is[i] - expected[i]);
        reference_ += expected[i] * expected[i];
    }
}

void RelativeError::add(const RelativeError& other) noexcept {
    difference_ += other.difference_;
    reference_ += other.reference_;
}

double RelativeError::value() const noexcept {
    if (difference_ == 0.0 && std::isfinite(reference_)) return 0.0;
    const double value = std::sqrt(difference_ / reference_);
    return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
}

double relative_error(std::span<const double> is, std::span<const double> expected) noexcept {
    RelativeError error;
    error.add(is, expected);
    return error.value();
}

}  // namespace cvtflow::bench
