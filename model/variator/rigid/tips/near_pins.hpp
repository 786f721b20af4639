#pragma once
/// Which pins have their tips computed: those that may touch, eight side by side from wherever they begin. (model/EQUATIONS.md section 11)

#include <algorithm>

#include "model/variator/rigid/tips/pin_blocks.hpp"

namespace cvtflow::model {
namespace {

/// Largest normal force of each pin's tips in the last step [N].
[[nodiscard]] inline PinLanes last_pressing(const RigidColumns& columns, int first) noexcept {
    PinLanes most = read(columns, Column::normal, first);
    for (int tip = 1; tip < rigid_tips; ++tip) most = larger<rigid_lanes>(most, read(columns, Column::normal + tip, first));
    return most;
}

/// First near pin behind at least seven that are not, so that blocks that begin there and end anywhere do not meet; -1: none.
[[nodiscard]] inline int first_near_pin(const double* near, int pins) noexcept {
    if (pins < 2 * rigid_lanes) return -1;
    int free = 0;
    for (int k = 0; k < pins + rigid_lanes; ++k) {
        const int pin = k < pins ? k : k - pins;
        if (near[pin] > 0.0 && free >= rigid_lanes - 1) return pin;
        free = near[pin] > 0.0 ? 0 : free + 1;
    }
    return -1;
}

/// Tips' numbers of pins that are no longer near become zeros; those of a block that reached beyond the last pin belong to the first ones.
inline void finish_near_pins(RigidColumns& columns, int beyond) noexcept {
    constexpr Column last = Column::flank + (rigid_tips - 1);
    columns.unwrap(Column::tip_stiffness_front, Column::tip_rear, beyond);
    columns.unwrap(Column::tip_x, last, beyond);
    const PinLanes now(1.0), no(0.0);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes written = read(columns, Column::written, i), kept = select_greater<rigid_lanes>(written, now, now, no);
        write(columns, Column::written, i, kept);
        if (all_at_most<rigid_lanes>(smaller<rigid_lanes>(written, now) - kept, 0.0)) continue;
        for (int pin = i; pin < std::min(i + rigid_lanes, columns.pins()); ++pin) {
            if (columns[Column::written][pin] != 0.0) continue;
            columns.clear(Column::tip_stiffness_front, Column::tip_rear, pin, 1);
            columns.clear(Column::tip_x, last, pin, 1);
        }
    }
}

/// Tips' numbers of velocities as they are, as of pins that are far from any sheave.
inline void clear_tips(RigidColumns& columns) noexcept {
    const int all = columns.padded() + rigid_lanes;
    for (int tip = 0; tip < rigid_tips; ++tip) std::fill_n(columns[Column::depth + tip], all, far_depth);
    columns.clear(Column::tip_stiffness_front, Column::tip_rear, 0, all);
    columns.clear(Column::tip_x, Column::reach + (rigid_tips - 1), 0, all);
}
/// Those of a block that reached beyond the last pin belong to the first pins.
inline void unwrap_tips(RigidColumns& columns, int beyond) noexcept {
    columns.unwrap(Column::depth, Column::tip_rear, beyond);
    columns.unwrap(Column::tip_x, Column::reach + (rigid_tips - 1), beyond);
}

/// Calls press(block) for blocks that have all near pins. One that reaches beyond the last pin goes on with copies of the first ones.
/// @return how many of those
template <class Press>
[[nodiscard]] inline int over_near_pins(RigidColumns& columns, const Press& press) noexcept {
    const int pins = columns.pins(), begin = first_near_pin(columns[Column::near], pins);
    const double* near = columns[Column::near];
    double* written = columns[Column::written];
    int beyond = 0;
    for (int k = 0; begin >= 0 && k < pins;) {
        const int pin = begin + k < pins ? begin + k : begin + k - pins;
        const bool skip = !(near[pin] > 0.0);
        k += skip ? 1 : rigid_lanes;
        if (skip) continue;
        if (pin + rigid_lanes > pins) {
            beyond = pin + rigid_lanes - pins;
            columns.wrap(Column::force_x, Column::force_bend_y);
            columns.wrap(Column::normal, Column::flank + (rigid_tips - 1));
        }
        for (int lane = pin; lane < pin + rigid_lanes; ++lane) written[lane < pins ? lane : lane - pins] = 2.0;
        press(PinBlock{pin, rigid_lanes});
    }
    for (int i = 0; begin < 0 && i < pins; i += rigid_lanes) {
        std::fill_n(written + i, rigid_lanes, 2.0);
        press(aligned_block(columns, i));
    }
    return beyond;
}

}  // namespace
}  // namespace cvtflow::model
