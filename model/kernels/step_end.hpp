#pragma once
/// Links at the middle and at the end of a leapfrog's step. The end is one pass over them: their state, slopes by differences, soundness.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "model/contact/friction_stage.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

/// A LinkAdvance.
template <int P>
void advance_links(const double* from, const double* along, double by, double* to, int links) noexcept {
    constexpr int block = 2 * link_layout<P>.link_size();
    static_assert(block % native_lanes == 0);
    const Lanes<native_lanes> factor(by);
    for (int link = 0; link < links; ++link, from += block, along += block, to += block) {
        for (int k = 0; k < block; k += native_lanes)
            (load<native_lanes>(from + k) + factor * load<native_lanes>(along + k)).copy_to(to + k);
    }
}

/// The block of one link whose velocities at the end are there, but for those that they count from.
/// @param sound becomes 0 where a number is not below `above`   @param above [m, m/s]
template <class Number, int size, int W>
inline void end_block(StepEndOf<Number> end, int link, const Lanes<W>& above, Lanes<W>& sound) noexcept {
    static_assert(size % W == 0);
    const Lanes<W> step(end.step), half(0.5 * end.step), none(0.0);
    const auto check = [&](const Lanes<W>& numbers) { sound = select_greater<W>(above, abs(numbers), sound, none); };
    const int begin = link * 2 * size;
    for (int k = begin; k < begin + size; k += W) {
        Lanes<W> velocity = load<W>(end.end + size + k);
        if constexpr (std::is_same_v<Number, float>) {
            velocity += load<W>(end.counted_from + size + k);
            velocity.copy_to(end.end + size + k);
        }
        const Lanes<W> before = load<W>(end.start + size + k), place = load<W>(end.start + k) + half * (before + velocity);
        place.copy_to(end.end + k);
        check(velocity);
        check(place);
        if (end.secants == nullptr) continue;
        velocity.copy_to(end.secants + k);
        ((velocity - before) / step).copy_to(end.secants + size + k);
    }
}

template <int W, int size>
inline void store_velocities(const Lanes<W>* rows, double* blocks, int link, int count) noexcept {
    std::array<double*, W> to{};
    for (int lane = 0; lane < W; ++lane) to[static_cast<std::size_t>(lane)] = blocks + (2 * (link + lane) + 1) * size;
    store_rows<W, size>(rows, to, count);
}

/// Velocities at the end of `count` links from `link` on, W side by side, to their blocks.
template <int W, int size>
inline void turn_velocities(StepEndOf<double> end, int link, int count) noexcept {
    std::array<Lanes<W>, size> rows;
    for (int row = 0; row < size; ++row) rows[static_cast<std::size_t>(row)] = load<W>(end.velocity + row * end.stride + link);
    store_velocities<W, size>(rows.data(), end.end, link, count);
}
template <int W, int size>
inline void turn_velocities(StepEndOf<float> end, int link, int count) noexcept {
    std::array<Lanes<W / 2>, size> low, high;
    for (std::size_t row = 0; row < size; ++row) {
        const Lanes<W> both = widen<W>(load<singles<W>>(end.velocity + static_cast<std::ptrdiff_t>(row) * end.stride + link));
        low[row] = both.low;
        high[row] = both.high;
    }
    store_velocities<W / 2, size>(low.data(), end.end, link, std::min(count, W / 2));
    if (count > W / 2) store_velocities<W / 2, size>(high.data(), end.end, link + W / 2, count - W / 2);
}

/// @return whether all numbers of the state are within the limit
template <class Number, int P>
[[nodiscard]] bool end_links(const StepEndOf<Number>& given, int links) noexcept {
    const StepEndOf<Number> end = given;  // a copy: the compiler then knows that stores through its pointers do not change them
    constexpr int W = std::is_same_v<Number, float> ? native_floats : native_lanes, size = link_layout<P>.link_size();
    constexpr int narrow = std::min(native_lanes, 4);  // a divisor of every link's size
    const Lanes<narrow> above(std::nextafter(end.limit, std::numeric_limits<double>::infinity()));
    Lanes<narrow> sound(1.0);
    for (int group = 0; group < links; group += W) {
        const int count = std::min(W, links - group);
        turn_velocities<W, size>(end, group, count);
        for (int lane = 0; lane < count; ++lane) end_block<Number, size>(end, group + lane, above, sound);
    }
    return sum(sound) == narrow;
}

}  // namespace
}  // namespace cvtflow::model
