#pragma once
/// Errors of many numbers at once.

#include <span>

namespace cvtflow::bench {

/// The one definition of a relative error: ‖is - expected‖/‖expected‖, Euclidean, over all numbers that are added. Whatever the documents
/// print of a method's error is made by it.
class RelativeError {
public:
    /// Adds numbers of one instant or quantity, in any unit. @param is, expected equally long
    void add(std::span<const double> is, std::span<const double> expected) noexcept;
    /// Adds the sums of another one.
    void add(const RelativeError& other) noexcept;

    /// 0 if both are zero; infinite where a number is not finite, or differs from a reference of zeros.
    [[nodiscard]] double value() const noexcept;

private:
    double difference_ = 0.0, reference_ = 0.0;  ///< sums of squares
};

[[nodiscard]] double relative_error(std::span<const double> is, std::span<const double> expected) noexcept;

}  // namespace cvtflow::bench
