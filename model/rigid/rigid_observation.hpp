#pragma once
/// Sums over rigid pins and their tips that an observation needs, from columns whose forces are known. (model/EQUATIONS.md section 9)

#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Sums over the pins of each pulley.
class PulleySum {
public:
    /// @param second 1 for pins of the driven shaft, else 0
    [[gnu::always_inline]] void add(const PinLanes& second, const PinLanes& terms) noexcept {
        const PinLanes there = second * terms;
        driven_ += there;
        driving_ += terms - there;
    }
    [[nodiscard]] std::array<double, 2> values() const noexcept { return {total(driving_), total(driven_)}; }

private:
    PinLanes driving_{0.0}, driven_{0.0};
};

/// Largest normal force of the tips of link i [N].
[[nodiscard, gnu::always_inline]] inline PinLanes pressing(const PinColumns& columns, int i) noexcept {
    const auto of = [&](int tip, int pin) { return read(columns.tip.normal[tip], pin); };
    return larger<pin_width>(larger<pin_width>(of(2, i), of(3, i)), larger<pin_width>(of(0, i + 1), of(1, i + 1)));
}

/// Creep of tips along the circumference.
struct CreepSum {
    PulleySum hold, drag;
    PinLanes power{0.0};

    [[gnu::always_inline]] void add(const PinColumns& columns, int tip, int i, const PinLanes& present, const PinLanes& second) noexcept {
        const PinLanes grip = present * read(columns.tip.grip[tip], i), radius = read(columns.tip.radius[tip], i),
                       around = present * read(columns.tip.tangential[tip], i);
        hold.add(second, grip * radius * radius);
        drag.add(second, -(radius * around));
        power += around * around / larger<pin_width>(grip, PinLanes(1e-30));
    }
};

/// A pin counts for its pulley if both links that it joins touch, a link for its strand if neither it nor a neighbour does.
inline void observe_pins(const RigidCoefficients& c, double lead, const PinColumns& columns, RigidSums& sums) noexcept {
    const PinLanes no(0.0), one(1.0), distance(2.0 * c.middle);
    PinSum speed(columns), touching(columns);
    PulleySum radius, turning, pins, tension, links;
    CreepSum creep;
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes here = present(columns.pins(), i);
        const Plane place = rounded(read(columns.state_position.middle, i));
        const Plane v = rounded(read(columns.state_velocity.middle, i)) - PinLanes(lead) * read(columns.acceleration.middle, i);
        const PinLanes second = select_greater<pin_width>(place.x, PinLanes(c.middle), one, no);
        speed.add(here, sqrt(dot(v, v)));
        const PinLanes own = pressing(columns, i), behind = pressing(columns, i - 1), ahead = pressing(columns, i + 1);
        const PinLanes held = select_greater<pin_width>(smaller<pin_width>(own, behind), no, here, no);
        const Plane arm{place.x - second * distance, place.y};
        const PinLanes square = dot(arm, arm);
        radius.add(second, held * sqrt(square));
        turning.add(second, held * (cross(arm, v) / square));
        pins.add(second, held);
        const PinLanes nearest = larger<pin_width>(own, larger<pin_width>(behind, ahead));
        const PinLanes free = select_greater<pin_width>(nearest, no, no, here), below = select_greater<pin_width>(no, place.y, one, no);
        tension.add(below, free * (read(columns.plate.tension, i) - read(columns.damping.stretch, i)));
        links.add(below, free);
        for (int tip = 0; tip < rigid_tips; ++tip) {
            touching.add(here, select_greater<pin_width>(read(columns.tip.normal[tip], i), no, one, no));
            creep.add(columns, tip, i, here, second);
        }
    }
    sums = {speed.value(),  radius.values(),  turning.values(),    pins.values(),       tension.values(),
            links.values(), touching.value(), creep.hold.values(), creep.drag.values(), total(creep.power)};
}

}  // namespace
}  // namespace cvtflow::model
