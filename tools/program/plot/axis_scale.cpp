#include "tools/program/plot/axis_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cvtflow::tools {

namespace {

constexpr double margin = 0.04;  ///< of the length, where points set an end

std::string superscript(int number) {
    static constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text;
    for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : digits[c - '0'];
    return text;
}

/// 1, 2 or 5 times a power of ten, not below `least`.
double round_step(double least) {
    const double decade = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * decade >= least * (1.0 - 1e-9)) return factor * decade;
    }
    return 10.0 * decade;
}

/// Plain digits, with the typographic minus.
std::string plain(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", std::abs(value), decimals);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
    }
    return (value < 0.0 && text != "0" ? "−" : "") + text;
}

/// "2", "20", "2·10²".
std::string multiple_of_ten(int digit, int exponent) {
    const std::string number = std::to_string(digit);
    if (exponent == 0 || exponent == 1) return number + (exponent == 1 ? "0" : "");
    return number + "·" + power_of_ten(exponent);
}

}  // namespace

std::string power_of_ten(int exponent, bool negative) {
    const std::string sign = negative ? "−" : "";
    if (exponent == 0) return sign + "1";
    return sign + (exponent == 1 ? "10" : "10" + superscript(exponent));
}

std::string tick_label(double value, double step) {
    if (std::abs(value) < 1e-9 * step) return "0";
    const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-12));
    const int finest = static_cast<int>(std::floor(std::log10(step) + 1e-12));
    if (exponent >= 5 || exponent <= -4) {
        const std::string mantissa = plain(value / std::pow(10.0, exponent), std::max(0, exponent - finest));
        if (mantissa == "1" || mantissa == "−1") return power_of_ten(exponent, value < 0.0);
        return mantissa + "·10" + superscript(exponent);
    }
    return plain(value, std::max(0, -finest));
}

AxisScale::AxisScale(const Axis& axis, const std::vector<double>& values) : scale_(axis.scale), linear_(axis.linear_up_to) {
    if (scale_ == Scale::symlog && !(linear_ > 0.0))
        throw std::invalid_argument("axis '" + axis.label + "': the length of the linear part is not positive");
    double least = INFINITY, largest = -INFINITY;
    for (const double value : values) {
        if (!shows(value)) continue;
        least = std::min(least, forward(value));
        largest = std::max(largest, forward(value));
    }
    if (least > largest) least = 0.0, largest = 1.0;
    if (least == largest && !(axis.from && axis.to)) {
        const double half = scale_ == Scale::linear ? std::max(0.5 * std::abs(least), 1e-12) : 0.5;
        least -= half, largest += half;
    }
    const double length = largest - least;
    begin_ = axis.from && shows(*axis.from) ? forward(*axis.from) : least - margin * length;
    end_ = axis.to && shows(*axis.to) ? forward(*axis.to) : largest + margin * length;
    if (!(end_ > begin_)) throw std::invalid_argument("axis '" + axis.label + "': its ends coincide");
}

bool AxisScale::shows(double value) const noexcept {
    constexpr double largest = 1e300;  // lengths of axes are finite, margins included
    return std::abs(value) <= largest && (scale_ != Scale::logarithmic || value > 0.0);
}

double AxisScale::forward(double value) const noexcept {
    if (scale_ == Scale::linear) return value;
    if (scale_ == Scale::logarithmic) return std::log10(value);
    const double share = std::abs(value) / linear_;
    return std::copysign(share <= 1.0 ? share : 1.0 + std::log10(share), value);
}

double AxisScale::backward(double image) const noexcept {
    if (scale_ == Scale::linear) return image;
    if (scale_ == Scale::logarithmic) return std::pow(10.0, image);
    const double size = std::abs(image);
    return std::copysign(linear_ * (size <= 1.0 ? size : std::pow(10.0, size - 1.0)), image);
}

double AxisScale::place(double value) const noexcept { return (forward(value) - begin_) / (end_ - begin_); }

double AxisScale::value(double place) const noexcept { return backward(begin_ + place * (end_ - begin_)); }

bool AxisScale::within(double value) const noexcept {
    const double at = place(value);
    return at >= -1e-9 && at <= 1.0 + 1e-9;
}

std::vector<Tick> AxisScale::ticks(int labels) const {
    if (scale_ == Scale::linear) return round_numbers(labels);
    if (scale_ == Scale::symlog) return decades_of_both_signs(labels);
    if (end_ - begin_ >= 1.0) return decades(labels);
    std::vector<Tick> ticks = within_a_decade();
    return ticks.size() < 4 ? round_numbers(labels) : ticks;
}

std::vector<Tick> AxisScale::round_numbers(int labels) const {
    const double from = backward(begin_), to = backward(end_);
    const double step = round_step((to - from) / std::max(1, labels));
    std::vector<Tick> ticks;
    const double first = std::ceil(from / step - 1e-9);
    const int count = std::max(4 * labels, 100);  // where numbers are larger than 2^53 steps, the next one may be the same
    for (int k = 0; k < count && first + k <= to / step + 1e-9; ++k) {
        const double number = first + k;
        if (shows(number * step)) ticks.push_back({number * step, tick_label(number * step, step)});
    }
    return ticks;
}

/// 1, 1.5, 2, 3, 5, 7.5 and so on: about as far from one another on a logarithmic axis.
std::vector<Tick> AxisScale::within_a_decade() const {
    std::vector<Tick> ticks;
    for (int exponent = static_cast<int>(std::floor(begin_)); exponent <= end_; ++exponent) {
        const double decade = std::pow(10.0, exponent);
        for (const double digit : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5})
            if (within(digit * decade)) ticks.push_back({digit * decade, tick_label(digit * decade, 0.1 * decade)});
    }
    return ticks;
}

std::vector<Tick> AxisScale::decades(int labels) const {
    const int first = static_cast<int>(std::floor(begin_)), last = static_cast<int>(std::ceil(end_));
    const int stride = std::max(1, static_cast<int>(std::ceil((end_ - begin_) / std::max(1, labels))));
    std::vector<Tick> ticks;
    for (int exponent = first; exponent <= last; ++exponent) {
        const double decade = std::pow(10.0, exponent);
        const bool labelled = ((exponent % stride) + stride) % stride == 0;
        if (within(decade)) ticks.push_back({decade, labelled ? power_of_ten(exponent) : ""});
        for (int digit = 2; digit <= 9 && stride == 1; ++digit) {
            // If there are few decades, 2 and 5 have labels as well.
            const bool has_label = (digit == 2 || digit == 5) && end_ - begin_ < 2.5;
            if (within(digit * decade)) ticks.push_back({digit * decade, has_label ? multiple_of_ten(digit, exponent) : ""});
        }
    }
    return ticks;
}

std::vector<Tick> AxisScale::decades_of_both_signs(int labels) const {
    const int first = static_cast<int>(std::ceil(std::log10(linear_) - 1e-9));
    const int last = static_cast<int>(std::ceil(std::log10(linear_) + std::max(std::abs(begin_), std::abs(end_))));
    const int stride = std::max(1, static_cast<int>(std::ceil((end_ - begin_) / std::max(1, labels))));
    std::vector<Tick> ticks;
    for (const bool negative : {true, false}) {
        for (int step = 0; step <= last - first; ++step) {
            const int exponent = negative ? last - step : first + step;
            const double decade = std::copysign(std::pow(10.0, exponent), negative ? -1.0 : 1.0);
            const bool labelled = (exponent - first) % stride == 0;
            if (within(decade)) ticks.push_back({decade, labelled ? power_of_ten(exponent, negative) : ""});
        }
        if (negative && within(0.0)) ticks.push_back({0.0, "0"});
    }
    return ticks;
}

}  // namespace cvtflow::tools
