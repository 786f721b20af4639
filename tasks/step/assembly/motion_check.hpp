#pragma once
/// Whether a link moves as a chain can: the faults that end a run.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// time [s], value [unit of what is limited], limit [the same unit]
inline void report(SegmentResult& verdict, FaultKind kind, double time, int pin, double value, double limit) noexcept {
    if (!verdict.fault) verdict.fault = {kind, time, pin, value, limit};
}

/// Whether all numbers are within ±limit; false for NaN. By their bits, which are in the order of magnitudes: that takes vectors on every
/// instruction set, and every link is checked after every step. numbers [unit of the limit], limit [the same unit, not negative]
[[nodiscard]] inline bool within(const double* numbers, int size, double limit) noexcept {
    constexpr std::uint64_t magnitude = std::numeric_limits<std::uint64_t>::max() >> 1;
    const auto largest = std::bit_cast<std::uint64_t>(limit);
    std::uint64_t beyond = 0;  // its first bit: some difference was negative
    for (int k = 0; k < size; ++k) beyond |= largest - (std::bit_cast<std::uint64_t>(numbers[k]) & magnitude);
    return beyond <= magnitude;
}

/// Faster than sound in steel (5.9 km/s): no chain does that, so the integration has become unstable, long before anything is infinite.
inline constexpr double fastest_pin = 1e4;  // m/s

/// Whether a link's block [q | v] is finite and its motion that of a chain.
inline void check_motion(const Workspace& w, int link, const double* block, SegmentResult& verdict) noexcept {
    const int size = w.layout().link_size();
    if (within(block, size, std::numeric_limits<double>::max()) && within(block + size, size, fastest_pin)) return;
    double largest = 0.0;
    bool finite = true;
    for (int k = 0; k < 2 * size; ++k) finite = finite && std::isfinite(block[k]);
    for (int k = size; k < 2 * size; ++k) largest = std::max(largest, std::abs(block[k]));
    if (!finite) return report(verdict, FaultKind::non_finite, w.step.time + w.step.h, link, 0.0, 0.0);
    report(verdict, FaultKind::blow_up, w.step.time + w.step.h, link, largest, fastest_pin);
}

/// Whether a link's tips are where contact can be described.
inline void check_contact(const Workspace& w, int link, const model::TipProbe& probe, SegmentResult& verdict) noexcept {
    const auto& pulley = w.parameters.pulley;
    const double now = w.step.time + w.step.h;
    bool touching = false;
    for (int tip = 0; tip < model::tips_per_link; ++tip) {
        if (w.tips.phases[static_cast<std::size_t>(model::tips_per_link * link + tip)] == model::Phase::free) continue;
        touching = true;
        if (probe.depth[tip] > w.parameters.tip.deepest)
            report(verdict, FaultKind::penetration, now, link, probe.depth[tip], w.parameters.tip.deepest);
    }
    if (probe.radius < pulley.innermost) report(verdict, FaultKind::left_sheave, now, link, probe.radius, pulley.innermost);
    if (touching && probe.radius > pulley.outermost) report(verdict, FaultKind::left_sheave, now, link, probe.radius, pulley.outermost);
}

/// Whether no link of a segment can have anything that check_motion() finds: a look at all numbers of the step's end at once.
[[nodiscard]] inline bool all_sound(const Workspace& w, const Segment& own) noexcept {
    return within(w.end_state + w.layout().link_begin(own.first), own.size() * w.layout().link_block(), fastest_pin);
}

}  // namespace cvtflow::tasks
