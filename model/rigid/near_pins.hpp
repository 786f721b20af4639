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

/// Sixteen pins and the nearness of their tips to a sheave.
class PinNearness {
    static constexpr int W = rigid_singles;
    using V = Lanes<W>;
    using PlaneV = PlaneOf<W>;

public:
    PinNearness(const RigidColumns& columns, const PinBlocks<W>::Blocks& blocks) noexcept : pins_(columns, blocks) {}

    /// Upper bound of the depth of each pin's tips until a time [s] later [m]: the sphere nearest to the axis against the flank nearest to
    /// the pin.
    [[nodiscard, gnu::always_inline]] DoublesOf<W> bound(const RigidCoefficients& c, const PulleyBounds (&pulleys)[2],
                                                         double later) const noexcept {
        const RigidRows& columns = pins_.columns();
        const double rounding = 1e-6 * (c.middle + c.touching_radius);  // more than that of floats at these distances [m]
        const PlaneV middle = read_rounded(columns.position.middle), end = read_rounded(columns.position.end),
                     bend = read_rounded(columns.position.bend);
        const auto of = [&](double PulleyBounds::*number) {
            return select_greater<W>(middle.x, V(c.middle), V(pulleys[1].*number), V(pulleys[0].*number));
        };
        const auto size = [](const PlaneV& v) { return abs(v.x) + abs(v.y); };
        const PlaneV axis{of(&PulleyBounds::x), of(&PulleyBounds::y)}, apart = V(0.5) * read_rounded(columns.rolling.offset);
        const PlaneV arm = (middle - axis) + V(c.bend_lever) * bend;
        const PlaneV front = arm + apart + V(c.outward) * outward(-1), rear = arm - apart + V(c.outward) * outward(0);
        const V radius = sqrt(smaller<W>(dot(front, front), dot(rear, rear))), tilt = of(&PulleyBounds::tilt);
        const V rise = V(c.outward / c.half_length) * (size(end) + V(c.bend_slope) * size(bend)) +
                       V(0.5) * abs(convert<W>(pins_.read(columns.position.slide)));
        const V z = convert<W>(pins_.read(columns.position.z)), low = z - of(&PulleyBounds::low), high = of(&PulleyBounds::high) - z;
        const V beside = V(c.lever) * size(end) + of(&PulleyBounds::apart), off = larger<W>(abs(low), abs(high)) + V(c.radius * c.cosine);
        const V a = radius - beside - tilt * (off + rise) - V(c.touching_radius);
        const V h = smaller<W>(low, high) - rise - tilt * (radius + beside);
        const V inwards = positive_part<W>(-dot(arm, read_rounded(columns.velocity.middle)) / radius),
                aside = abs(convert<W>(pins_.read(columns.velocity.z)));
        const V closer = V(later) * (V(c.sine) * inwards + V(c.cosine) * aside + V(unseen_speed));
        return widened<W>(V(rounding) + closer - (V(c.sine) * a + V(c.cosine) * h));
    }

private:
    [[nodiscard, gnu::always_inline]] PlaneV read_rounded(const PlaneRow& rows, int offset = 0) const noexcept {
        return convert<W>(pins_.read(rows, offset));
    }
    [[nodiscard, gnu::always_inline]] PlaneV outward(int line) const noexcept {
        const PlaneV t = read_rounded(pins_.columns().line.direction, line);
        return {t.y, -t.x};
    }

    PinBlocks<W> pins_;
};

/// Sets `near` > 0 for pins that may touch until a time [s] later: those that pressed in the last step, and those that are not certainly
/// free; at an instant (0) the latter alone.
inline void find_near_pins(const RigidCoefficients& c, const SheaveMotion* sheaves, double later, RigidColumns& columns) noexcept {
    const PulleyBounds pulleys[] = {{c, sheaves[0], sheaves[1]}, {c, sheaves[2], sheaves[3]}};
    const PinLanes one(1.0), none(0.0);
    const auto pressed = [&](int i) {
        PinLanes most = none;
        for (const Row normal : columns.tip.normal) most = larger<rigid_lanes>(most, read(normal, i));
        return later > 0.0 ? select_greater<rigid_lanes>(most, none, one, none) : none;
    };
    for (int i = 0; i < columns.padded(); i += 2 * rigid_lanes) {
        const int next = std::min(i + rigid_lanes, columns.padded() - rigid_lanes);
        PinLanes near[2] = {pressed(i), pressed(next)};
        if (!all_at_most<rigid_lanes>(one - smaller<rigid_lanes>(near[0], near[1]), 0.0)) {
            const DoublesOf<rigid_singles> bound =
                PinNearness(columns, {PinBlock{i, rigid_lanes}, PinBlock{next, rigid_lanes}}).bound(c, pulleys, later);
            near[0] = larger<rigid_lanes>(near[0], bound.low), near[1] = larger<rigid_lanes>(near[1], bound.high);
        }
        write(columns.tip.near, i, near[0]);
        write(columns.tip.near, next, near[1]);
    }
    wrap(columns, columns.tip.near);
}

/// Whether none of eight pins is near.
[[nodiscard, gnu::always_inline]] inline bool none_near(const double* near, int first) noexcept {
    return all_at_most<rigid_lanes>(read(near, first), 0.0);
}

/// First near pin after at least seven that are not near, so that blocks that begin there do not overlap; -1: none.
[[nodiscard]] inline int first_near_pin(const double* near, int pins) noexcept {
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
inline void choose_blocks(RigidColumns& columns) noexcept {
    const double* near = columns.tip.near;
    const int pins = columns.pins(), begin = first_near_pin(near, pins);
    double* next = columns.tip.blocks + 1;
    for (int k = 0; k < pins;) {
        const int at = std::max(begin, 0) + k, pin = at < pins ? at : at - pins;
        const bool skip = begin >= 0 && !(near[pin] > 0.0);
        k += skip && !none_near(near, pin) ? 1 : rigid_lanes;
        if (!skip) *next++ = pin + 1;
    }
    *next = 0.0;
}

/// Calls visit(block) for all blocks.
template <class Visit>
inline void over_blocks(const RigidColumns& columns, const Visit& visit) noexcept {
    const double* const first = columns.tip.blocks + 1;
    for (const double* at = first; *at > 0.0; ++at) {
        const int pin = static_cast<int>(*at) - 1, next = static_cast<int>(at[1] > 0.0 ? at[1] : *first) - 1;
        visit(PinBlock{pin, std::min(rigid_lanes, next > pin ? next - pin : next - pin + columns.pins())});
    }
}

/// Copies behind the last pin become the numbers of the first pins. @param count [≤ lanes, ≤ pins]
inline void unwrap(const RigidColumns& columns, const RowRange& rows, int count) noexcept {
    const PinLanes copied = first_lanes(count);
    for (Row row = rows.first; count > 0 && row <= rows.last; row += columns.stride())
        write(row, 0, select_greater<rigid_lanes>(copied, PinLanes(0.0), read(row, columns.pins()), read(row, 0)));
}

/// Finds near pins for the next steps, once those found last were for times that are over. Clears the tips' numbers of pins that are no
/// longer near.
inline void renew_near_pins(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick,
                            RigidColumns& columns) noexcept {
    double& left = columns.tip.blocks[0];
    if (left < 0.99 * kick.step) {
        left = steps_ahead * kick.step;
        find_near_pins(c, sheaves, left, columns);
        over_blocks(columns, [&](const PinBlock& block) {
            for (int k = 0; k < block.count; ++k) {
                const int pin = (block.first + k) % columns.pins();
                if (columns.tip.near[pin] > 0.0) continue;
                for (const RowRange& part : columns.tip.written_rows()) columns.clear(part, pin, 1);
            }
        });
        choose_blocks(columns);
    }
    left -= kick.step;
}

/// Finds near pins of an instant; sets the tips' numbers to those of pins far from any sheave.
inline void find_near_pins_now(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns) noexcept {
    find_near_pins(c, sheaves, 0.0, columns);
    choose_blocks(columns);
    columns.tip.blocks[0] = 0.0;
    for (const Row depth : columns.tip.depth) std::fill_n(depth, columns.padded() + rigid_lanes, far_depth);
    columns.clear_tips();
}

/// Moves the numbers of a block that reached beyond the last pin to the first pins.
inline void unwrap_tips(RigidColumns& columns, int beyond) noexcept {
    unwrap(columns, {columns.tip.depth[0], columns.tip.depth[3]}, beyond);
    for (const RowRange& part : columns.tip.written_rows()) unwrap(columns, part, beyond);
}

/// Calls press(block) for all blocks. A block that reaches beyond the last pin continues with copies of the first ones.
/// @return number of copies
template <class Press>
[[nodiscard]] inline int over_near_pins(const RigidColumns& columns, const Press& press) noexcept {
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
