#pragma once
/// An axis as numbers: where values lie between its ends, and its ticks.

#include <string>
#include <vector>

#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

struct Tick {
    double value;
    std::string label;  ///< empty: a minor tick
};

class AxisScale {
public:
    /// Ends: those of the axis, else the minimum and maximum of `values` that the axis can show, with a margin.
    /// An axis without any value runs from 0 to 1 (1 to 10).
    /// @throws std::invalid_argument as svg()
    AxisScale(const Axis& axis, const std::vector<double>& values);

    /// Whether the axis has a place for the value: finite, and above 0 on a logarithmic axis.
    [[nodiscard]] bool shows(double value) const noexcept;
    /// 0 at the axis' beginning, 1 at its end; beyond them outside. @param value one that is shown
    [[nodiscard]] double place(double value) const noexcept;
    /// The value at a place: the inverse of place().
    [[nodiscard]] double value(double place) const noexcept;
    /// Ascending, between the ends. About `labels` of them have labels.
    [[nodiscard]] std::vector<Tick> ticks(int labels) const;

private:
    [[nodiscard]] double forward(double value) const noexcept;
    [[nodiscard]] double backward(double image) const noexcept;
    [[nodiscard]] std::vector<Tick> round_numbers(int labels) const;
    [[nodiscard]] std::vector<Tick> within_a_decade() const;
    [[nodiscard]] std::vector<Tick> decades(int labels) const;
    [[nodiscard]] std::vector<Tick> decades_of_both_signs(int labels) const;
    [[nodiscard]] bool within(double value) const noexcept;

    Scale scale_;
    double linear_;
    double begin_ = 0.0, end_ = 1.0;  ///< images of the ends
};

/// "0.25", "−6·10⁷", "2·10⁻⁸": a number as short as `step`, the distance to the next one, allows.
[[nodiscard]] std::string tick_label(double value, double step);
/// "10⁻⁶"; ±1 and ±10 as such.
[[nodiscard]] std::string power_of_ten(int exponent, bool negative = false);

}  // namespace cvtflow::tools
