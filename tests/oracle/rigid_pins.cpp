#include "tests/oracle/rigid_pins.hpp"

#include <cmath>

namespace cvtflow::oracle {

using model::End;

namespace {

Real second_shape(Real xi) { return (3.0L * xi * xi - 1.0L) / 2.0L; }

PitchLine pitch_line(const RigidPin& from, const RigidPin& to) {
    const Vec2 chord = to.middle - from.middle;
    PitchLine line;
    line.length = norm(chord);
    line.t = unit(chord);
    line.n = left_of(line.t);
    line.o = -line.n;
    line.turning = dot(line.n, to.middle_rate - from.middle_rate) / line.length;
    return line;
}

/// Rolling of the halves between two pitch lines.
Rolling rolling_between(const model::Parameters& parameters, const PitchLine& before, const PitchLine& after) {
    const Real arm = Real{parameters.joint.radius} - parameters.half.width / 2.0L;
    const Vec2 both = before.t + after.t, both_rate = before.turning * before.n + after.turning * after.n;
    Rolling rolling;
    rolling.bisector = unit(both);
    rolling.across = 2.0L * parameters.joint.radius / norm(both);
    rolling.along = rolling.across - arm;
    rolling.offset = rolling.along * both;
    rolling.offset_rate = rolling.times(both_rate);
    return rolling;
}

}  // namespace

PinNumbers pin_numbers(const model::Parameters& p) {
    const std::vector<Real> places = plate_places(p);
    const Real count = static_cast<Real>(places.size()), plates = count * p.plate.mass;
    PinNumbers n;
    Real shape_square = 0.0L;
    for (const Real xi : places) {
        n.square += xi * xi / count;
        n.bow += second_shape(xi) / count;
        shape_square += second_shape(xi) * second_shape(xi) / count;
    }
    const Real at_ends = (1.0L - n.bow) * (1.0L - n.bow);
    n.bow_square = (shape_square - n.bow * n.bow) / at_ends;
    n.mass = 2.0L * p.half.mass + plates;
    n.tilt_mass = 2.0L * p.half.mass / 3.0L + plates * n.square;
    n.bend_mass = 8.0L * (2.0L * p.half.mass / 5.0L) / at_ends;
    const Real cosine = std::cos(Real{p.tip.angle}), stiffness = 2.0L * p.chain.young_modulus * p.half.area / p.half.length;
    n.softness = p.tip.hertz * cosine * cosine / stiffness;
    n.end_slope = 2.0L / p.half.length;
    n.bend_factor = 3.0L / (1.0L - n.bow);
    return n;
}

PinChain::PinChain(const System& of) : system(of), numbers(pin_numbers(of.parameters)) {
    for (int i = 0; i < system.layout.links; ++i) line.push_back(pitch_line(pin(i), pin(i + 1)));
    for (int i = 0; i < system.layout.links; ++i)
        rolling.push_back(rolling_between(system.parameters, line[system.layout.previous(i)], line[i]));
}

PinHalf PinChain::half(int i, End end) const {
    const int number = system.layout.wrapped(i);
    const RigidPin& of = pin(number);
    const Rolling& rolls = rolling[number];
    const Real sign = end == End::front ? 1.0L : -1.0L, share = sign / 2.0L;
    return {number,
            end == End::front ? system.layout.previous(number) : number,
            sign,
            of.middle + share * rolls.offset,
            of.middle_rate + share * rolls.offset_rate,
            of.z + share * of.slide,
            of.z_rate + share * of.slide_rate};
}

Vec2 PinChain::end_slope(int i, Real s) const { return numbers.end_slope * (pin(i).end + (s * numbers.bend_factor) * pin(i).bend); }

/// The depth and the normal are those of the parabola that touches the torus of section 6 in the middle of the flank.
TipContact PinChain::tip(const PinHalf& half, int side) const {
    const auto& tip = system.parameters.tip;
    const auto& pulley = system.parameters.pulley;
    const Real sine = std::sin(Real{tip.angle}), cosine = std::cos(Real{tip.angle}), width = system.parameters.half.length;
    const RigidPin& of = pin(half.pin);
    const PitchLine& turns = line[half.line];
    TipContact c{};
    c.shaft = of.middle.x < pulley.centre_distance / 2.0L ? 0 : 1;
    c.side = side;
    c.sheave = model::sheave_body(c.shaft, side);
    c.s = side == 0 ? -1.0L : 1.0L;

    const Vec2 slope = end_slope(half.pin, c.s);
    c.end = in_space(half.at + c.s * of.end + of.bend, half.z + c.s * (width / 2.0L + system.longer_half(half.pin)));
    const Vec3 height = in_space(turns.o, -dot(slope, turns.o)), axis = in_space(slope, 1.0L);
    c.centre = c.end + Real{tip.radius} * (sine * height - c.s * cosine * axis);
    c.centre_turning = (tip.radius * sine) * in_space(turns.t, -dot(slope, turns.t));

    const Vec3 tilt = in_space(system.body[c.sheave].tau, 0.0L);
    c.r = c.centre - flank_origin(system, c.shaft, side);
    const Vec3 l = c.r - cross(tilt, c.r);
    const Vec2 radial = unit(in_plane(l));
    const Real both = Real{pulley.arc_radius} + tip.radius;
    const Real a = norm(in_plane(l)) - pulley.arc_position - tip.radius * sine;
    const Real h = -c.s * (l.z + c.s * tip.radius * cosine);
    c.depth = -(a * sine + h * cosine + (a * a + h * h) / (2.0L * both));
    c.local_normal = in_space((sine + a / both) * radial, -c.s * (cosine + h / both));
    c.normal = c.local_normal + cross(tilt, c.local_normal);
    return c;
}

std::vector<RigidPin> unpack_pins(const model::Parameters& parameters, const model::ChainLayout& layout, std::span<const Real> state) {
    const Real at_ends = 1.0L - pin_numbers(parameters).bow;
    std::vector<RigidPin> pins;
    for (int i = 0; i < layout.links; ++i) {
        const auto q = state.subspan(layout.link_begin(i), layout.link_size());
        const auto v = state.subspan(layout.link_begin(i) + layout.link_size(), layout.link_size());
        const auto plane = [&](std::span<const Real> values, int m) {
            return Vec2{values[layout.x(End::rear, m)], values[layout.y(End::rear, m)]};
        };
        const int z = layout.z(End::rear), slide = layout.e(End::rear);
        pins.push_back({plane(q, 0), plane(q, 1), at_ends * plane(q, 2), plane(v, 0), plane(v, 1), at_ends * plane(v, 2), q[z], q[slide],
                        v[z], v[slide]});
    }
    return pins;
}

std::vector<Real> pin_forces(const System& system, const RigidPinForce& force) {
    const Real at_ends = 1.0L - pin_numbers(system.parameters).bow;
    const Vec2 shape = at_ends * force.bend;
    return {force.middle.x, force.end.x, shape.x, force.middle.y, force.end.y, shape.y, force.z, force.slide};
}

std::vector<Real> pin_inertia(const System& system) {
    const PinNumbers n = pin_numbers(system.parameters);
    const Real shape = (1.0L - n.bow) * (1.0L - n.bow) * n.bend_mass;
    return {n.mass, n.tilt_mass, shape, n.mass, n.tilt_mass, shape, n.mass, n.mass / 4.0L};
}

}  // namespace cvtflow::oracle
