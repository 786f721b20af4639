#pragma once
/// Selection of the pins whose tips are computed: those that may touch within some steps, eight side by side from any pin on.
/// (model/EQUATIONS.md section 11)

#include <algorithm>
#include <cmath>

#include "model/force/sheave_motion.hpp"
#include "model/rigid/tip_motion.hpp"

namespace cvtflow::model {
namespace {

/// Steps for which near pins are found at once: what they cost each time is more than the pins that a longer time adds.
constexpr double steps_ahead = 4.0;
/// Upper bound of a free tip's speed towards its sheave, less that of the middle of its pin [m/s].
constexpr double unseen_speed = 1.0;

/// Bounds of a pulley that decide which pins may touch.
struct PulleyBounds {
    double x, y;       ///< axis of the sheave at -z [m]
    double low, high;  ///< planes of both flanks, for the middle of the longest pin [m]
    double apart;      ///< upper bound of the distance of both axes [m]
    double tilt;       ///< upper bound of both tilts [rad]

    PulleyBounds(const RigidCoefficients& c, const SheaveMotion& at_low, const SheaveMotion& at_high) noexcept
        : x(at_low.x),
          y(at_low.y),
          low(at_low.z + c.half_longest),
          high(at_high.z - c.half_longest),
          apart(std::abs(at_low.x - at_high.x) + std::abs(at_low.y - at_high.y)),
          tilt(std::max(std::abs(at_low.tilt_x) + std::abs(at_low.tilt_y), std::abs(at_high.tilt_x) + std::abs(at_high.tilt_y))) {}
};

/// Upper bound of the depth of the tips of pins i … i + 7 until a time [s] later [m]: the sphere nearest to the axis against the flank
/// nearest to the pin.
[[nodiscard]] inline PinLanes depth_bound(const RigidCoefficients& c, const PulleyBounds (&pulleys)[2], double later,
                                          const PinColumns& columns, int i) noexcept {
    constexpr int W = pin_width;
    using V = PinLanes;
    const double rounding = 1e-6 * (c.middle + c.touching_radius);  // more than that of floats at these distances [m]
    const Plane middle = read(columns.position.middle, i), end = read(columns.position.end, i), bend = read(columns.position.bend, i);
    const auto of = [&](double PulleyBounds::*number) {
        return select_greater<W>(middle.x, V(c.middle), V(pulleys[1].*number), V(pulleys[0].*number));
    };
    const auto size = [](const Plane& v) { return abs(v.x) + abs(v.y); };
    const Plane behind = read(columns.line.direction, i - 1), ahead = read(columns.line.direction, i);
    const Plane axis{of(&PulleyBounds::x), of(&PulleyBounds::y)}, apart = V(0.5) * read(columns.rolling.offset, i);
    const Plane arm = (middle - axis) + V(c.bend_lever) * bend;
    const Plane front = arm + apart - V(c.outward) * turned(behind), rear = arm - apart - V(c.outward) * turned(ahead);
    const V radius = sqrt(smaller<W>(dot(front, front), dot(rear, rear))), tilt = of(&PulleyBounds::tilt);
    const V rise =
        V(c.outward / c.half_length) * (size(end) + V(c.bend_slope) * size(bend)) + V(0.5) * abs(read(columns.position.slide, i));
    const V z = read(columns.position.z, i), low = z - of(&PulleyBounds::low), high = of(&PulleyBounds::high) - z;
    const V beside = V(c.lever) * size(end) + of(&PulleyBounds::apart), off = larger<W>(abs(low), abs(high)) + V(c.radius * c.cosine);
    const V a = radius - beside - tilt * (off + rise) - V(c.touching_radius), h = smaller<W>(low, high) - rise - tilt * (radius + beside);
    const V inwards = positive_part<W>(-dot(arm, read(columns.velocity.middle, i)) / radius), aside = abs(read(columns.velocity.z, i));
    const V closer = V(later) * (V(c.sine) * inwards + V(c.cosine) * aside + V(unseen_speed));
    return V(rounding) + closer - (V(c.sine) * a + V(c.cosine) * h);
}

/// Sets `near` > 0 for pins that may touch until a time [s] later: those that pressed in the last step, and those that are not certainly
/// free; at an instant (0) the latter alone.
inline void find_near_pins(const RigidCoefficients& c, const SheaveMotion* sheaves, double later, PinColumns& columns) noexcept {
    constexpr int W = pin_width;
    using V = Lanes<W>;
    const PulleyBounds pulleys[] = {{c, sheaves[0], sheaves[1]}, {c, sheaves[2], sheaves[3]}};
    const V one(1.0), none(0.0);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        V most = none;
        for (const PinReal* normal : columns.tip.normal) most = larger<W>(most, read(normal, i));
        V near = later > 0.0 ? select_greater<W>(most, none, one, none) : none;
        if (!all_at_most<W>(one - near, 0.0)) near = larger<W>(near, depth_bound(c, pulleys, later, columns, i));
        write(columns.tip.near, i, near);
    }
    wrap(columns, columns.tip.near);
}

/// Whether none of eight pins is near.
[[nodiscard, gnu::always_inline]] inline bool none_near(const PinReal* near, int first) noexcept {
    return all_at_most<pin_width>(read(near, first), 0.0);
}

/// First near pin after at least seven that are not near, so that blocks that begin there do not overlap; -1: none.
[[nodiscard]] inline int first_near_pin(const PinReal* near, int pins) noexcept {
    if (pins < 2 * rigid_lanes) return -1;
    int free = 0;
    for (int k = 0; k < pins + rigid_lanes;) {
        const int pin = k < pins ? k : k - pins;
        const bool none = none_near(near, pin);
        if (near[pin] > 0.0 && free >= rigid_lanes - 1) return pin;
        free = near[pin] > 0.0 ? 0 : free + (none ? rigid_lanes : 1);
        k += none ? rigid_lanes : 1;
    }
    return -1;
}

/// Sets the blocks that have all near pins.
inline void choose_blocks(PinColumns& columns) noexcept {
    const PinReal* near = columns.tip.near;
    const int pins = columns.pins(), begin = first_near_pin(near, pins);
    PinReal* next = columns.tip.blocks + 1;
    for (int k = 0; k < pins;) {
        const int at = std::max(begin, 0) + k, pin = at < pins ? at : at - pins;
        const bool skip = begin >= 0 && !(near[pin] > 0.0);
        k += skip && !none_near(near, pin) ? 1 : rigid_lanes;
        if (!skip) *next++ = static_cast<PinReal>(pin + 1);
    }
    *next = PinReal(0);
}

/// Calls visit(block) for all blocks.
inline void over_blocks(const PinColumns& columns, const auto& visit) noexcept {
    const PinReal* const first = columns.tip.blocks + 1;
    for (const PinReal* at = first; *at > 0.0; ++at) {
        const int pin = static_cast<int>(*at) - 1, next = static_cast<int>(at[1] > 0.0 ? at[1] : *first) - 1;
        visit(PinBlock{pin, std::min(rigid_lanes, next > pin ? next - pin : next - pin + columns.pins())});
    }
}

/// Copies behind the last pin become the numbers of the first pins. @param count [≤ lanes, ≤ pins]
inline void unwrap(const PinColumns& columns, const RowRange<PinReal>& rows, int count) noexcept {
    const auto copied = first_lanes(count);
    for (PinReal* row = rows.first; count > 0 && row <= rows.last; row += columns.stride())
        write(row, 0, select_greater<pin_width>(copied, 0.0, read(row, columns.pins()), read(row, 0)));
}

/// Finds near pins for the next steps, once those found last were for times that are over. Clears the tips' numbers of pins that are no
/// longer near.
inline void renew_near_pins(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, PinColumns& columns) noexcept {
    PinReal& left = columns.tip.blocks[0];
    if (left < 0.99 * kick.step) {
        left = static_cast<PinReal>(steps_ahead * kick.step);
        find_near_pins(c, sheaves, left, columns);
        over_blocks(columns, [&](const PinBlock& block) {
            for (int k = 0; k < block.count; ++k) {
                const int pin = (block.first + k) % columns.pins();
                if (columns.tip.near[pin] > 0.0) continue;
                for (const auto& part : columns.tip.written_rows()) columns.clear(part, pin, 1);
            }
        });
        choose_blocks(columns);
    }
    left -= static_cast<PinReal>(kick.step);
}

/// Finds near pins of an instant; sets the tips' numbers to those of pins far from any sheave.
inline void find_near_pins_now(const RigidCoefficients& c, const SheaveMotion* sheaves, PinColumns& columns) noexcept {
    find_near_pins(c, sheaves, 0.0, columns);
    choose_blocks(columns);
    columns.tip.blocks[0] = PinReal(0);
    for (PinReal* depth : columns.tip.depth) std::fill_n(depth, columns.padded() + rigid_lanes, static_cast<PinReal>(far_depth));
    columns.clear_tips();
}

/// Calls press(block) for all blocks. A block that reaches beyond the last pin continues with copies of the first ones.
/// @return number of copies
[[nodiscard]] inline int over_near_pins(const PinColumns& columns, const auto& press) noexcept {
    int beyond = 0;
    over_blocks(columns, [&](const PinBlock& block) {
        if (block.first + block.count > columns.pins()) {
            beyond = block.first + block.count - columns.pins();
            wrap(columns, columns.force.rows());
            wrap(columns, columns.tip.forces());
        }
        press(block);
    });
    return beyond;
}

}  // namespace
}  // namespace cvtflow::model
