#pragma once
/// From forces to motion: what all forces on a pin add up to, and the step in velocities and coordinates.

#include "model/variator/rigid/rigid_plates.hpp"

namespace cvtflow::model {
namespace {

/// What this step's tips change in the moment on pitch line i, as a force on pin i+1.
[[nodiscard, gnu::always_inline]] inline Plane moment_thrust(const RigidView& columns, int i) noexcept {
    const PinLanes change = read(columns, Column::tip_moment, i) - read(columns, Column::tip_moment_before, i);
    return (change * read(columns, Column::line_inverse, i)) * turned(read_plane(columns, Column::line_x, i));
}

inline void accelerate_pins(const RigidCoefficients& c, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes per_mass(1.0 / c.mass), per_tilt(1.0 / c.tilt_mass), per_slide(1.0 / c.slide_mass), per_bend(1.0 / c.bend_mass);
    Plane last{0.0, 0.0};  // of the eight links before
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane ahead = moment_thrust(columns, i), behind = i == 0 ? moment_thrust(columns, -1) : one_back(last, ahead);
        last = ahead;
        const Plane force = read_plane(columns, Column::force_x, i) + read_plane(columns, Column::tip_x, i) + behind - ahead;
        const PinLanes rubbing = read(columns, Column::rub, i) - read(columns, Column::rub, i - 1);
        write_plane(columns, Column::force_x, i, per_mass * force);
        write(columns, Column::force_z, i, per_mass * (read(columns, Column::force_z, i) + read(columns, Column::tip_z, i) + rubbing));
        write_plane(columns, Column::force_p, i,
                    per_tilt * (read_plane(columns, Column::force_p, i) + read_plane(columns, Column::tip_p, i)));
        write_plane(columns, Column::force_bend_x, i,
                    per_bend * (read_plane(columns, Column::force_bend_x, i) + read_plane(columns, Column::tip_bend_x, i)));
        write(columns, Column::force_slide, i,
              per_slide * (read(columns, Column::force_slide, i) + read(columns, Column::tip_slide, i) + friction_on_slide(columns, i)));
    }
}

inline void drift_pins(double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int k = 0; k < rigid_coordinates; ++k) {
        for (int i = 0; i < columns.padded(); i += rigid_lanes)
            write(columns, Column::x + k, i, read(columns, Column::x + k, i) + step * read(columns, Column::vx + k, i));
    }
}

/// @return ½ v·M v' of the velocities before and after [J]
inline double kick_pins(const RigidCoefficients& c, double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    PinSum energy(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        PinLanes of_pins(0.0);
        for (int k = 0; k < rigid_coordinates; ++k) {
            const PinLanes before = read(columns, Column::vx + k, i), v = before + step * read(columns, Column::force_x + k, i);
            of_pins += (0.5 * c.inertia(k)) * (before * v);
            write(columns, Column::vx + k, i, v);
        }
        energy.add(i, of_pins);
    }
    return energy.value();
}

}  // namespace
}  // namespace cvtflow::model
