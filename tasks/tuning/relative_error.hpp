#pragma once
/// The one definition of a relative error: ‖is - should‖/‖should‖, Euclidean, over all numbers that are added. Whatever the documents print
/// of a method's error is made by it.

#include <span>

namespace cvtflow::tasks {

class RelativeError {
public:
    /// Numbers of one instant or quantity, in units of one's own. Of equal length.
    void add(std::span<const double> is, std::span<const double> should) noexcept;
    /// What another one has added.
    void add(const RelativeError& other) noexcept;

    /// 0 if both are zero; infinite where a number is not finite, or differs from a reference of zeros.
    [[nodiscard]] double value() const noexcept;

private:
    double difference_ = 0.0, reference_ = 0.0;  ///< sums of squares
};

/// Errors of slip are relative to at least this value: creep below a ten-thousandth is treated as zero.
inline constexpr double min_slip = 1e-4;

/// |is - should| over |should|, or over `least` where that is less: the error of a single figure, such as a mean. is, should, least [the
/// same unit]
[[nodiscard]] double relative_difference(double is, double should, double least) noexcept;

[[nodiscard]] double relative_error(std::span<const double> is, std::span<const double> should) noexcept;

}  // namespace cvtflow::tasks
