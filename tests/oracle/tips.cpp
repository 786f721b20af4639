/// Contact of pin ends and sheaves (EQUATIONS.md, section 6).

#include "tests/oracle/friction.hpp"
#include "tests/oracle/legendre.hpp"
#include "tests/oracle/system.hpp"

#include <algorithm>

namespace cvtflow::oracle {

using model::End;
using model::Phase;

int shaft_of(const System& system, const Link& link) {
    const Real middle = (link.rear.shape[0].x + link.front.shape[0].x) / 2.0L;
    return middle < system.parameters.pulley.centre_distance / 2.0L ? 0 : 1;
}

namespace {

constexpr Vec3 k_axis{0.0L, 0.0L, 1.0L};

}  // namespace

Vec3 flank_offset(const System& system, int shaft, int side) {
    const auto& i = system.parameters.imperfection;
    const Real angle = system.body[model::sheave_body(shaft, side)].phi;
    const Real out = static_cast<int>(i.sheave) == 2 * shaft + side ? Real{i.runout} : 0.0L;
    return {out * std::cos(angle), out * std::sin(angle), shaft == 1 ? Real{i.misalignment} : 0.0L};
}
Vec3 flank_rate(const System& system, int shaft, int side) {
    return system.body[model::sheave_body(shaft, side)].phi_rate * cross(k_axis, flank_offset(system, shaft, side));
}

Vec3 flank_origin(const System& system, int shaft, int side) {
    const Body& sheave = system.body[model::sheave_body(shaft, side)];
    const Real s = side == 0 ? -1.0L : 1.0L, x = shaft == 0 ? 0.0L : Real{system.parameters.pulley.centre_distance};
    return in_space(Vec2{x, 0.0L} + sheave.u, s * system.parameters.half.length / 2.0L + sheave.w) + flank_offset(system, shaft, side);
}
Vec3 origin_rate(const System& system, const TipContact& c) {
    const Body& sheave = system.body[c.sheave];
    return in_space(sheave.u_rate, sheave.w_rate) + flank_rate(system, c.shaft, c.side);
}

Real tip_damping(const model::Parameters& p) {
    const Real anchor = std::sqrt(Real{p.tip.reference_depth}), cubed = anchor * anchor * anchor;
    return damping_of(p.chain.damping_ratio, 1.5L * p.tip.hertz * anchor, p.half.mass) / (p.tip.hertz * cubed);
}

namespace {

/// A force at the flank's origin, whose offset turns with the sheave.
void push_sheave(const System& system, const TipContact& c, Vec3 force, Vec3 moment, Totals& totals) {
    BodyForce& sheave = totals.body[c.sheave];
    sheave.force += force;
    sheave.moment += moment;
    sheave.moment.z += cross(flank_offset(system, c.shaft, c.side), force).z;
}

}  // namespace

void press_sheave(const System& system, const TipContact& c, Real force, Totals& totals) {
    const Vec3 lever = cross(c.r, c.local_normal);
    push_sheave(system, c, -force * c.normal, -force * Vec3{lever.x, lever.y, 0.0L}, totals);
}
void rub_sheave(const System& system, const TipContact& c, Vec3 f, Totals& totals) {
    push_sheave(system, c, -f, -cross(c.r - Real{system.parameters.tip.radius} * c.normal, f), totals);
}

TipContact tip_contact(const System& system, const Link& link, End end, int side) {
    const auto& tip = system.parameters.tip;
    const auto& pulley = system.parameters.pulley;
    const Half& half = link.half(end);
    const Real sine = std::sin(Real{tip.angle});
    const Real cosine = std::cos(Real{tip.angle});
    TipContact c{};
    c.shaft = shaft_of(system, link);
    c.side = side;
    c.sheave = model::sheave_body(c.shaft, side);
    c.s = side == 0 ? -1.0L : 1.0L;

    const Vec2 slope = half.slope_at(c.s);
    c.end = in_space(half.at(c.s), half.z + c.s * (half.length / 2.0L + half.e));
    const Vec3 height = in_space(link.o, 0.0L) - dot(slope, link.o) * k_axis;
    const Vec3 axis = k_axis + in_space(slope, 0.0L);
    c.centre = c.end + Real{tip.radius} * (sine * height - c.s * cosine * axis);
    c.centre_turning = (tip.radius * sine) * (in_space(link.t, 0.0L) - dot(slope, link.t) * k_axis);

    c.r = c.centre - flank_origin(system, c.shaft, side);
    const Vec3 tilt = in_space(system.body[c.sheave].tau, 0.0L);
    const Vec3 l = c.r - cross(tilt, c.r);
    const Real radius = norm(in_plane(l));
    const Vec2 h{radius - (pulley.arc_position - pulley.arc_radius * sine), l.z - c.s * pulley.arc_radius * cosine};
    const Real d = norm(h);
    c.depth = Real{pulley.arc_radius} + tip.radius - d;
    c.local_normal = {h.x / d * (l.x / radius), h.x / d * (l.y / radius), h.y / d};
    c.normal = c.local_normal + cross(tilt, c.local_normal);
    return c;
}

TipSliding tip_sliding(const System& system, const Link& link, End end, const TipContact& c) {
    const Half& half = link.half(end);
    const Body& sheave = system.body[c.sheave];
    const Real radius = system.parameters.tip.radius;
    const Vec3 point = c.centre - radius * c.normal;
    const Vec3 end_rate = in_space(half.rate_at(c.s), half.z_rate + c.s * half.e_rate);
    const Vec3 of_half = end_rate + link.turning * cross(k_axis, point - c.end);
    const Vec3 spin = in_space(sheave.tau_rate, sheave.phi_rate);
    const Vec3 of_sheave = origin_rate(system, c) + cross(spin, c.r - radius * c.normal);
    const Vec3 v = of_half - of_sheave;
    return {v, v - dot(v, c.normal) * c.normal};
}

namespace {

/// S' by the chain rule [m/s].
Vec3 centre_rate(const System& system, const Link& link, const Half& half, const TipContact& c) {
    const auto& tip = system.parameters.tip;
    const Real sine = std::sin(Real{tip.angle});
    const Real cosine = std::cos(Real{tip.angle});
    const Vec2 slope_rate = half.slope_rate_at(c.s);
    const Vec3 end_rate = in_space(half.rate_at(c.s), half.z_rate + c.s * half.e_rate);
    const Vec3 bending = Real{tip.radius} * (-sine * dot(slope_rate, link.o) * k_axis - c.s * cosine * in_space(slope_rate, 0.0L));
    return end_rate + bending + link.turning * c.centre_turning;
}

struct TipTarget {
    const Link& link;
    const Half& half;
    LinkForce& on_link;
    HalfForce& on_half;
};

/// The normal force N along the gradient of the depth.
void push_normal(const System& system, const TipTarget& target, const TipContact& c, Real force) {
    const auto& tip = system.parameters.tip;
    const Real sine = std::sin(Real{tip.angle});
    const Real cosine = std::cos(Real{tip.angle});
    const Vec2 plane = in_plane(c.normal);
    for (int m = 0; m <= target.half.order(); ++m) {
        const Real lever = tip.radius * (2.0L / target.half.length) * legendre_slope(m, c.s);
        const Vec2 per_coordinate = legendre(m, c.s) * plane + lever * ((-sine * c.normal.z) * target.link.o - (c.s * cosine) * plane);
        target.on_half.shape[m] += force * per_coordinate;
    }
    target.on_half.z += force * c.normal.z;
    target.on_half.e += c.s * force * c.normal.z;
    target.on_link.turn(target.link, force * dot(c.normal, c.centre_turning));
}

/// Friction f [N] on the half.
void push_friction(const System& system, const TipTarget& target, const TipContact& c, Vec3 f) {
    const Real radius = system.parameters.tip.radius;
    const Vec3 point = c.centre - radius * c.normal;
    target.on_half.push(c.s, f);
    target.on_link.turn(target.link, cross(point - c.end, f).z);
}

Real tip_friction_slope(const System& system, Phase phase, Real speed) {
    const auto& friction = system.parameters.tip.friction;
    if (phase == Phase::stick) return 1.0L / friction.saturation_speed;
    if (phase == Phase::slip) return 1.0L / speed;
    return friction_slope(system.parameters.detail, friction, speed);
}

void add_tip(const System& system, int number, End end, int side, Phase phase, Totals& totals) {
    const Link& link = system.links[number];
    const auto& tip = system.parameters.tip;
    const TipContact c = tip_contact(system, link, end, side);
    if (c.depth <= 0.0L) return;
    const Half& half = link.half(end);
    const Body& sheave = system.body[c.sheave];
    const Vec3 tilt_rate = in_space(sheave.tau_rate, 0.0L);
    const Real depth_rate = -dot(c.normal, centre_rate(system, link, half, c)) + dot(c.normal, origin_rate(system, c)) +
                            dot(tilt_rate, cross(c.r, c.local_normal));
    const Real hertz = tip.hertz, elastic = hertz * c.depth * std::sqrt(c.depth);
    const Real force = std::max(0.0L, elastic * (1.0L + tip_damping(system.parameters) * depth_rate));
    LinkForce& on = totals.link[number];
    const TipTarget target{link, half, on, on.half(end)};
    push_normal(system, target, c, force);
    press_sheave(system, c, force, totals);
    totals.energies.tips += 0.4L * hertz * c.depth * c.depth * std::sqrt(c.depth);
    totals.loss(model::Loss::tip_damping) += (force - elastic) * depth_rate;

    const TipSliding v = tip_sliding(system, link, end, c);
    const Real speed = norm(v.tangential), law = tip_law_factor(system.parameters, speed, c.depth);
    const Vec3 f = (-tip.friction.coefficient * force * law * tip_friction_slope(system, phase, speed)) * v.tangential;
    push_friction(system, target, c, f);
    rub_sheave(system, c, f, totals);
    totals.loss(model::Loss::tip_friction) -= dot(f, v.whole);
}

}  // namespace

void add_tips(const System& system, Totals& totals) {
    for (int i = 0; i < system.layout.links; ++i) {
        for (const End end : {End::rear, End::front}) {
            for (const int side : {0, 1}) {
                const Phase phase = system.phases[model::tips_per_link * i + 2 * static_cast<int>(end) + side];
                if (phase != Phase::free) add_tip(system, i, end, side, phase, totals);
            }
        }
    }
}

}  // namespace cvtflow::oracle
