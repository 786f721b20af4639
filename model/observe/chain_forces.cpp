
#include "model/observe/chain_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "model/basis/isa.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/kernels/link_lanes.hpp"
#include "model/machine/belt.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] std::size_t place(int number) noexcept { return static_cast<std::size_t>(number); }

/// A state to read, and the forces to write.
struct ForceReading {
    const ChainModel& chain;
    const double* state;
    const LinkContact* contacts;
    ChainForces& forces;

    [[nodiscard]] const Coefficients& coefficients() const noexcept { return chain.coefficients(); }
    [[nodiscard]] const double* link(int number) const noexcept { return state + chain.layout().link_begin(number); }
};

void read_tips(const ForceReading& from, int link) {
    const LinkContact& contact = from.contacts[link];
    const auto copy = [link](const double(&numbers)[tips_per_link], std::vector<double>& to) {
        std::copy_n(numbers, tips_per_link, to.begin() + tips_per_link * link);
    };
    copy(contact.normal, from.forces.tip_normal);
    copy(contact.tangential, from.forces.tip_tangential);
    copy(contact.radial, from.forces.tip_radial);
    copy(contact.sliding, from.forces.tip_sliding);
    copy(contact.power, from.forces.tip_power);
    copy(contact.radius, from.forces.tip_radius);
}

/// @param link its states
[[nodiscard]] LinkColumns<1> columns_of(const double* link) noexcept {
    LinkColumns<1> columns;
    std::copy_n(link, columns.state.size(), columns.state.data());
    columns.frame = link_frame(columns.q(), columns.v());
    return columns;
}

void read_plates(const ForceReading& from, int link) {
    const Coefficients& c = from.coefficients();
    const LinkColumns<1> columns = columns_of(from.link(link));
    const Difference<Lanes<1>> rate(columns.v(), End::front, columns.v(), End::rear);
    const auto read = [&](int plate, const PlateStretch<1>& stretch, const Lanes<1>&) {
        from.forces.plate_tension[place(c.plates.count * link + plate)] = stretch.tension[0];
        return Zero{};
    };
    NoBooks none;
    (void)pack_force<1>(c.plates, pack_place(columns.q(), columns.frame, Lanes<1>(c.kind(link).free_length)), {rate, columns.frame},
                        columns.frame, none, read);
}

/// The joint of pin `pin`, between the links before and behind it.
void read_joint(const ForceReading& from, int pin) {
    const Coefficients& c = from.coefficients();
    const LinkColumns<1> before = columns_of(from.link(c.layout.previous(pin))), after = columns_of(from.link(pin));
    const auto pins = joint_place(c.joint, before.frame, after.frame, {before.q(), End::front, after.q(), End::rear},
                                  {before.v(), End::front, after.v(), End::rear});
    NoBooks none;
    const auto at_point = [&](int point) -> std::array<Lanes<1>, 3> {
        const auto motion = joint_motion<1>(c.joint, pins, AxisPoint<1>(c.joint_points, point));
        const Lanes<1> normal = normal_force<1>(c.joint, Lanes<1>(c.joint_points.weight[place(point)]), motion).normal;
        const Lanes<1> friction_per_speed = rolling_friction<1>(c.joint, motion, normal, none);
        return {normal, friction_per_speed * motion.slip, friction_per_speed * motion.axial};
    };
    std::array<Lanes<1>, 3> total;
    pairwise_sum<1>(c.joint_points.count, c.joint_points.width, at_point, total);
    from.forces.joint_normal[place(pin)] = total[0][0];
    from.forces.joint_friction[place(pin)] = -total[1][0];
    from.forces.joint_axial[place(pin)] = -total[2][0];
}

/// Second derivative of the axis in the middle: P_2'' = 3, P_3''(0) = 0. With EI and the axial strain 2e/ℓ_p.
void read_halves(const ForceReading& from, int link) {
    const Coefficients& c = from.coefficients();
    const double* q = from.link(link);
    const LinkFrame frame = link_frame(q, q + link_layout.link_size());
    for (const End end : {End::rear, End::front}) {
        const std::size_t half = place(2 * link + static_cast<int>(end));
        const double longer = c.longer.empty() ? 0.0 : lengths_at(c, link)[static_cast<std::size_t>(end)];
        from.forces.half_axial[half] = 0.5 * c.extension.stiffness * (q[link_layout.e(end)] - longer);  // k = 4EA/ℓ_p
        const std::size_t spring = place(static_cast<int>(end) * (axis_order - 1));  // k = 144 EI/ℓ_p³: M = 12 EI x_2/ℓ_p² = k ℓ_p x_2/12
        const double arm = c.half_length / 6.0;
        const double x = q[link_layout.x(end, 2)], y = q[link_layout.y(end, 2)];
        from.forces.bending_travel[half] = c.travel.stiffness[spring] * arm * (x * frame.tx + y * frame.ty);
        from.forces.bending_height[half] = c.height.stiffness[spring] * arm * (y * frame.tx - x * frame.ty);
    }
}

void read_forces(const ForceReading& from) {
    const Coefficients& c = from.coefficients();
    for (int link = 0; link < c.layout.links; ++link) {
        read_plates(from, link);
        read_tips(from, link);
        read_joint(from, link);
        read_halves(from, link);
    }
}

[[nodiscard]] std::size_t at_entry(int number) noexcept { return static_cast<std::size_t>(number); }

struct PlaneVector {
    double x, y;
};

[[nodiscard]] PlaneVector plane(const auto& rows, int entry) noexcept { return {rows.x[entry], rows.y[entry]}; }

void show_tips(const auto& now, int link, ChainForces& forces) {
    const auto& rows = now.columns.tip;
    for (int tip = 0; tip < tips_per_link; ++tip) {
        const std::size_t n = at_entry(tips_per_link * link + tip);
        forces.tip_normal[n] = now.of_tip(rows.normal, link, tip);
        forces.tip_tangential[n] = -now.of_tip(rows.tangential, link, tip);
        forces.tip_radial[n] = now.of_tip(rows.sheave_outward, link, tip);
        const double round = now.of_tip(rows.tangential, link, tip), flank = now.of_tip(rows.radial, link, tip);
        const double friction = std::sqrt(round * round + flank * flank), grip = now.of_tip(rows.grip, link, tip);
        forces.tip_sliding[n] = grip > 0.0 ? friction / grip : 0.0;
        forces.tip_power[n] = friction * forces.tip_sliding[n];
        forces.tip_radius[n] = now.of_tip(rows.radius, link, tip);
    }
    for (int end = 0; end < 2; ++end) {  // both tips press on a half, whose middle carries the mean
        const double minus = now.of_tip(rows.sheave_axial, link, 2 * end), plus = now.of_tip(rows.sheave_axial, link, 2 * end + 1);
        forces.half_axial[at_entry(2 * link + end)] = -0.5 * (std::abs(minus) + std::abs(plus));
    }
}

/// The pack's tension and yaw moment, shared by its two lumped plates.
void show_plates(const auto& now, int link, ChainForces& forces) {
    const auto& columns = now.columns;
    const PlaneVector twist = plane(columns.link.twist, link), t = plane(columns.line.direction, link);
    const double tension = columns.plate.tension[link], yaw = -(twist.x * t.x + twist.y * t.y);
    const double lever = std::sqrt(now.model.coefficients().plate_square), difference = lever > 0.0 ? yaw / lever : 0.0;
    forces.plate_tension[at_entry(2 * link)] = 0.5 * (tension - difference);
    forces.plate_tension[at_entry(2 * link + 1)] = 0.5 * (tension + difference);
}

/// Forces by which the links press the halves of a pin together, across and along the bisector of their pitch lines.
void show_joint(const auto& now, int pin, ChainForces& forces) {
    const auto& columns = now.columns;
    const PlaneVector before = plane(columns.link.pull, pin - 1), after = plane(columns.link.pull, pin);
    const PlaneVector bisector = plane(columns.rolling.bisector, pin), half{0.5 * (before.x + after.x), 0.5 * (before.y + after.y)};
    forces.joint_normal[at_entry(pin)] = std::max(0.0, -(half.x * bisector.x + half.y * bisector.y));
    forces.joint_friction[at_entry(pin)] = -(bisector.x * half.y - bisector.y * half.x);
}

/// Zeros for all forces.
void clear(const ChainModel& chain, ChainForces& forces) {
    const std::size_t links = place(chain.layout().links);
    forces.plates_per_link = plates_per_link(chain);
    for (auto* list :
         {&forces.tip_normal, &forces.tip_tangential, &forces.tip_radial, &forces.tip_sliding, &forces.tip_power, &forces.tip_radius})
        list->assign(tips_per_link * links, 0.0);
    for (auto* list : {&forces.bending_travel, &forces.bending_height, &forces.half_axial}) list->assign(2 * links, 0.0);
    for (auto* list : {&forces.joint_normal, &forces.joint_friction, &forces.joint_axial}) list->assign(links, 0.0);
    forces.plate_tension.assign(place(forces.plates_per_link) * links, 0.0);
}

}  // namespace

int plates_per_link(const ChainModel& chain) noexcept { return chain.coefficients().plates.count; }

void observe_forces(const ChainModel& chain, const double* state, const LinkContact* contacts, ChainForces& forces) {
    clear(chain, forces);
    const ForceReading reading{chain, state, contacts, forces};
    read_forces(reading);
}

/// Bending moments, and friction between the halves of a pin along its length, do not exist there and stay zero.
template <class Real>
void observe_forces(const ChainModel& chain, const RigidInstantOf<Real>& now, ChainForces& forces) {
    clear(chain, forces);
    for (int link = 0; link < chain.layout().links; ++link) {
        if (chain.layout().pulley_size != 0) show_tips(now, link, forces);
        show_plates(now, link, forces);
        show_joint(now, link, forces);
    }
}
template void observe_forces(const ChainModel& chain, const RigidInstantOf<double>& now, ChainForces& forces);
template void observe_forces(const ChainModel& chain, const RigidInstantOf<float>& now, ChainForces& forces);

namespace {

/// Line from a pin's middle to that of the next one.
struct PitchLine {
    Point along;     ///< t
    double turning;  ///< θ' [rad/s]
};

/// Offset u from the rear half R to the front half L of the link before. (model/EQUATIONS.md section 10)
struct Reach {
    Point offset, rate;  ///< u [m], [m/s]
};

/// Offset of halves that roll on each other, a function of the angle between the links.
/// @param diameter 2ρ, arm c_a [m]
[[nodiscard]] Reach rolling(double diameter, double arm, const PitchLine& before, const PitchLine& after) noexcept {
    const Point s = before.along + after.along;
    const double inverse = 1.0 / std::sqrt(s.x * s.x + s.y * s.y);
    const Point b = inverse * s;
    const double wide = diameter * inverse, stretch = wide - arm;
    const double xx = stretch - wide * b.x * b.x, xy = -(wide * b.x * b.y), yy = stretch - wide * b.y * b.y;  // ∂u/∂s
    const Point rate{-(before.turning * before.along.y + after.turning * after.along.y),
                     before.turning * before.along.x + after.turning * after.along.x};
    return {stretch * s, {xx * rate.x + xy * rate.y, xy * rate.x + yy * rate.y}};
}

/// Reads the coordinates of a pin in a state.
struct PinReading {
    const ChainLayout& at;
    const double* state;

    [[nodiscard]] const double* q(int pin) const noexcept { return state + at.link_begin(pin); }
    [[nodiscard]] Point middle(int pin, int rate) const noexcept {
        const double* from = q(pin) + rate * at.link_size();
        return {from[at.x(End::rear, 0)], from[at.y(End::rear, 0)]};
    }
    [[nodiscard]] PitchLine line(int pin) const noexcept {
        const Point step = middle(at.next(pin), 0) - middle(pin, 0), rate = middle(at.next(pin), 1) - middle(pin, 1);
        const double inverse = 1.0 / std::sqrt(step.x * step.x + step.y * step.y);
        const Point t = inverse * step;
        return {t, (t.x * rate.y - t.y * rate.x) * inverse};
    }
};

void copy_half(const PinReading& from, const Coefficients& c, int pin, End end, const ChainLayout& to, double* link) {
    const Reach r = rolling(c.joint.diameter, c.joint.arm, from.line(from.at.previous(pin)), from.line(pin));
    const double side = end == End::rear ? -0.5 : 0.5;
    for (int rate = 0; rate < 2; ++rate) {
        const double* source = from.q(pin) + rate * from.at.link_size();
        double* target = link + rate * to.link_size();
        for (int m = 0; m < from.at.lateral(); ++m) {
            target[to.x(end, m)] = source[from.at.x(end, m)];
            target[to.y(end, m)] = source[from.at.y(end, m)];
        }
        target[to.z(end)] = source[from.at.z(end)] + side * source[from.at.e(End::rear)];
        target[to.e(end)] = 0.0;
        const Point reach = rate == 0 ? r.offset : r.rate;
        target[to.x(end, 0)] = target[to.x(end, 0)] - c.plate_bow * source[from.at.x(end, 2)] + side * reach.x;
        target[to.y(end, 0)] = target[to.y(end, 0)] - c.plate_bow * source[from.at.y(end, 2)] + side * reach.y;
    }
}

}  // namespace

ChainLayout halves_layout(ChainLayout layout) noexcept {
    layout.rigid = false;
    return layout;
}

void halves_of(const Coefficients& coefficients, const double* state, std::vector<double>& halves) {
    const ChainLayout to = halves_layout(coefficients.layout);
    if (!coefficients.layout.rigid) return halves.assign(state, state + to.pulley_begin());
    halves.resize(static_cast<std::size_t>(to.pulley_begin()));
    const PinReading from{coefficients.layout, state};
    for (int link = 0; link < to.links; ++link) {
        double* block = halves.data() + to.link_begin(link);
        copy_half(from, coefficients, link, End::rear, to, block);
        copy_half(from, coefficients, to.next(link), End::front, to, block);
    }
}

}  // namespace cvtflow::model
