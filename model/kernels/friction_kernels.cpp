/// Kernels of a leapfrog's step: the record of contacts, sweeps, and links at the middle and at the end of a step. The end is one pass over
/// them: their state, slopes by differences, soundness.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "model/basis/native_lanes.hpp"
#include "model/contact/sweep_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/link_pass.hpp"

namespace cvtflow::model {
namespace {

/// Advances links: to = from + by · along.
inline void advance_links(const double* from, const double* along, double by, double* to, int links) noexcept {
    constexpr int block = 2 * link_layout.link_size();
    static_assert(block % native_lanes == 0);
    const Lanes<native_lanes> factor(by);
    for (int link = 0; link < links; ++link, from += block, along += block, to += block) {
        for (int k = 0; k < block; k += native_lanes)
            (load<native_lanes>(from + k) + factor * load<native_lanes>(along + k)).copy_to(to + k);
    }
}

/// Completes the block of one link: adds the velocities that those at the end count from.
/// @param sound becomes 0 where a number is not below `above`   @param above [m, m/s]
template <int size, int W>
inline void end_block(StepEnd end, int link, const Lanes<W>& above, Lanes<W>& sound) noexcept {
    static_assert(size % W == 0);
    const Lanes<W> step(end.step), half(0.5 * end.step), none(0.0);
    const auto check = [&](const Lanes<W>& numbers) { sound = select_greater<W>(above, abs(numbers), sound, none); };
    const int begin = link * 2 * size;
    for (int k = begin; k < begin + size; k += W) {
        const Lanes<W> velocity = load<W>(end.end + size + k) + load<W>(end.counted_from + size + k);
        velocity.copy_to(end.end + size + k);
        const Lanes<W> before = load<W>(end.start + size + k), place = load<W>(end.start + k) + half * (before + velocity);
        place.copy_to(end.end + k);
        check(velocity);
        check(place);
        velocity.copy_to(end.secants + k);
        ((velocity - before) / step).copy_to(end.secants + size + k);
    }
}

/// Rows of `count` links from `link` on, at most W, as doubles: use(rows, link, count), of half as many links at a time.
template <int W, std::size_t size, class Use>
inline void in_doubles(const float* from, std::ptrdiff_t stride, int link, int count, const Use& use) noexcept {
    const auto at = [=](std::size_t row) { return from + static_cast<std::ptrdiff_t>(row) * stride + link; };
    std::array<Lanes<W / 2>, size> low, high;
    for (std::size_t row = 0; row < size; ++row) {
        const Lanes<W> both = widen<W>(load<singles<W>>(at(row)));
        low[row] = both.low;
        high[row] = both.high;
    }
    use(low, link, std::min(count, W / 2));
    if (count > W / 2) use(high, link + W / 2, count - W / 2);
}

/// Velocities of `count` links from `link` on to their blocks.
template <int W, std::size_t size>
inline void store_velocities(const std::array<Lanes<W>, size>& rows, double* blocks, int link, int count) noexcept {
    std::array<double*, W> to{};
    for (int lane = 0; lane < W; ++lane) to[static_cast<std::size_t>(lane)] = blocks + (2 * (link + lane) + 1) * static_cast<int>(size);
    store_rows<W, static_cast<int>(size)>(rows.data(), to, count);
}

/// @return whether all numbers of the state are within the limit
[[nodiscard]] inline bool end_links(const StepEnd& given, int links) noexcept {
    const StepEnd end = given;  // a copy: the compiler then knows that stores through its pointers do not change them
    constexpr int W = native_floats, size = link_layout.link_size();
    constexpr int narrow = std::min(native_lanes, 4);  // a divisor of every link's size
    const Lanes<narrow> above(std::nextafter(end.limit, std::numeric_limits<double>::infinity()));
    Lanes<narrow> sound(1.0);
    for (int group = 0; group < links; group += W) {
        const int count = std::min(W, links - group);
        in_doubles<W, size>(end.velocity, end.stride, group, count,
                            [&](const auto& rows, int link, int links_here) { store_velocities(rows, end.end, link, links_here); });
        for (int lane = 0; lane < count; ++lane) end_block<size>(end, group + lane, above, sound);
    }
    return sum(sound) == narrow;
}

/// Reactions of W links on their sheaves to forces on their tips: contributions of a side's first tip, then of its second one, each in the
/// order of the numbers of a SheaveLoad. @param force rows [3 tips_per_link]   @param arms their arms
template <int W>
inline void turn_reactions(const Lanes<W>* force, const double* arms, std::ptrdiff_t stride,
                           std::array<std::array<Lanes<W>, 12>, 2>& reactions) noexcept {
    for (int corner = 0; corner < tips_per_link; ++corner) {
        const Lanes<W>*f = force + 3 * corner, x = load<W>(arms + 3 * corner * stride);
        const Lanes<W> y = load<W>(arms + (3 * corner + 1) * stride), z = load<W>(arms + (3 * corner + 2) * stride);
        Lanes<W>* to = reactions[static_cast<std::size_t>(corner / 2)].data() + corner % 2;
        to[0] = -f[0];
        to[2] = -f[1];
        to[4] = -f[2];
        to[6] = z * f[1] - y * f[2];
        to[8] = x * f[2] - z * f[0];
        to[10] = y * f[0] - x * f[1];
    }
}

/// @param force rows of the links from `link` on, `count` of them
template <int W>
[[gnu::always_inline]] inline void add_reactions(const TipReactions& r, const std::array<Lanes<W>, 3 * tips_per_link>& force, int link,
                                                 int count) noexcept {
    static_assert(sizeof(SheaveLoad) == 12 * sizeof(double));
    std::array<std::array<Lanes<W>, 12>, 2> reactions;
    turn_reactions<W>(force.data(), r.arms + link, r.arms_stride, reactions);
    alignas(64) double turned[2][W][12];
    for (std::size_t tip = 0; tip < 2; ++tip) {
        std::array<double*, W> to{};
        for (int lane = 0; lane < W; ++lane) to[static_cast<std::size_t>(lane)] = turned[tip][lane];
        store_rows<W, 12>(reactions[tip].data(), to, count);
    }
    for (int lane = 0; lane < count; ++lane) {
        if (!touches(r.phases, link + lane)) continue;  // no sum has its load
        double numbers[12];
        std::memcpy(numbers, &r.normal[link + lane].load, sizeof numbers);
        for (int k = 0; k < 12; ++k) numbers[k] = (numbers[k] + turned[0][lane][k]) + turned[1][lane][k];
        std::memcpy(&r.loads[link + lane].load, numbers, sizeof numbers);
        r.loads[link + lane].shaft = r.normal[link + lane].shaft;
    }
}

/// FrictionKernels::react. A free tip has no friction.
inline void react(const TipReactions& r, int links) noexcept {
    constexpr int W = native_floats;
    for (int group = 0; group < links; group += W) {
        const int count = std::min(W, links - group);
        bool any = false;
        for (int link = group; link < group + count; ++link) any |= touches(r.phases, link);
        if (!any) continue;
        in_doubles<W, 3 * tips_per_link>(r.forces, r.stride, group, count,
                                         [&](const auto& force, int link, int links_here) { add_reactions(r, force, link, links_here); });
    }
}

void record(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to, LinkLoad* loads,
            TipSearch* search) noexcept {
    LinkPass(RecordWriter<native_lanes>(friction, range, drift, to, loads, search)).run();
}

}  // namespace

template <>
FrictionKernels friction_kernels<compiled_isa>() noexcept {
    return {record, sweep_links, sweep_powers, end_links, advance_links, react};
}

}  // namespace cvtflow::model
