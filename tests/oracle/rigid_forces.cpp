/// Forces on rigid pins (EQUATIONS.md, sections 10 and 11): links, bending, rolling, friction along the pins, tips.

#include "tests/oracle/friction.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::oracle {

using model::End;

PinForces::PinForces(const PinChain& of, Totals& to)
    : chain(of), totals(to), moment(of.line.size()), thrust(of.line.size()), tension(of.line.size()), pull(of.line.size()) {}

void PinForces::push(const PinHalf& half, Vec2 force, Real axial) {
    const Rolling& rolling = chain.rolling[half.pin];
    const Vec2 turning = (half.sign / 2.0L) * rolling.times(force);
    const int before = chain.system.layout.previous(half.pin);
    totals.pin[half.pin].middle += force;
    moment[before] += dot(chain.line[before].n, turning);
    moment[half.pin] += dot(chain.line[half.pin].n, turning);
    totals.pin[half.pin].z += axial;
    totals.pin[half.pin].slide += half.sign / 2.0L * axial;
}

void PinForces::turn_lines() {
    for (int i = 0; i < chain.system.layout.links; ++i) {
        const Vec2 force = (moment[i] / chain.line[i].length) * chain.line[i].n;
        totals.pin[chain.system.layout.next(i)].middle += force;
        totals.pin[i].middle += -force;
    }
}

namespace {

/// A deflection of a link and its derivatives with respect to what its pins do to it.
struct LinkDeflection {
    Real value = 0.0L;
    Vec2 by_chord;        ///< X_L,i+1 - X_R,i
    Vec2 by_difference;   ///< D_{i+1} - D_i
    Vec2 by_sum;          ///< D_{i+1} + D_i
    Vec2 by_bow;          ///< B_{i+1} - B_i
    Real by_rise = 0.0L;  ///< Δz
};

/// A link between two rigid pins.
struct PinLink {
    const PinChain& chain;
    int number, next;
    PinHalf rear, front;

    PinLink(const PinChain& of, int i)
        : chain(of), number(i), next(of.system.layout.next(i)), rear(of.half(i, End::rear)), front(of.half(i + 1, End::front)) {}

    [[nodiscard]] Real rest_length() const {
        const auto& p = chain.system.parameters;
        return Real{p.chain.pitch[static_cast<std::size_t>(number) % p.chain.pitch.size()]} + p.half.width;
    }
    [[nodiscard]] Real rise() const { return front.z - rear.z; }
    [[nodiscard]] Real rise_rate() const { return front.z_rate - rear.z_rate; }

    /// Stretch, yaw, torsion, shear, bow.
    [[nodiscard]] std::array<LinkDeflection, 5> deflections() const {
        const RigidPin &a = chain.pin(number), &b = chain.pin(next);
        const Vec2 chord = front.at - rear.at, difference = b.end - a.end, sum = b.end + a.end, bow = b.bend - a.bend;
        const Real length = norm(chord), rest = rest_length(), square = chain.numbers.square, scale = chain.numbers.end_slope;
        const Vec2 t = unit(chord), n = left_of(t), turn = (1.0L / length) * n;  // turn: ∂(angle)/∂(chord)
        const Real yaw = dot(difference, t), roll = dot(difference, n);
        const LinkDeflection of_yaw{yaw, roll * turn, t, {}, {}, 0.0L}, of_roll{roll, -yaw * turn, n, {}, {}, 0.0L};
        const Real per_roll = square * roll / rest;
        const LinkDeflection of_stretch{length - rest + (square * roll * roll + rise() * rise()) / (2.0L * rest),
                                        t + per_roll * of_roll.by_chord,
                                        per_roll * n,
                                        {},
                                        {},
                                        rise() / rest};
        const LinkDeflection of_shear{
            -scale * dot(sum, t) - 2.0L * rise() / rest, (-scale * dot(sum, n)) * turn, {}, -scale * t, {}, -2.0L / rest};
        return {of_stretch, of_yaw, of_roll, of_shear, LinkDeflection{dot(bow, t), dot(bow, n) * turn, {}, {}, t, 0.0L}};
    }
    [[nodiscard]] Real rate(const LinkDeflection& u) const {
        const RigidPin &a = chain.pin(number), &b = chain.pin(next);
        return dot(u.by_chord, front.rate - rear.rate) + dot(u.by_difference, b.end_rate - a.end_rate) +
               dot(u.by_sum, b.end_rate + a.end_rate) + dot(u.by_bow, b.bend_rate - a.bend_rate) + u.by_rise * rise_rate();
    }
};

struct Element {
    Real stiffness, damping;
};

Real in_series(Real a, Real b) { return 1.0L / (1.0L / a + 1.0L / b); }

/// Elements of the deflections, in their order.
std::array<Element, 5> link_elements(const PinLink& link) {
    const auto& p = link.chain.system.parameters;
    const PinNumbers& n = link.chain.numbers;
    const Real zeta = p.chain.damping_ratio, plates = p.plate.count * Real{p.plate.stiffness}, joint = p.joint.stiffness;
    const Real half_length = p.half.length / 2.0L, scale = n.end_slope * n.end_slope, at_ends = (1.0L - n.bow) * (1.0L - n.bow);
    const Real swing = 0.5L * p.half.mass / 3.0L * half_length * half_length;
    const Real bending = p.plate.count * Real{p.plate.bending_stiffness} / link.rest_length();
    const Real torsion = p.plate.count * Real{p.plate.torsion_stiffness};
    const Real stretch = in_series(plates, joint), drag = damping_of(zeta, stretch, n.mass / 4.0L);
    return {Element{stretch, drag},
            {in_series(plates * n.square, joint / 3.0L) + scale * bending, drag * n.square + scale * damping_of(zeta, bending, swing)},
            {scale * torsion, scale * damping_of(zeta, torsion, swing)},
            {3.0L * bending, damping_of(zeta, 3.0L * bending, swing)},
            {in_series(plates * n.bow_square, joint / 5.0L / at_ends), drag * n.bow_square}};
}

/// Adds the force of a deflection to the coordinates that it depends on.
void push_link(PinForces& forces, const PinLink& link, const LinkDeflection& u, Real force) {
    RigidPinForce &rear = forces.totals.pin[link.number], &front = forces.totals.pin[link.next];
    const Vec2 on_front = -force * u.by_chord;
    forces.push(link.front, on_front, -force * u.by_rise);
    forces.push(link.rear, -on_front, force * u.by_rise);
    forces.pull[link.number] += on_front;
    front.end += -force * (u.by_sum + u.by_difference);
    rear.end += -force * (u.by_sum - u.by_difference);
    front.bend += -force * u.by_bow;
    rear.bend += force * u.by_bow;
}

void add_link(PinForces& forces, int number) {
    const PinLink link(forces.chain, number);
    const auto deflections = link.deflections();
    const auto elements = link_elements(link);
    for (std::size_t which = 0; which < deflections.size(); ++which) {
        const LinkDeflection& u = deflections[which];
        const Element& element = elements[which];
        const Real rate = link.rate(u), force = element.stiffness * u.value + element.damping * rate;
        const bool stretches = which == 0;
        if (stretches) forces.tension[number] = force;
        push_link(forces, link, u, force);
        (stretches ? forces.totals.energies.plates : forces.totals.energies.pack) += 0.5L * element.stiffness * u.value * u.value;
        forces.totals.loss(stretches ? model::Loss::plate_damping : model::Loss::inner) += element.damping * rate * rate;
    }
}

/// Bending along a direction in the plane that turns with the mean of both pitch lines; @param turned its derivative with the angle
void add_bending(PinForces& forces, int pin, Vec2 direction, Vec2 turned, Real rigidity) {
    const auto& p = forces.chain.system.parameters;
    const PinNumbers& n = forces.chain.numbers;
    const RigidPin& of = forces.chain.pin(pin);
    const int before = forces.chain.system.layout.previous(pin);
    const Real length = p.half.length, at_ends = (1.0L - n.bow) * (1.0L - n.bow);
    const Real k = 288.0L * rigidity / (length * length * length * at_ends), c = damping_of(p.chain.damping_ratio, k, n.bend_mass);
    const Real turning = (forces.chain.line[before].turning + forces.chain.line[pin].turning) / 2.0L;
    const Real u = dot(of.bend, direction), u_turned = dot(of.bend, turned), rate = dot(of.bend_rate, direction) + turning * u_turned;
    const Real force = k * u + c * rate;
    forces.totals.pin[pin].bend += -force * direction;
    forces.moment[before] -= force * u_turned / 2.0L;
    forces.moment[pin] -= force * u_turned / 2.0L;
    forces.totals.energies.inner += 0.5L * k * u * u;
    forces.totals.loss(model::Loss::inner) += c * rate * rate;
}

/// Halves that the links press together resist rolling and rub along the pin.
void add_joint(PinForces& forces, int pin) {
    const auto& p = forces.chain.system.parameters;
    const auto& friction = p.joint.friction;
    const int before = forces.chain.system.layout.previous(pin);
    const Vec2 parting = 0.5L * (forces.pull[before] + forces.pull[pin]);  // ½ (f_L - f_R), f_R = -f_i
    const Real pressing = std::max(0.0L, -dot(parting, forces.chain.rolling[pin].bisector));
    const Real strip = 0.11L * std::sqrt(p.joint.radius * pressing / p.joint.stiffness);
    const auto per_speed = [&](Real v) { return friction.coefficient * pressing * friction_slope(p.detail, friction, std::abs(v)); };

    const Real bending = forces.chain.line[pin].turning - forces.chain.line[before].turning, v = strip * bending;
    const Real resistance = strip * per_speed(v) * v;
    forces.moment[pin] -= resistance;
    forces.moment[before] += resistance;
    const Real slide = forces.chain.pin(pin).slide_rate, rubbing = per_speed(slide) * slide;
    forces.totals.pin[pin].slide -= rubbing;
    forces.totals.loss(model::Loss::joint_friction) += resistance * bending + rubbing * slide;
}

/// Half of the plates of a link at +ξ̂, half at -ξ̂, rub along pins whose ends move outward by e'.
void add_plate_friction(PinForces& forces, int number, const std::vector<Real>& lengthening) {
    const auto& p = forces.chain.system.parameters;
    const PinLink link(forces.chain, number);
    const Real reach = std::sqrt(forces.chain.numbers.square);
    const Real capacity = 0.5L * p.plate.friction.coefficient * std::max(forces.tension[number], 0.0L);
    for (const Real xi : {-reach, reach}) {
        const Real v = link.rise_rate() + xi * (lengthening[link.next] - lengthening[number]);
        const Real force = capacity * friction_slope(p.detail, p.plate.friction, std::abs(v)) * v;
        forces.push(link.front, {}, -force);
        forces.push(link.rear, {}, force);
        forces.thrust[number] += xi * force;
        forces.thrust[link.next] -= xi * force;
        forces.totals.loss(model::Loss::plate_friction) += force * v;
    }
}

}  // namespace

void add_rigid_pins(const System& system, Totals& totals) {
    const PinChain chain(system);
    PinForces forces(chain, totals);
    for (int i = 0; i < system.layout.links; ++i) {
        add_link(forces, i);
    }
    for (int pin = 0; pin < system.layout.links; ++pin) {
        const Vec2 b = chain.rolling[pin].bisector;
        add_bending(forces, pin, b, left_of(b), system.parameters.half.bending_travel);
        add_bending(forces, pin, left_of(b), -b, system.parameters.half.bending_height);
        add_joint(forces, pin);
    }
    const std::vector<PinTip> tips = pressed_tips(chain);
    const std::vector<Real> lengthening = lengthening_of(chain, tips);
    for (int i = 0; i < system.layout.links; ++i) add_plate_friction(forces, i, lengthening);
    for (const PinTip& tip : tips) add_pin_tip(forces, tip);
    forces.turn_lines();
}

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
    press_sheave(forces.chain.system, c, force, forces.totals);
}

void push_friction(PinForces& forces, const PinTip& tip, Vec3 f) {
    const TipContact& c = tip.contact;
    const Vec3 point = c.centre - Real{forces.chain.system.parameters.tip.radius} * c.normal;
    RigidPinForce& on = forces.totals.pin[tip.half.pin];
    forces.push(tip.half, in_plane(f), f.z);
    on.end += c.s * in_plane(f);
    on.bend += in_plane(f);
    forces.moment[tip.half.line] += cross(point - c.end, f).z;
    rub_sheave(forces.chain.system, c, f, forces.totals);
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
    const Real y = tip.root, elastic = p.tip.hertz * y * y * y;
    const Real normal = std::max(0.0L, elastic * (1.0L + tip_damping(p) * tip.depth_rate));

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
