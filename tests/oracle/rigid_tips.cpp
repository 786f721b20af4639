/// Tips of rigid pins (EQUATIONS.md, section 11).

#include "tests/oracle/friction.hpp"
#include "tests/oracle/rigid_forces.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::oracle {

using model::End;

namespace {

constexpr Vec3 upward{0.0L, 0.0L, 1.0L};

/// E' [m/s].
Vec3 end_rate(const PinChain& chain, const PinHalf& half, Real s) {
    const RigidPin& pin = chain.pin(half.pin);
    return in_space(half.rate + s * pin.end_rate + pin.bend_rate, half.z_rate);
}

/// S' [m/s].
Vec3 sphere_rate(const PinChain& chain, const PinHalf& half, const TipContact& c) {
    const auto& tip = chain.system.parameters.tip;
    const RigidPin& pin = chain.pin(half.pin);
    const PitchLine& line = chain.line[half.line];
    const Vec2 slope_rate = chain.numbers.end_slope * (pin.end_rate + (c.s * chain.numbers.bend_factor) * pin.bend_rate);
    const Real sine = std::sin(Real{tip.angle}), cosine = std::cos(Real{tip.angle});
    const Vec3 swing = in_space((-c.s * cosine) * slope_rate, -sine * dot(slope_rate, line.o));
    return end_rate(chain, half, c.s) + Real{tip.radius} * swing + line.turning * c.centre_turning;
}

/// O' of the flank's origin [m/s].
Vec3 origin_rate(const System& system, const TipContact& c) {
    const Body& sheave = system.body[c.sheave];
    return in_space(sheave.u_rate, sheave.w_rate) + flank_rate(system, c.shaft, c.side);
}

/// y > 0 with y² (1 + b y) = δ: Newton's method falls from above until it no longer changes y.
Real root_of_depth(Real depth, Real softness) {
    Real y = std::sqrt(depth);
    for (int step = 0; step < 200; ++step) {
        const Real next = y - (y * y * (1.0L + softness * y) - depth) / (2.0L * y + 3.0L * softness * y * y);
        if (next >= y) break;
        y = next;
    }
    return y;
}

PinTip pressed_tip(const PinChain& chain, const PinHalf& half, const TipContact& c) {
    const Body& sheave = chain.system.body[c.sheave];
    const Real softness = chain.numbers.softness, root = root_of_depth(c.depth, softness), yields = 3.0L * softness * root;
    const Real approach = dot(c.normal, sphere_rate(chain, half, c) - origin_rate(chain.system, c));
    const Real depth_rate = dot(in_space(sheave.tau_rate, 0.0L), cross(c.r, c.local_normal)) - approach;
    return {half, c, depth_rate, root, yields / ((2.0L + yields) * std::cos(Real{chain.system.parameters.tip.angle}))};
}

/// Directions of sliding: along the circumference and along the flank.
struct Sliding {
    Vec3 round, flank;
    Real out;  ///< ν_r: part of the flank's direction along the pin
};

Sliding directions(const TipContact& c) {
    const Vec2 radial = unit(in_plane(c.local_normal));
    const Real out = norm(in_plane(c.local_normal)), in = -c.s * c.local_normal.z;
    return {in_space(left_of(radial), 0.0L), in_space(in * radial, c.s * out), out};
}

/// The normal force on a tip and its reaction on the sheave, along the gradient of the depth.
void push_normal(PinForces& forces, const PinTip& tip, Real force) {
    const auto& p = forces.chain.system.parameters;
    const TipContact& c = tip.contact;
    const Vec2 plane = force * in_plane(c.normal);
    const Real axial = force * c.normal.z, radius = p.tip.radius;
    const Vec2 on_slope = (-radius * std::sin(Real{p.tip.angle}) * axial) * forces.chain.line[tip.half.line].o -
                          (c.s * radius * std::cos(Real{p.tip.angle})) * plane;
    RigidPinForce& on = forces.totals.pin[tip.half.pin];
    forces.push(tip.half, plane, axial);
    on.end += c.s * plane + forces.chain.numbers.end_slope * on_slope;
    on.bend += plane + (c.s * forces.chain.numbers.bend_factor * forces.chain.numbers.end_slope) * on_slope;
    forces.moment[tip.half.line] += force * dot(c.normal, c.centre_turning);
    const Vec3 lever = cross(c.r, c.local_normal), on_sheave = -force * c.normal;
    BodyForce& sheave = forces.totals.body[c.sheave];
    sheave.force += on_sheave;
    sheave.moment += -force * Vec3{lever.x, lever.y, 0.0L};
    sheave.moment.z += cross(flank_offset(forces.chain.system, c.shaft, c.side), on_sheave).z;
}

void push_friction(PinForces& forces, const PinTip& tip, Vec3 f) {
    const TipContact& c = tip.contact;
    const Real radius = forces.chain.system.parameters.tip.radius;
    const Vec3 point = c.centre - radius * c.normal;
    RigidPinForce& on = forces.totals.pin[tip.half.pin];
    forces.push(tip.half, in_plane(f), f.z);
    on.end += c.s * in_plane(f);
    on.bend += in_plane(f);
    forces.moment[tip.half.line] += cross(point - c.end, f).z;
    BodyForce& sheave = forces.totals.body[c.sheave];
    sheave.force += -f;
    sheave.moment += -cross(c.r - radius * c.normal, f);
    sheave.moment.z -= cross(flank_offset(forces.chain.system, c.shaft, c.side), f).z;
}

}  // namespace

std::vector<PinTip> pressed_tips(const PinChain& chain) {
    std::vector<PinTip> tips;
    if (chain.system.parameters.detail.pulleys == model::PulleyDetail::absent) return tips;
    for (int pin = 0; pin < chain.system.layout.links; ++pin) {
        for (const End end : {End::front, End::rear}) {
            for (const int side : {0, 1}) {
                const PinHalf half = chain.half(pin, end);
                const TipContact contact = chain.tip(half, side);
                if (contact.depth > 0.0L) tips.push_back(pressed_tip(chain, half, contact));
            }
        }
    }
    return tips;
}

std::vector<Real> lengthening_of(const PinChain& chain, const std::vector<PinTip>& tips) {
    std::vector<Real> rate(chain.line.size(), 0.0L);
    for (const PinTip& tip : tips) rate[tip.half.pin] -= 0.25L * tip.shortening * tip.depth_rate;
    return rate;
}

void add_pin_tip(PinForces& forces, const PinTip& tip) {
    const System& system = forces.chain.system;
    const auto& p = system.parameters;
    const TipContact& c = tip.contact;
    const Body& sheave = system.body[c.sheave];
    const Real y = tip.root, elastic = p.tip.hertz * y * y * y, anchor = std::sqrt(Real{p.tip.reference_depth});
    const Real chi = damping_of(p.chain.damping_ratio, 1.5L * p.tip.hertz * anchor, p.half.mass) / (p.tip.hertz * anchor * anchor * anchor);
    const Real normal = std::max(0.0L, elastic * (1.0L + chi * tip.depth_rate));

    const Vec3 point = c.centre - Real{p.tip.radius} * c.normal, arm = c.r - Real{p.tip.radius} * c.normal;
    const Vec3 spin = in_space(sheave.tau_rate, sheave.phi_rate), yielding = (c.s * tip.shortening * tip.depth_rate) * upward;
    const Vec3 of_half =
        end_rate(forces.chain, tip.half, c.s) - yielding + forces.chain.line[tip.half.line].turning * cross(upward, point - c.end);
    const Vec3 v = of_half - origin_rate(system, c) - cross(spin, arm);
    const Sliding along = directions(c);
    const Real round = dot(v, along.round), flank = dot(v, along.flank), speed = std::sqrt(round * round + flank * flank);
    const Real factor =
        p.tip.friction.coefficient * normal * tip_law_factor(p, speed, y * y) * friction_slope(p.detail, p.tip.friction, speed);
    const Vec3 f = -factor * (round * along.round + flank * along.flank);
    push_friction(forces, tip, f);
    push_normal(forces, tip, normal + tip.shortening * (c.s * f.z + 0.25L * forces.thrust[tip.half.pin]));

    forces.totals.energies.tips += p.tip.hertz * y * y * y * y * y * (0.4L + 0.5L * forces.chain.numbers.softness * y);
    forces.totals.loss(model::Loss::tip_damping) += (normal - elastic) * tip.depth_rate;
    forces.totals.loss(model::Loss::tip_friction) += factor * speed * speed;
}

}  // namespace cvtflow::oracle
