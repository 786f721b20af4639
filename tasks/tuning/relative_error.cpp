#include "tasks/tuning/relative_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace cvtflow::tasks {

void RelativeError::add(std::span<const double> is, std::span<const double> should) noexcept {
    for (std::size_t i = 0; i < should.size(); ++i) {
        difference_ += (is[i] - should[i]) * (is[i] - should[i]);
        reference_ += should[i] * should[i];
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

double relative_error(std::span<const double> is, std::span<const double> should) noexcept {
    RelativeError error;
    error.add(is, should);
    return error.value();
}

double relative_difference(double is, double should, double least) noexcept {
    return std::abs(is - should) / std::max(std::abs(should), least);
}

}  // namespace cvtflow::tasks
