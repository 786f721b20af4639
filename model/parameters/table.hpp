#pragma once
/// Parameters that are tables: over time, over a speed.

#include <utility>
#include <vector>

namespace cvtflow::model {

/// A quantity over time: linear between points, constant outside them. One point is a constant. Times ascend strictly.
struct TimeTable {
    std::vector<double> time{0.0};   ///< [s]
    std::vector<double> value{0.0};  ///< unit of the quantity [unit of the quantity]

    TimeTable() = default;
    /// constant [unit of the quantity]
    explicit TimeTable(double constant) : value{constant} {}
    TimeTable(std::vector<double> times, std::vector<double> values) : time(std::move(times)), value(std::move(values)) {}

    [[nodiscard]] double at(double t) const noexcept;  ///< t [s]
    /// ∫ from 0 to t. For t < 0: value(0) t (settling runs before zero). t [s]
    [[nodiscard]] double integral(double t) const noexcept;
    [[nodiscard]] double largest_magnitude() const noexcept;
    bool operator==(const TimeTable&) const = default;
};

/// A number over a speed, between whose points a law interpolates. Speeds ascend strictly; one point is a constant.
struct SpeedTable {
    std::vector<double> speed{0.0};   ///< [m/s]
    std::vector<double> value{0.09};  ///< unit of the quantity [unit of the quantity]
    bool operator==(const SpeedTable&) const = default;
};

}  // namespace cvtflow::model
